"""Multiplicity of sequences whose answer is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from orchestrate.access import OSCILLATOR, Instance, find
from orchestrate.response.multiplicity import LEAST_GAP, multiplicity, over_size, repetition
from orchestrate.response.respond import respond
from orchestrate.structures import Excitation, Structure

TOLERANCE = 1e-2
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


@st.composite
def orbits(draw, longest=12):
    """One period of distinct states of four co-ordinates, well apart for the tolerance."""
    n = draw(st.integers(1, longest))
    order = draw(st.permutations(range(n)))
    scale = draw(st.floats(1e-6, 1e6))
    parts = draw(st.permutations([1.0, 0.5, -0.1, 0.0]))
    return np.outer([1.0 + 0.1 * k for k in order], scale * np.array(parts))


def four(*columns):
    """States whose other co-ordinates are at rest."""
    states = np.zeros((len(columns[0]), 4))
    states[:, : len(columns)] = np.transpose(columns)
    return states


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
    assert multiplicity(samples + part * TOLERANCE * np.abs(orbit).max() * noise, TOLERANCE) == len(
        orbit
    )


@given(st.integers(0, 1000), st.integers(40, 200))
def test_noise_alone_never_repeats(seed, length):
    assert multiplicity(np.random.default_rng(seed).uniform(-1.0, 1.0, (length, 4)), TOLERANCE) == 0


@given(st.floats(0.0, 1.0), st.integers(100, 200))
def test_quasi_periodic_motion_never_repeats(phase, length):
    angle = 2.0 * np.pi * (GOLDEN * np.arange(length) + phase)
    assert multiplicity(four(np.cos(angle), np.sin(angle)), TOLERANCE) == 0


@given(st.floats(0.0, 1.0), st.floats(0.0, 0.45))
def test_a_torus_narrower_than_the_tolerance_counts_as_periodic(phase, part):
    angle = 2.0 * np.pi * (GOLDEN * np.arange(120) + phase)
    width = 2.0 * part * TOLERANCE
    orbit = four(1.0 + width * np.cos(angle), 2.0 + width * np.sin(angle))
    assert multiplicity(orbit, TOLERANCE) == 1


@given(orbits(longest=6), st.integers(0, 1000))
def test_the_earlier_half_does_not_count(orbit, seed):
    samples = repeat(orbit, 60)
    samples[:30] = 100.0 * np.random.default_rng(seed).normal(size=(30, 4)) * np.abs(orbit).max()
    assert multiplicity(samples, TOLERANCE) == len(orbit)


@pytest.mark.parametrize(("half_life", "expected"), [(3.0, 1), (1000.0, 0)])
def test_decaying_transient(half_life, expected):
    # seen from period to period at an irrational angle, so that no n repeats before it has decayed
    n = np.arange(200)
    rest = 0.5 ** (n / half_life) * np.cos(2.0 * np.pi * GOLDEN * n)
    assert multiplicity(four(1.0 + rest, 2.0 - rest), TOLERANCE) == expected


@pytest.mark.parametrize("length", [1, 2, 3, 4])
def test_constant_sequences_need_two_samples_in_the_later_half(length):
    assert multiplicity(np.ones((length, 4)), TOLERANCE) == (1 if length >= 3 else 0)


@given(st.integers(2, 10))
def test_nothing_beyond_a_quarter_of_the_samples(n):
    orbit = four(np.arange(1.0, n + 1.0))
    assert multiplicity(repeat(orbit, 4 * n), TOLERANCE) == n
    assert multiplicity(repeat(orbit, 4 * n - 1), TOLERANCE) == 0


@pytest.mark.parametrize("coordinate", range(4))
def test_every_co_ordinate_counts(coordinate):
    samples = np.ones((40, 4))
    samples[::2, coordinate] = 2.0
    assert multiplicity(samples, TOLERANCE) == 2


@pytest.mark.parametrize(("deviation", "expected"), [(0.9, 1), (1.1, 2)])
@pytest.mark.parametrize("coordinate", range(4))
def test_the_tolerance_is_relative_to_the_size_of_the_motion(coordinate, deviation, expected):
    frequency = 8.0
    samples = np.tile([0.0, -1000.0, 0.0, 0.0], (40, 1))
    samples[::2, coordinate] += (
        deviation * TOLERANCE * 1000.0 * (frequency if coordinate > 1 else 1)
    )
    assert multiplicity(samples, TOLERANCE, frequency) == expected


def test_a_co_ordinate_that_passes_zero_at_the_sampled_phase_hides_nothing():
    # a stable T response is left of its way to itself: each co-ordinate in turn is nearly 0
    n = np.arange(200)
    rest = 1e-4 * 0.98**n * np.cos(2.0 * np.pi * GOLDEN * n)
    for coordinate in range(4):
        samples = np.ones((200, 4))
        samples[:, coordinate] = rest
        assert multiplicity(samples, TOLERANCE, 1.0, 1.0) == 1


@pytest.mark.parametrize(("deviation", "expected"), [(0.9, 1), (1.1, 2)])
@pytest.mark.parametrize("coordinate", range(4))
def test_a_gap_much_smaller_than_the_motion_has_a_size_of_its_own(coordinate, deviation, expected):
    frequency, gap = 3.0, 1.0
    samples = np.tile([100.0, 100.5, 50.0, 50.0], (40, 1))
    samples[::2, coordinate] += deviation * TOLERANCE * gap * (frequency if coordinate > 1 else 1.0)
    assert multiplicity(samples, TOLERANCE, frequency) == 1
    assert multiplicity(samples, TOLERANCE, frequency, gap) == expected


@given(st.integers(0, 1000))
def test_a_gap_of_rounding_errors_is_none(seed):
    noise = np.random.default_rng(seed).uniform(0.0, 1e-12, (40, 4))
    assert multiplicity(np.ones((40, 4)) + noise, TOLERANCE, 1.0, 1e-12) == 1
    assert LEAST_GAP * TOLERANCE > 1e-12


@given(st.integers(0, 1000), st.integers(-200, 200))
def test_nothing_depends_on_the_amplitude(seed, power):
    samples = np.random.default_rng(seed).normal(size=(40, 4))
    scale = 2.0**power
    once = over_size(samples, 1.7, 0.3)
    np.testing.assert_array_equal(over_size(scale * samples, 1.7, scale * 0.3), once)
    assert repetition(once, 1e3).deviation == np.abs(np.diff(once[20:], axis=0)).max()


def test_masses_at_rest_are_no_obstacle():
    samples = np.zeros((40, 4))
    assert multiplicity(samples, TOLERANCE) == 1
    assert multiplicity(samples, TOLERANCE, 1.0, 0.0) == 1
    samples[1::2, 2] = 1.0
    assert multiplicity(samples, TOLERANCE) == 2


@pytest.mark.parametrize(("e", "eta"), [(0.35, 1.92), (0.35, 1.924), (0.35, 1.926), (0.35, 1.932)])
def test_the_response_where_a_mass_passes_zero_at_phase_zero(e, eta):
    # was 2, 11, 0 and 2: x2 is 1e-6 to 2e-4 there, of a motion of 0.8
    structure = Structure.nondimensional(e=e)
    excitation = Excitation.nondimensional(eta, structure)
    with Instance(find(OSCILLATOR).path) as instance:
        response = respond(instance, structure, excitation, (0.0,) * 4, 500, 200, TOLERANCE)
    assert response.multiplicity == 1
    n, deviation = response.repetition(TOLERANCE)
    assert (n, deviation < 1e-5) == (1, True)


def test_the_samples_are_left_as_they_were():
    samples = np.random.default_rng(1).normal(size=(50, 4))
    before = samples.copy()
    multiplicity(samples, TOLERANCE)
    np.testing.assert_array_equal(samples, before)
