"""Whether a speed has settled: made-up records of each kind, and the time that is given."""

import numpy as np
import pytest

from orchestrate.weak_drive.capture_rule import (
    BOUNDED,
    CONVERGED,
    NEITHER,
    UNDECIDED,
    SettlingTest,
    longest_time_constant,
    time_past_the_fold,
    usual_limit,
)
from orchestrate.weak_drive.steady_speed import SettledSettings

from .coupled import QUICK

TEST = SettlingTest(1.3, 1.0, 100, SettledSettings(tolerance=1e-5))
TIME = np.arange(1.0, 40_000.0, 5.0)  # ends of revolutions


def decided(speed, test=TEST):
    """The first outcome of a record that grows by a twentieth each time, and when it comes."""
    count = 100
    while count <= len(speed):
        outcome = test.judge_record(TIME[:count], speed[:count])
        if outcome.decision != UNDECIDED:
            return outcome, float(TIME[count - 1])
        count += count // 20
    return outcome, np.inf


def crept(distance, rate=0.2, first=-0.3, last=0.2):
    """Speeds of x' = rate (distance + x^2) around 1.2; beyond ``last`` it has arrived."""
    values, x = [], first
    for _ in TIME:
        values.append(x)
        for _ in range(5):
            x = min(x + rate * (distance + x * x), last)
    return 1.2 + np.array(values)


@pytest.mark.parametrize("limit", [1.2, 1.4])
@pytest.mark.parametrize("beat", [0.0, 0.05])
def test_a_speed_that_converges(limit, beat):
    """To either side, creeping or swinging; revolutions one longer, one shorter all along."""
    away = 0.1 * np.exp(-0.01 * TIME) * np.cos(beat * TIME) + 0.02 * (-1.0) ** np.arange(len(TIME))
    outcome, when = decided(limit + away)
    assert (outcome.decision, outcome.passed) == (CONVERGED, limit > 1.3)
    assert 500.0 < when < 4000.0
    assert np.isnan(outcome.time) if limit < 1.3 else outcome.time < 100.0


@pytest.mark.parametrize("distance", [1e-4, 1e-5, 1e-6])
def test_a_speed_that_creeps_past_a_fold(distance):
    """It is not captured, however slow it gets."""
    speed = crept(distance)
    outcome, when = decided(speed)
    assert (outcome.decision, outcome.passed) == (CONVERGED, True)
    assert when > outcome.time == TIME[np.flatnonzero(speed > 1.3)[0]]


@pytest.mark.parametrize("distance", [1e-4, 1e-5, 1e-6])
def test_a_speed_that_stops_just_before_a_fold(distance):
    """By a fold the approach is slow: it may be taken for an irregular motion."""
    outcome, _ = decided(crept(-distance))
    assert outcome.decision in (CONVERGED, BOUNDED) and not outcome.passed


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_speed_that_stays_by_a_saddle_for_a_while(side):
    """It comes as close as a voltage 1e-5 beside the border brings it, and leaves."""
    x = np.exp(-0.02 * TIME) + side * 1e-5 * np.exp(0.01 * np.minimum(TIME, 950.0))
    after = np.where(TIME > 950.0, side * 0.15, 0.0) * (
        1.0 - np.exp(-0.02 * (TIME - 950.0).clip(0))
    )
    outcome, _ = decided(1.25 + x + after)
    assert outcome.decision == CONVERGED and outcome.passed == (side > 0.0)


def test_an_irregular_motion_stays_within_bounds():
    noise = np.random.default_rng(3).normal(0.0, 0.01, len(TIME))
    outcome, when = decided(1.2 + 0.2 * np.exp(-0.01 * TIME) + noise)
    assert (outcome.decision, outcome.passed) == (BOUNDED, False) and when > 12 * 48 * 5.0


@pytest.mark.parametrize(
    ("middle", "decision", "passed"),
    [(1.2, BOUNDED, False), (1.3, NEITHER, False), (1.333, NEITHER, False), (1.45, BOUNDED, True)],
)
def test_a_motion_that_swings_on_and_on_is_bounded(middle, decision, passed):
    """On a side only if it swings there, well away from the resonance."""
    outcome, when = decided(middle + 0.03 * np.cos(0.004 * TIME))
    assert (outcome.decision, outcome.passed) == (decision, passed)
    assert outcome.speed == pytest.approx(middle, abs=5e-3) and when > 4 * 2.0 * np.pi / 0.004


def test_a_speed_that_settles_at_the_resonance_has_no_side():
    outcome, _ = decided(1.3 + 1e-7 + 0.1 * np.exp(-0.01 * TIME))
    assert outcome.decision == NEITHER and not outcome.passed and not outcome.captured
    assert outcome.speed == pytest.approx(1.3, abs=1e-4)


def test_a_drift_is_not_settled():
    """Irregular, and rising slowly: it is on its way."""
    noise = np.random.default_rng(3).normal(0.0, 1e-3, len(TIME))
    assert decided(1.1 + 4e-6 * TIME + noise)[0].decision == UNDECIDED


def test_the_limit_scales_with_the_drive():
    """Of slow motors, of little damping and of close voltages more time is asked."""
    usual, drive = usual_limit(*QUICK, 1e-4), QUICK.drive
    lighter = drive.replace(armature_resistance=10.0 * drive.armature_resistance)  # b = 0.002
    slower = QUICK._replace(drive=lighter)
    assert longest_time_constant(*slower) == pytest.approx(500.0)
    assert usual_limit(*slower, 1e-4) > 2.0 * usual
    assert usual_limit(*QUICK, 1e-6) > 1.5 * usual
    ratio = time_past_the_fold(*QUICK.as_bonded(), 1e-6) / time_past_the_fold(
        *QUICK.as_bonded(), 1e-4
    )
    assert ratio == pytest.approx(10.0)
    assert longest_time_constant(*QUICK.with_structure(d1=0.0)) == 1000.0
