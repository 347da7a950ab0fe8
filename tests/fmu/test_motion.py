"""Starts, gaps, preloads and near misses: what random motions (:mod:`.test_forces`) leave open."""

import math

import mpmath as mp
import numpy as np
import pytest

from tests import exact_motion as truth

from ..kernels.oscillator.kernel import DEFAULTS
from .programs.driver import open_fmu

STATE = ("x1", "v1", "x2", "v2")


def structure(seed):
    """A damped structure with a gap or a preload, from rest or from random starts."""
    rng = np.random.default_rng((27, seed))
    uniform = rng.uniform
    values = {name: uniform(0.5, 2.0) for name in ("m1", "m2", "k1", "k2")}
    values |= {name: uniform(0.02, 0.3) for name in ("d1", "d2")}
    values |= {"e": uniform(0.0, 0.8), "gamma": 10.0 ** uniform(-3.0, -1.0)}
    values["clearance"] = rng.choice([-1.0, 1.0]) * 10.0 ** uniform(-2.0, 0.5)
    values |= {"box_amplitude": uniform(0.3, 2.0), "box_frequency": uniform(0.4, 2.5)}
    values["phase_start"] = uniform(0.0, 6.28)
    starts = (-uniform(), uniform(), uniform(-1.0, 1.0), uniform(-1.0, 1.0))
    from_rest = rng.random() < 0.5
    names = ("x1_start", "x2_start", "v1_start", "v2_start")
    values |= {name: 0.0 if from_rest else x for name, x in zip(names, starts, strict=True)}
    return {name: float(value) for name, value in values.items()}


@pytest.mark.parametrize(
    ("clearance", "x1", "x2", "gap", "force"),
    [(0.25, 0.0, 0.0, 0.25, 0.0), (-0.25, -0.2, 0.05, 0.0, 0.2)],
)
def test_at_rest_until_it_is_driven(fmu, clearance, x1, x2, gap, force):
    """F = 0.25 * 4/5, x1 = -F/k1, x2 = F/k2; over a time in which no step is too long."""
    f = open_fmu(fmu).start(k1=1.0, k2=4.0, clearance=clearance, box_amplitude=0.0)
    for time in (0.0, 1.0, 1e12):
        row = f.step(time).get("x1", "x2", "x_rel", "contact_force", "box_force")
        assert row == pytest.approx([x1, x2, gap, force, 0.0], abs=1e-15)
        assert f.get("x_rel_max", "impact_count") == [gap, 0]


def test_faces_that_touch_at_the_start_are_together(fmu):
    """Whatever the rounding of the start values: pulled together they stay, and nothing impacts."""
    for clearance in (0.1, 0.3, 0.7, 1e-3):
        x1 = 17.3 * clearance  # x2 - x1 + clearance is rounding, of either sign
        values = {"clearance": clearance, "x1_start": x1, "x2_start": x1 - clearance}
        values |= {"k1": 0.01, "k2": 1e-3, "box_amplitude": 0.0, "box_acceleration": -1.0}
        values |= {"d1": 1e-3, "d2": 0.1, "v1_start": 10.0, "v2_start": 10.0}
        f = open_fmu(fmu).start(**values)
        assert f.get("x_rel", "in_contact", "impact_count") == [0.0, 1, 0]


def test_bonded_ignores_the_clearance(fmu):
    values = {"bonded": True, "box_frequency": 1.13, "x1_start": 0.5, "x2_start": 0.5}
    plain, gap, preload = (
        open_fmu(fmu).start(**values, clearance=clearance).at(3.0, 100.0).outputs()
        for clearance in (0.0, 0.3, -0.3)
    )
    assert plain == gap == preload
    assert plain["impact_count"] == plain["x_rel"] == plain["x_rel_max"] == 0


@pytest.mark.parametrize("clearance", [1e6, -1e6])
def test_a_motion_small_against_the_clearance_keeps_its_digits(fmu, clearance):
    """The faces never part, or never meet: the motion is the linear one, to all its digits."""
    values = {"d1": 0.5, "d2": 0.6, "box_frequency": 1.5, "clearance": clearance}
    other = {**values, "clearance": 0.0, "bonded": clearance < 0.0, "x2_start": 0.0}
    if clearance > 0.0:  # as far apart, without a clearance: mass 1 alone
        other |= {"m2": 1.0, "k2": 1.0, "d2": 0.5}
    rows = []
    for run in (values, other):
        f = open_fmu(fmu).start(**run)
        for k in range(120):
            f.set(box_acceleration=0.01 * (k % 3 - 1))
            rows.append(f.step(0.5 * (k + 1)).one("v1"))
    assert rows[:120] == pytest.approx(rows[120:], abs=1e-13)
    assert max(rows) > 1.0


@pytest.mark.parametrize("damping", [0.01, 0.0])
def test_phase_is_continuous_when_the_frequency_changes(fmu, damping):
    """The integral of box_frequency; nothing jumps on the way to a resonance and away from it."""
    f = open_fmu(fmu).start(phase_start=-1.0, box_frequency=0.4, d1=damping, d2=damping)
    phase = -1.0
    for number, frequency in enumerate((0.4, 3.0, 0.0, 1.0, 1e3, 1.0, 0.7, 0.7), 1):
        before = f.set(box_frequency=frequency).get("phase", *STATE, "impact_count")
        after = f.step(f.time).get("phase", *STATE, "impact_count")  # no time passes
        # a time's rounding times the acceleration
        assert after == pytest.approx(before, abs=1e-12 + 2e-15 * frequency**2)
        phase += 1.7 * frequency
        found = f.step(1.7 * number).one("phase")
        assert 0.0 <= found < 2.0 * math.pi
        assert math.remainder(found - phase, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-11)


def gap_of(x2, values, state, phase=0.0):
    start = (state[0], state[1], x2, state[3])
    first, second = truth.free_motion({**DEFAULTS, **values}, start, mp.mpf(phase))
    return second - first


def first_minimum(gap):
    slope = gap.derivative()
    summit = float(truth.first_root(slope, 20.0)) + 1e-6 if slope(0) > 0 else 0.0
    return truth.first_root(-1 * slope, 20.0, summit)


def grazing_start(values, state, depth):
    """x2 at the start for a first minimum of the gap at ``depth``, by Newton's method; and when."""
    x2 = mp.mpf(state[2])
    for _ in range(7):
        gap, nearby = (gap_of(x2 + shift, values, state) for shift in (0, mp.mpf("1e-20")))
        bottom = first_minimum(gap)
        x2 -= (gap(bottom) - depth) / (nearby(bottom) - gap(bottom)) * mp.mpf("1e-20")
    return float(x2), bottom


EARLY = (-2.0, 0.5, -1.6, -0.8)
GRAZES = [  # in the first interval between nodes, or in a later one
    ({"box_frequency": 0.4}, EARLY),
    ({"box_frequency": 1.3, "d1": 0.2}, EARLY),
    ({"box_frequency": 2.2, "d1": 0.0, "d2": 0.4}, EARLY),
    ({"box_frequency": 0.4}, (0.1, -1.4, 1.15, 0.5)),
    ({"box_frequency": 1.3, "d1": 0.2}, (0.4, -1.4, 0.69, -0.9)),
    ({"box_frequency": 0.4}, (0.2, -1.4, 1.2, -0.7)),
]


@pytest.mark.parametrize(("values", "state"), GRAZES)
def test_a_driven_near_miss_and_a_graze(fmu, values, state):
    """The first minimum lies 1e-8 above or below nothing: no impact is made up, none is missed."""
    values = {"k2": 3.0, **values}
    for depth in (1e-8, -1e-8):
        x2, bottom = grazing_start(values, state, depth)
        names = ("x1_start", "v1_start", "x2_start", "v2_start")
        starts = dict(zip(names, (state[0], state[1], x2, state[3]), strict=True))
        f = open_fmu(fmu).start(**starts, **values).step(float(bottom) + 1e-6)
        first = f.one("impact_count"), f.one("impact_time")
        assert first[0] == (depth < 0.0) and first[1] < bottom
        if depth < 0.0:
            assert first[1] == pytest.approx(float(bottom), abs=1e-3)
