"""A plan is a rehearsal: what it recommends, the rule decides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import orchestrate
import orchestrate.diagnosis.plan_test as rehearsed
from orchestrate.diagnosis.opening_force import max_steady_sweep_rate, unit_opening_force
from orchestrate.diagnosis.plan_test import (
    PlanJob,
    checked_sensors,
    default_sweep_range,
    recommended_levels,
    sweep_duration,
)
from orchestrate.diagnosis.undamaged import SoundStructure

HALVES = orchestrate.Structure.from_halves(
    m1=1.5, m2=1.2, f1=42.0, f2=52.0, zeta1=0.06, zeta2=0.04, e=0.5
)
SENSOR = orchestrate.Sensor(bandwidth=600.0, noise=0.01, range=300.0)


@pytest.fixture(scope="module")
def plan(exported):
    levels = [0.002, 1.5, 3.0, 20.0]
    return orchestrate.plan_test(HALVES, sensor=SENSOR, levels=levels, jobs=1, progress=False)


@pytest.mark.parametrize("hertz", [20.0, 46.0, 70.0])
def test_the_opening_force_is_that_of_the_bonded_motion(exported, hertz):
    turns = 2.0 * np.pi * hertz
    motion = orchestrate.simulate(
        HALVES.as_bonded(), frequency=turns, amplitude=3.0 / turns**2, transient=200, periods=2
    )
    x2, v2, a2, time = (motion[name].values for name in ("x2", "v2", "a2", "time"))
    # the equation of mass 2: what its spring, its damper and its inertia do not balance
    box = -3.0 * np.sin(turns * time)
    force = HALVES.m2 * (a2 + box) + HALVES.k2 * x2 + HALVES.d2 * v2
    assert np.abs(force).max() == pytest.approx(3.0 * unit_opening_force(HALVES, hertz), rel=2e-3)


def test_halves_that_move_alike_are_never_opened():
    assert max_steady_sweep_rate(50.0, 0.01) == pytest.approx(0.9)  # Hz/s
    share = HALVES.m1 / (HALVES.m1 + HALVES.m2)
    k, d = HALVES.k1 + HALVES.k2, HALVES.d1 + HALVES.d2
    alike = HALVES.replace(k1=share * k, k2=(1 - share) * k, d1=share * d, d2=(1 - share) * d)
    assert unit_opening_force(HALVES, 46.0) > 1.0 and unit_opening_force(alike, 46.0) < 1e-9


def test_a_level_is_recommended_at_which_both_verdicts_are_right_with_a_reserve(plan):
    assert plan.verdict.values[:3].tolist() == ["undecided", "delaminated", "delaminated"]
    assert set(plan.sound_verdict.values[1:3]) == {"no opening seen"}
    assert plan.overload.values.tolist() == [0, 0, 0, 1]
    assert plan.decides.values[:3].tolist() == [0, 1, 1] and int(plan.counts) == 1
    assert (float(plan.recommended_level), float(plan.second_level)) == (3.0, 3.0)
    assert (plan.heard[1:3] > 3.0).all() and (plan.sound_heard[1:3] < 3.0).all()
    sound = SoundStructure.from_structure(HALVES)
    f, zeta = sound.f, sound.zeta
    assert float(plan.recommended_first) < 0.7 * f < 1.3 * f < float(plan.recommended_last)
    span = float(plan.recommended_last - plan.recommended_first)
    assert float(plan.recommended_duration) >= 0.999 * span / max_steady_sweep_rate(f, zeta)


@pytest.mark.parametrize(("clearance", "shaken"), [(0.0, [1.0, 1.0]), (1e-4, [2.0, 4.0])])
def test_what_is_proportional_to_the_level_is_shaken_once(monkeypatch, clearance, shaken):
    """Of nine levels nine were computed, in minutes; the readings of noise have no verdict."""
    levels, noise = [], np.random.default_rng(1).standard_normal((2, 4000))
    felt = orchestrate.record(sample_rate=2e3, box_acceleration=noise[0], acceleration1=noise[1])

    def readings(job, structure, level, fmus):
        levels.append(level)
        return felt, 1e-3 * level

    monkeypatch.setattr(rehearsed, "shake_and_measure", readings)
    sensors = tuple(dict.fromkeys(("box_acceleration", "acceleration1"), SENSOR).items())
    own = HALVES.replace(clearance=clearance)
    ends = {"first": 20.0, "last": 80.0, "duration": 2.0, "reserve": 2.0}
    job = PlanJob(name="x", structure=own, sensors=sensors, levels=(2.0, 4.0), **ends)
    rows = [job.rehearse(own, level, {}) for level in job.levels]
    assert levels == shaken and [row[2] for row in rows] == [2e-3, 4e-3]
    assert job.rehearse(own.as_bonded(), 4.0, {})[2] == 4e-3 and levels[-1] == 1.0


@pytest.mark.parametrize(
    ("zeta", "periods"), [(0.03, 625.0), (0.01, 2083.0), (0.004, 5400.0), (0.003, 6250.0)]
)
def test_a_rehearsal_takes_as_many_periods_at_any_frequency(zeta, periods):
    """At 950 Hz it took 12,900, six minutes on a busy computer."""
    for f in (95.0, 950.0):
        assert f * sweep_duration(f, zeta, 0.65 * f, 1.4 * f) == pytest.approx(periods, rel=1e-3)


def test_a_sweep_passes_the_resonance_and_those_of_the_halves():
    """By a tenth, and takes two minutes at most."""
    near = HALVES.replace(f1=46.0, f2=46.0)
    assert default_sweep_range(near) == pytest.approx((0.65 * 46.0, 1.4 * 46.0))
    far = HALVES.replace(f1=20.0, f2=200.0)
    assert default_sweep_range(far) == pytest.approx((18.0, 220.0))
    assert sweep_duration(10.0, 0.001, 6.5, 14.0) == 120.0


def test_a_rehearsal_samples_no_faster_than_the_rule_needs():
    """A sensor of 10 kHz on a beam of 45 Hz took three million samples."""
    fast = orchestrate.Sensor(bandwidth=10e3, noise=0.01, sample_rate=30e3)
    for own, rate, bandwidth in ((fast, 2048.0, 799.0), (SENSOR, 1536.0, 600.0)):
        for _, one in checked_sensors({"acceleration1": own}, 80.0):
            assert (one.rate, one.bandwidth) == pytest.approx((rate, bandwidth), rel=1e-3)
            assert replace(one, bandwidth=own.bandwidth, sample_rate=own.rate) == own


@pytest.mark.parametrize(
    ("right", "usable", "expected"),
    [
        ([0, 1, 1, 1], [1, 1, 1, 1], (4.0, 8.0, True)),
        ([1, 0, 1, 1], [1, 1, 1, 1], (8.0, 8.0, True)),  # chance below a level that errs
        ([0, 1, 1, 1], [1, 1, 0, 0], (2.0, 2.0, True)),  # overload above
        ([0, 0, 0, 0], [1, 1, 1, 0], (4.0, 4.0, False)),
        ([1, 1, 1, 1], [0, 0, 0, 0], (1.0, 1.0, False)),
    ],
)
def test_the_lowest_level_from_which_all_decide(right, usable, expected):
    flags = (np.array(one, dtype=bool) for one in (right, usable))
    assert recommended_levels(np.array([1.0, 2.0, 4.0, 8.0]), *flags, reserve=2.0) == expected


def test_preloaded_faces_open_from_a_level_in_closed_form(exported):
    force = 0.3  # N
    k1, k2 = HALVES.k1, HALVES.k2
    pressed = HALVES.replace(clearance=-force * (k1 + k2) / (k1 * k2))
    needed = force / float(unit_opening_force(HALVES, np.linspace(44.0, 50.0, 6001)).max())
    levels = [0.9 * needed, 20.0 * needed]
    plan = orchestrate.plan_test(pressed, sensor=SENSOR, levels=levels, jobs=1, progress=False)
    assert float(plan.opening_level) == pytest.approx(needed, rel=1e-3)
    assert plan.opening[0] < 1e-9 < plan.opening[1]
    assert plan.verdict.values[0] != "delaminated" == plan.verdict.values[1]
    assert plan.closing_force[0] < force < plan.closing_force[1]


LIGHT = orchestrate.Structure.from_halves(
    m1=0.15, m2=0.12, f1=42.0, f2=53.0, zeta1=0.007, zeta2=0.007, e=0.5
)


def followed(structure, guess, sensor, plan, level):
    """The verdict on a structure that is measured as a plan says."""
    ends = {name: float(plan[f"recommended_{name}"]) for name in ("first", "last", "duration")}
    sine = orchestrate.SweptSine(**ends, acceleration=float(level))
    history = orchestrate.shake(structure, sine, progress=False)
    felt = orchestrate.measure(history, sensor, excitation=sine)
    return str(orchestrate.detect(felt, guess, jobs=1, progress=False).verdict.values)


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2])
def test_a_plan_that_is_followed_to_the_letter_is_decided(count):
    """It recommended 0.01 g, of which detect saw no sine in 213 of 227 windows."""
    own = orchestrate.Sensor(bandwidth=1000.0, noise=1e-3 * 9.80665, seed=5)
    sensor = dict.fromkeys(("box_acceleration", "acceleration1", "acceleration2")[: count + 1], own)
    plan = orchestrate.plan_test(LIGHT, sensor=sensor, progress=False)
    assert plan.counts
    for level in (plan.recommended_level, plan.second_level):
        assert followed(LIGHT, LIGHT, sensor, plan, level) == "delaminated"
        assert followed(LIGHT.as_bonded(), LIGHT, sensor, plan, level) == "no opening seen"
