"""Whether a speed has settled: made-up records of each kind, and the time that is given."""

import numpy as np
import pytest

from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.capture_rule import (
    BOUNDED,
    CONVERGED,
    NEITHER,
    UNDECIDED,
    SettlingTest,
    default_time_limit,
    longest_time_constant,
    make_settling_test,
    time_past_the_fold,
)
from orchestrate.weak_drive.steady_speed import SettledSettings

from .coupled import BEAM, QUICK

TEST = SettlingTest(1.3, 1.0, 100, SettledSettings(tolerance=1e-5))
TIME = np.arange(1.0, 40_000.0, 5.0)  # ends of revolutions
NOISE = np.random.default_rng(3).normal(0.0, 1.0, len(TIME))
DECAY = np.exp(-0.01 * TIME)
SADDLE = 1e-5 * np.exp(0.01 * np.minimum(TIME, 950.0))
AFTER = np.where(TIME > 950.0, 0.15, 0.0) * (1.0 - np.exp(-0.02 * (TIME - 950.0).clip(0)))


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


def beating(limit, beat):
    """To either side, creeping or swinging; revolutions one longer, one shorter all along."""
    return limit + 0.1 * DECAY * np.cos(beat * TIME) + 0.02 * (-1.0) ** np.arange(len(TIME))


RECORDS = {  # speeds, how they are decided, on which side, and the earliest and latest time
    "converges below": (beating(1.2, 0.0), CONVERGED, False, 400, 4000),
    "converges beyond": (beating(1.4, 0.0), CONVERGED, True, 400, 4000),
    "swings and converges": (beating(1.4, 0.05), CONVERGED, True, 400, 4000),
    "creeps past a fold": (crept(1e-4), CONVERGED, True, 400, 40_000),
    "creeps slowly past a fold": (crept(1e-6), CONVERGED, True, 5000, 40_000),
    "leaves a saddle upwards": (1.25 + DECAY**2 + SADDLE + AFTER, CONVERGED, True, 950, 40_000),
    "leaves a saddle down": (1.25 + DECAY**2 - SADDLE - AFTER, CONVERGED, False, 950, 40_000),
    "irregular": (1.2 + 0.2 * DECAY + 0.01 * NOISE, BOUNDED, False, 12 * 48 * 5, 40_000),
    "swings below": (1.2 + 0.03 * np.cos(0.004 * TIME), BOUNDED, False, 6283, 40_000),
    "swings across": (1.3 + 0.03 * np.cos(0.004 * TIME), NEITHER, False, 6283, 40_000),
    "swings close": (1.333 + 0.03 * np.cos(0.004 * TIME), NEITHER, False, 6283, 40_000),
    "swings beyond": (1.45 + 0.03 * np.cos(0.004 * TIME), BOUNDED, True, 6283, 40_000),
    "at the resonance": (1.3 + 1e-7 + 0.1 * DECAY, NEITHER, False, 400, 40_000),
    "drifts": (1.1 + 4e-6 * TIME + 1e-3 * NOISE, UNDECIDED, False, np.inf, np.inf),
}


@pytest.mark.parametrize("name", RECORDS)
def test_each_record_is_decided(name):
    speed, decision, passed, earliest, latest = RECORDS[name]
    outcome, when = decided(speed)
    assert (outcome.decision, outcome.passed) == (decision, passed)
    assert earliest <= when <= latest
    assert outcome.is_captured == (decision in (CONVERGED, BOUNDED) and not passed)
    if decision != UNDECIDED:
        assert outcome.speed == pytest.approx(speed[-1000:].mean(), abs=5e-3)
    if decision == CONVERGED and passed:
        crossed = TIME[np.flatnonzero(speed <= 1.3)[-1]] if speed.min() <= 1.3 else 0.0
        assert crossed <= outcome.time <= crossed + 500.0
    else:
        assert np.isnan(outcome.time) or passed


@pytest.mark.parametrize("distance", [1e-4, 1e-6])
def test_a_speed_that_stops_just_before_a_fold(distance):
    """By a fold the approach is slow: it may be taken for an irregular motion."""
    outcome, _ = decided(crept(-distance))
    assert outcome.decision in (CONVERGED, BOUNDED) and not outcome.passed


def test_it_has_to_stay_for_some_revolutions():
    """As its means over blocks are beyond: 100 at least."""
    speed = np.where(TIME < 5.0 * 1000, 1.2, 1.4)
    for count, decision in ((1160, CONVERGED), (1090, UNDECIDED)):
        assert TEST.judge_record(TIME[:count], speed[:count]).decision in (decision, UNDECIDED)
    assert decided(speed[1000:])[0].passed


def test_limits_scale_with_the_drive():
    """Of slow motors, of little damping and of close voltages more time is asked."""
    usual, drive, bonded = default_time_limit(*QUICK, 1e-4), QUICK.drive, QUICK.as_bonded()
    lighter = drive.replace(armature_resistance=10.0 * drive.armature_resistance)  # b = 0.002
    slower = QUICK._replace(drive=lighter)
    assert longest_time_constant(*slower) == pytest.approx(500.0)
    assert (
        default_time_limit(*slower, 1e-4) > 2.0 * usual
        and default_time_limit(*QUICK, 1e-6) > 1.5 * usual
    )
    creeping = [time_past_the_fold(*bonded, distance) for distance in (1e-6, 1e-4)]
    assert creeping[0] == pytest.approx(10.0 * creeping[1])
    fold = averaged.folds(*bonded)[0]  # by the integral over what the averaged speed needs there
    near, Omega = fold.Omega - 1e-3, np.linspace(fold.Omega - 0.05, fold.Omega + 0.05, 200_001)
    slope = np.diff(averaged.stationary_voltage(*bonded, [near - 1e-5, near + 1e-5]))[0] / 2e-5
    rate = -averaged.growth_rates(*bonded, near)[0].real / slope
    pace = rate * (1e-6 + fold.eta0 - averaged.stationary_voltage(*bonded, Omega))
    assert creeping[0] == pytest.approx(np.trapezoid(1.0 / pace, Omega), rel=0.05)
    assert usual == pytest.approx(600.0 * longest_time_constant(*QUICK) + 10.0 * creeping[1])
    assert longest_time_constant(*QUICK.with_structure(d1=0.0)) == 1000.0
    tests = [make_settling_test(*BEAM, 7, distance) for distance in (1e-3, 1e-4, 1e-7, 1.0)]
    assert [one.rule.tolerance for one in tests] == pytest.approx([1e-4, 1e-5, 1e-6, 1e-4])
    assert tests[0].threshold / tests[0].omega == pytest.approx(1.4, abs=0.1)
    assert (tests[0].omega, tests[0].stay) == (BEAM.structure.omega, 7)
