"""Exponents of long runs: parts that agree, a transient that ends, and what stays undecided."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.access import OSCILLATOR, REST, EventInstance, Instance, find
from orchestrate.dynamics import long_runs
from orchestrate.dynamics.long_runs import (
    ENDED,
    STEADY,
    UNDECIDED,
    parts_agree,
    perturbed_start,
    run_until_steady,
)
from orchestrate.dynamics.lyapunov import Exponent
from orchestrate.response.questions import Point
from orchestrate.response.respond import respond
from orchestrate.structures import Excitation, Structure

DAMPED = Structure.nondimensional(e=0.7, D=0.05)
POINT = Point(DAMPED, Excitation.nondimensional(5.175, DAMPED))


def test_parts_of_a_steady_response_agree_and_those_of_a_transient_do_not():
    own = np.full(10, 0.005)
    noise = 0.005 * np.random.default_rng(1).standard_normal(10)
    assert parts_agree(0.17 + noise, own, 0.0)
    assert not parts_agree(np.r_[np.full(7, 0.17), np.full(3, 0.008)] + noise, own, 0.0)
    assert not parts_agree(np.r_[np.full(9, 0.17), 0.008] + noise, own, 0.0)
    assert not parts_agree(np.r_[np.full(9, 0.17), np.nan], own, 0.0)


def test_steady_responses_are_rarely_taken_for_unsteady_ones():
    random = np.random.default_rng(2)
    refused = sum(
        not parts_agree(0.1 + 0.01 * random.standard_normal(10), np.full(10, 0.01), 0.0)
        for _ in range(2000)
    )
    assert refused < 12  # 2 expected


def test_a_deviation_that_wanders_is_no_transient():
    values = np.r_[np.full(5, 1e-4), np.full(5, -1e-4)]
    assert not parts_agree(values, np.full(10, 1e-9), 0.0)
    assert parts_agree(values, np.full(10, 1e-9), 3e-4)


@pytest.mark.parametrize(
    ("means", "outcome", "value", "followed"),
    [
        ([0.17] * 30, STEADY, 0.17, 11),
        ([0.17] * 7 + [0.008] * 23, ENDED, 0.008, 21),  # within the first run
        ([0.17] * 13 + [0.008] * 17, STEADY, 0.17, 11),  # after it: cannot be seen
        ([0.17, 0.008] * 15, UNDECIDED, 0.089, 31),
    ],
)
def test_what_a_run_is_told_by_its_parts(monkeypatch, means, outcome, value, followed):
    """Parts come from a list in place of a motion; what is tested is what is made of them."""
    noise = iter(1e-3 * np.random.default_rng(3).standard_normal(40))
    left = iter([means[0], *means])  # the first part is dropped

    def parts_of(instance, point, start, periods, parts):
        return [Exponent(next(left) + next(noise), 1e-3) for _ in range(parts)], start

    monkeypatch.setattr(long_runs, "exponents_of_parts", parts_of)
    found = run_until_steady(None, POINT, REST, 1000, 10, 3)
    assert found.outcome == outcome and found.periods == 1000 * followed
    assert found.exponent.value == pytest.approx(value, abs=2e-3)


def test_another_start_is_near_and_the_masses_do_not_overlap():
    start = (0.3, 0.30001, -0.2, 0.4)
    others = [perturbed_start(POINT, start, [7, k]) for k in range(50)]
    assert len(set(others)) == 50
    for other in others:
        assert other[1] >= other[0]
        assert other == pytest.approx(start, rel=0.011)


def test_the_exponent_of_a_chaotic_response_does_not_depend_on_its_start(exported):
    """At 5.175 a long run from elsewhere gives 0.2581 +- 0.0020."""
    with Instance(find(OSCILLATOR).path) as plain:
        settled = respond(plain, *POINT, REST, 500, 1, 1e-2).end
    with EventInstance(find(OSCILLATOR).path) as instance:
        start = perturbed_start(POINT, settled, [1])
        found = run_until_steady(instance, POINT, start, 1500, 6, 2)
    assert found.outcome == STEADY
    value, error = found.exponent
    assert 0.0 < error < 0.01
    assert abs(value - 0.2581) < 3.0 * np.hypot(error, 0.0020)


@pytest.mark.slow
def test_a_transient_that_ends_after_tens_of_thousands_of_periods(exported):
    """At e = 0.3, eta = 5.125 chaos with an exponent of 0.17 dies out into one below 0.02."""
    plastic = Structure.nondimensional(e=0.3, D=0.005)
    point = Point(plastic, Excitation.nondimensional(5.125, plastic))
    with Instance(find(OSCILLATOR).path) as plain:
        settled = respond(plain, *point, REST, 20_000, 48, 1e-6).end
    with EventInstance(find(OSCILLATOR).path) as instance:
        found = run_until_steady(instance, point, settled, 10_000, 10, 3)
    assert found.outcome == ENDED
    assert 0.0 < found.exponent.value < 0.02
