"""Whole motions against an independent event-driven solution: with a gap, a preload, a restitution
that decreases with the closing speed, e(v) = e/(1 + e_slope v), and inputs that are told in pieces.
"""

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from ..kernels.oscillator.kernel import DEFAULTS
from ..kernels.oscillator.test_roots import grazing_start
from .driver import FMUS
from .event_driven import CONTACT, Motion
from .programs.driver import open_fmu

PERIODS = 10
STATE = ("x1", "v1", "x2", "v2")
CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")


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


def decreasing(seed):
    """A structure whose restitution halves at a speed about that of its impacts."""
    values = structure(seed)
    values["clearance"] *= 0.1
    return values | {"e": (0.5, 0.7, 0.9)[seed % 3], "e_slope": (0.1, 0.5, 2.0, 1.0)[seed % 4]}


def touching(seed):
    """A structure without a clearance."""
    return structure(seed) | {"clearance": 0.0}


@functools.cache
def exact(kind, seed):
    """A structure, its time, and its motion by the solver."""
    values = kind(seed)
    stop = PERIODS * 2.0 * np.pi / values["box_frequency"]
    return values, stop, Motion(values).run(stop)


def check(path, runs):
    """How many runs are regular, all of which have to agree, and their impacts and releases.

    A motion is regular where a drive that is larger by 1e-9 leads as near.
    """
    regular_runs = impacts = releases = 0
    f = open_fmu(path)
    for values, stop, motion in runs:
        size = values["box_amplitude"]
        moved = {**values, "box_amplitude": size * (1.0 + 1e-9)}
        names = (*STATE, "impact_count", "in_contact")
        end, other = (f.reset().start(**v).step(stop).get(*names) for v in (values, moved))
        near = np.abs(np.subtract(end[:4], other[:4])).max() / size < 1e-6
        if near and end[4] == other[4]:
            regular_runs += 1
            impacts += len(motion.impacts)
            releases += motion.releases
            apart = np.abs(np.subtract(end[:4], motion.state)).max() / size
            found = (apart < 1e-8, end[4], bool(end[5]))
            assert found == (True, len(motion.impacts), motion.mode == CONTACT), (values, apart)
    return regular_runs, impacts, releases


@pytest.mark.parametrize("kind", [structure, decreasing, touching])
def test_random_structures_move_as_an_independent_solver_says(fmu, kind):
    regular, impacts, releases = check(fmu, [exact(kind, seed) for seed in range(2)])
    assert regular == 2 and impacts > 10 and releases > 0


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "count"), [(structure, 200), (decreasing, 60), (touching, 60)])
def test_many_structures_move_as_an_independent_solver_says(kind, count):
    regular, *events = check(FMUS["fmi3"], [exact(kind, seed) for seed in range(count)])
    print(f"{regular} of {count} motions are regular, {events} impacts and releases")
    assert regular > 0.5 * count


@pytest.mark.parametrize("more", [{}, {"m2": 1.75, "d2": 0.04, "e": 0.8, "box_amplitude": 0.5}])
def test_impacts_of_a_chaotic_stretch_one_by_one(fmu, more):
    """Number, times and speeds; small steps show each with its own time inside its step."""
    values = {"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.2, "d1": 0.01, "d2": 0.01, "e": 0.7}
    values |= {"x1_start": -0.25, "x2_start": 0.5, "v1_start": 0.125, "v2_start": -0.375}
    values |= {"box_frequency": 1.13, "box_amplitude": 1.0 / 1.13**2, "gamma": 1e-4, **more}
    expected = Motion(values).run(60.0)
    assert expected.mode != CONTACT
    f, times, count = open_fmu(fmu).start(**values), [], 0
    while f.time < 60.0:
        begin = f.time
        after, instant, closing = f.step(begin + 2.0**-6).get(
            "impact_count", "impact_time", "impact_velocity"
        )
        if after > count:
            assert after == count + 1 and begin < instant <= f.time and closing > 0.0
            times.append(instant)
        count = after
    assert count > 10
    assert times == pytest.approx(expected.impacts, abs=1e-7)
    assert f.get(*STATE) == pytest.approx(expected.state, abs=1e-6)
    assert open_fmu(fmu).start(**values).step(60.0).get(*STATE) == f.get(*STATE)


@pytest.mark.parametrize(
    ("clearance", "x1", "x2", "gap", "force"),
    [(0.25, 0.0, 0.0, 0.25, 0.0), (-0.25, -0.2, 0.05, 0.0, 0.2)],
)
def test_at_rest_until_it_is_driven(fmu, clearance, x1, x2, gap, force):
    """With k1 = 1, k2 = 4: F = 0.25 * 4/5, x1 = -F/k1, x2 = F/k2; over a time in which no step is
    too long.
    """
    f = open_fmu(fmu).start(k1=1.0, k2=4.0, clearance=clearance, box_amplitude=0.0)
    for time in (0.0, 1.0, 1e12):
        row = f.step(time).get("x1", "x2", "x_rel", "contact_force", "box_force")
        assert row == pytest.approx([x1, x2, gap, force, 0.0], abs=1e-15)
        assert f.get("x_rel_max", "impact_count") == [gap, 0]


def test_a_preload_opens_where_the_face_lets_go(fmu):
    """Alike halves of mass and stiffness 1 pressed together by 0.5: only the impulse of a start
    parts them, and the gap is that of one oscillator about its opened position, 0.5 beyond the
    faces.
    """
    alike = {"k2": 1.0, "d1": 0.0, "d2": 0.0, "clearance": -0.5, "box_amplitude": 0.0}
    f = open_fmu(fmu).start(**alike, v1_start=-0.75, v2_start=0.75, e=0.0)
    times = np.linspace(0.1, 2.4, 24)
    gap = -0.5 + 0.5 * np.cos(times) + 1.5 * np.sin(times)
    lands = times < 2.0 * np.arctan(3.0)
    assert lands.sum() > 10
    found = [f.step(float(time)).one("x_rel") for time in times]
    assert found == pytest.approx(np.where(lands, gap, 0.0), abs=1e-14)


def test_starts_count_from_rest(fmu):
    names = ("x1", "x2", "x_rel", "in_contact")
    pressed = {"k2": 1.0, "clearance": -0.5, "x1_start": 0.125, "x2_start": 0.375}
    apart = {"clearance": 0.5, "x1_start": 0.75, "x2_start": 0.3}
    found = open_fmu(fmu).start(**pressed).get(*names)
    assert found == pytest.approx([0.125 - 0.25, 0.375 + 0.25, 0.25, 0])
    found = open_fmu(fmu).start(**apart).get(*names)
    assert found == pytest.approx([0.75, 0.3, 0.05, 0]) and found[:2] == [0.75, 0.3]


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
    """A million times larger than the box's motion: the faces never part, or never meet, and the
    motion is the linear one to all its digits, over inputs that are set at each step.
    """
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


def test_phase_is_continuous_when_the_frequency_changes(fmu):
    """The phase is the integral of box_frequency, from phase_start on; positions and velocities do
    not jump either.
    """
    f, phase = open_fmu(fmu).start(phase_start=-1.0, box_frequency=0.4), -1.0
    for number, frequency in enumerate((0.4, 3.0, 0.0, 1e3, 0.7, 0.7), 1):
        before = f.set(box_frequency=frequency).get("phase", *STATE, "impact_count")
        after = f.step(f.time).get("phase", *STATE, "impact_count")  # no time passes
        # a time's rounding times the acceleration
        assert after == pytest.approx(before, abs=1e-12 + 2e-15 * frequency**2)
        phase += 1.7 * frequency
        found = f.step(1.7 * number).one("phase")
        assert 0.0 <= found < 2.0 * math.pi
        assert math.remainder(found - phase, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-11)


def signal(t):
    """A box acceleration, smooth and without a period, and its first three derivatives."""
    parts = ((0.8, 0.9, 0.3), (0.5, 1.7, 1.1), (-0.3, 2.3, 0.0))
    return [
        sum(a * w**n * math.cos(w * t + p + 0.5 * math.pi * n) for a, w, p in parts)
        for n in range(4)
    ]


def test_piecewise_cubic_acceleration_against_integration(fmu):
    """With value and three derivatives set at each step the FMU follows a smooth signal to the
    fourth power of the step.
    """
    values = {"m1": 1.0, "m2": 1.5, "k1": 1.0, "k2": 1.4, "d1": 0.05, "d2": 0.03, "e": 0.8}
    values |= {"x1_start": -0.5, "x2_start": 0.5, "box_amplitude": 0.0}
    exact = Motion({**values, "box_frequency": 2.3, "gamma": 1e-4}, lambda t: signal(t)[0])
    times = [0.5 * k for k in range(1, 41)]
    expected = [exact.run(time).state.copy() for time in times]
    errors = []
    for step in (2.0**-3, 2.0**-5):
        f, found = open_fmu(fmu).start(**values), []
        while f.time < times[-1]:
            f.set(**dict(zip(CUBIC, signal(f.time), strict=True)))
            f.step(f.time + step)
            if f.time % 0.5 == 0.0:
                found.append(f.get(*STATE))
        assert f.get("impact_count", "contact_count") == [len(exact.impacts), 0]
        errors.append(np.max(np.abs(np.array(found) - expected)))
    coarse, fine = errors
    assert len(exact.impacts) > 5
    assert coarse < 3e-4
    assert fine < 1e-6
    assert coarse / fine > 100  # 4^4 = 256 in the limit


def test_cubic_input_over_one_step_is_exact(fmu):
    """The cubic holds over the whole step, far beyond small ones: impulse and moment too."""
    g = [0.3, -0.2, 0.15, -0.05]
    values = dict(zip(CUBIC, g, strict=True))
    f = open_fmu(fmu).start(box_amplitude=0.0, bonded=True, **values).step(5.0)

    def right(t, y):
        force = 2.2 * y[0] + 0.02 * y[1]
        push = g[0] + t * (g[1] + t * (g[2] / 2 + t * g[3] / 6))
        return [y[1], -0.5 * force - push, force, t * force]

    exact = solve_ivp(right, (0.0, 5.0), [0.0] * 4, method="DOP853", rtol=1e-13, atol=1e-14)
    names = ("x1", "v1", "box_impulse", "box_impulse_moment")
    assert f.get(*names) == pytest.approx(exact.y[:, -1], abs=1e-11)
    assert f.get("x2", "v2") == f.get("x1", "v1")


@pytest.mark.parametrize("name", (*CUBIC, "box_amplitude"))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_derivative_moves_masses_from_rest(fmu, name, sign):
    """From rest at the touching point only the first derivative that does not vanish decides: apart
    for +, pressed together for -; a harmonic motion of the box begins with its jerk.
    """
    values = {"box_amplitude": 0.0, name: sign}
    expected = Motion({**DEFAULTS, "x1_start": 0.0, "x2_start": 0.0, **values}).run(1.0)
    names = ("x1", "x2", "impact_count", "contact_count", "in_contact")
    x1, x2, *found = open_fmu(fmu).start(**values).at(2.0**-10, 1.0).get(*names)
    begins_apart = (sign > 0) == (name != "box_amplitude")
    assert found == [0, 0, not begins_apart]
    assert (len(expected.impacts), expected.mode == CONTACT) == (0, not begins_apart)
    assert [x1, x2] == pytest.approx(expected.state[[0, 2]], rel=1e-7)


GRAZES = [
    {"box_frequency": 0.4},
    {"box_frequency": 1.3, "d1": 0.2},
    {"box_frequency": 2.2, "d1": 0.0, "d2": 0.4},
]


@pytest.mark.parametrize("values", GRAZES)
def test_a_driven_near_miss_and_a_graze(fmu, values):
    """The gap's first minimum lies 1e-8 above or below nothing, by high precision: not one impact
    is made up, and none is missed, by a step that ends behind it or long after.
    """
    values, state = {"k2": 3.0, **values}, (-2.0, 0.5, -1.6, -0.8)
    for depth in (1e-8, -1e-8):
        x2, bottom = grazing_start(values, state, depth)
        starts = dict(zip(("x1_start", "v1_start", "v2_start"), (-2.0, 0.5, -0.8), strict=True))
        f = open_fmu(fmu).start(x2_start=x2, **starts, **values).step(float(bottom) + 1e-6)
        first = f.one("impact_count"), f.one("impact_time")
        assert first[0] == (depth < 0.0) and first[1] < bottom
        if depth < 0.0:
            assert first[1] == pytest.approx(float(bottom), abs=1e-3)
