"""Multiplicity of sequences whose answer is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrate.response.multiplicity import multiplicity

TOLERANCE = 1e-2
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


@st.composite
def orbits(draw, longest=12):
    """One period of distinct states of four co-ordinates, well apart for the tolerance."""
    n = draw(st.integers(1, longest))
    order = draw(st.permutations(range(n)))
    scales = draw(st.lists(st.floats(1e-6, 1e6), min_size=4, max_size=4))
    return np.outer([1.0 + 0.1 * k for k in order], scales)


def repeat(orbit, length):
    """Take the first ``length`` states of a periodic sequence."""
    return np.tile(orbit, (length // len(orbit) + 1, 1))[:length]


@given(orbits(), st.integers(0, 60))
def test_period_of_a_periodic_sequence(orbit, more):
    assert multiplicity(repeat(orbit, 4 * len(orbit) + more), TOLERANCE) == len(orbit)


@given(orbits(longest=9), st.integers(4, 8), st.floats(0.01, 0.45), st.integers(0, 1000))
def test_noise_below_the_tolerance_changes_nothing(orbit, periods, part, seed):
    samples = repeat(orbit, periods * len(orbit) + 3)
    noise = np.random.default_rng(seed).uniform(-1.0, 1.0, samples.shape)
    assert multiplicity(
        samples + part * TOLERANCE * np.abs(orbit).max(axis=0) * noise, TOLERANCE
    ) == len(orbit)


@given(st.integers(0, 1000), st.integers(40, 200))
def test_noise_alone_never_repeats(seed, length):
    assert multiplicity(np.random.default_rng(seed).uniform(-1.0, 1.0, (length, 4)), TOLERANCE) == 0


@given(st.floats(0.0, 1.0), st.integers(100, 200))
def test_quasi_periodic_motion_never_repeats(phase, length):
    angle = 2.0 * np.pi * (GOLDEN * np.arange(length) + phase)
    assert multiplicity(np.stack([np.cos(angle), np.sin(angle)], axis=1), TOLERANCE) == 0


@given(st.floats(0.0, 1.0), st.floats(0.0, 0.45))
def test_a_torus_narrower_than_the_tolerance_counts_as_periodic(phase, part):
    angle = 2.0 * np.pi * (GOLDEN * np.arange(120) + phase)
    orbit = np.stack(
        [1.0 + part * TOLERANCE * np.cos(angle), 2.0 + part * TOLERANCE * np.sin(angle)], axis=1
    )
    assert multiplicity(orbit, TOLERANCE) == 1


@given(orbits(longest=6), st.integers(0, 1000))
def test_the_earlier_half_does_not_count(orbit, seed):
    samples = repeat(orbit, 60)
    samples[:30] = 100.0 * np.random.default_rng(seed).normal(size=(30, 4)) * orbit.max(axis=0)
    assert multiplicity(samples, TOLERANCE) == len(orbit)


@pytest.mark.parametrize(("half_life", "expected"), [(3.0, 1), (1000.0, 0)])
def test_decaying_transient(half_life, expected):
    # seen from period to period at an irrational angle, so that no n repeats before it has decayed
    n = np.arange(200)
    rest = 0.5 ** (n / half_life) * np.cos(2.0 * np.pi * GOLDEN * n)
    assert multiplicity(np.stack([1.0 + rest, 2.0 - rest], axis=1), TOLERANCE) == expected


@pytest.mark.parametrize("length", [1, 2, 3, 4])
def test_constant_sequences_need_two_samples_in_the_later_half(length):
    assert multiplicity(np.ones((length, 4)), TOLERANCE) == (1 if length >= 3 else 0)


@given(st.integers(2, 10))
def test_nothing_beyond_a_quarter_of_the_samples(n):
    orbit = np.arange(1.0, n + 1.0)[:, None]
    assert multiplicity(repeat(orbit, 4 * n), TOLERANCE) == n
    assert multiplicity(repeat(orbit, 4 * n - 1), TOLERANCE) == 0


@pytest.mark.parametrize("coordinate", range(4))
def test_every_co_ordinate_counts(coordinate):
    samples = np.ones((40, 4))
    samples[::2, coordinate] = 2.0
    assert multiplicity(samples, TOLERANCE) == 2


@pytest.mark.parametrize(("deviation", "expected"), [(0.9, 1), (1.1, 2)])
def test_the_tolerance_is_relative_to_the_largest_value_of_the_co_ordinate(deviation, expected):
    samples = np.full((40, 1), 1000.0)
    samples[::2] -= deviation * TOLERANCE * 1000.0
    assert multiplicity(samples, TOLERANCE) == expected


def test_co_ordinates_at_rest_are_no_obstacle():
    samples = np.zeros((40, 4))
    assert multiplicity(samples, TOLERANCE) == 1
    samples[1::2, 2] = 1.0
    assert multiplicity(samples, TOLERANCE) == 2


def test_the_samples_are_left_as_they_were():
    samples = np.random.default_rng(1).normal(size=(50, 4))
    before = samples.copy()
    multiplicity(samples, TOLERANCE)
    np.testing.assert_array_equal(samples, before)
