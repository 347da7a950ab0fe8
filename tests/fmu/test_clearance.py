"""A clearance between the faces, a gap or a preload: against an independent event-driven solution,
at rest, at the start, and as large or as small as it may be against the motion.
"""

import numpy as np
import pytest

from .driver import FMUS, run
from .event_driven import CONTACT, Motion

PERIODS = 20
NAMES = ("x1", "v1", "x2", "v2", "impact_count", "in_contact", "x_rel")


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


def differences(path, seeds, cwd):
    """Of each seed: the states' distance over the amplitude, the impacts of both, whether the
    motion is regular, and whether both are in contact.

    A motion is regular where a start that is moved by 1e-9 of the amplitude ends as near.
    """
    runs = [structure(seed) for seed in seeds]
    moved = [{**v, "v1_start": v["v1_start"] + 1e-9 * v["box_amplitude"]} for v in runs]
    stops = [PERIODS * 2.0 * np.pi / values["box_frequency"] for values in runs]
    found = run("clearance.ends", path, runs + moved, stops + stops, NAMES, cwd=cwd, timeout=1500)
    for values, stop, end, other in zip(runs, stops, found, found[len(runs) :], strict=False):
        motion = Motion(values).run(stop)
        size = values["box_amplitude"]
        apart = np.abs(np.subtract(end[:4], motion.state)).max() / size
        regular = np.abs(np.subtract(end[:4], other[:4])).max() / size < 1e-6
        contact = bool(end[5]) == (motion.mode == CONTACT)
        yield apart, end[4], len(motion.impacts), regular and end[4] == other[4], contact


def check(path, seeds, cwd):
    regular_runs = impacts = 0
    for seed, (apart, count, expected, regular, contact) in zip(
        seeds, differences(path, seeds, cwd), strict=True
    ):
        if regular:
            assert (apart < 1e-8, count, contact) == (True, expected, True), (seed, apart)
        regular_runs += regular
        impacts += expected
    return regular_runs, impacts


def test_random_structures_move_as_an_independent_solver_says(tmp_path):
    regular, impacts = check(FMUS["fmi3"], range(6), tmp_path)
    assert regular >= 4
    assert impacts > 50


@pytest.mark.slow
def test_two_hundred_structures_move_as_an_independent_solver_says(tmp_path):
    regular, impacts = check(FMUS["fmi3"], range(200), tmp_path)
    print(f"{regular} of 200 motions are regular, {impacts} impacts")
    assert regular >= 135


@pytest.mark.parametrize(
    ("clearance", "x1", "x2", "gap", "force"),
    [(0.25, 0.0, 0.0, 0.25, 0.0), (-0.25, -0.2, 0.05, 0.0, 0.2)],
)
def test_at_rest_until_it_is_driven(fmu, tmp_path, clearance, x1, x2, gap, force):
    """With k1 = 1, k2 = 4: F = 0.25 * 4/5, x1 = -F/k1, x2 = F/k2; over a time in which no step is
    too long.
    """
    values = {"k1": 1.0, "k2": 4.0, "clearance": clearance, "box_amplitude": 0.0}
    names = ("x1", "x2", "x_rel", "contact_force", "box_force", "x_rel_max", "impact_count")
    rows = run("clearance.rows", fmu, values, [0.0, 1.0, 1e12], names, cwd=tmp_path)
    for row in rows:
        assert row[:5] == pytest.approx([x1, x2, gap, force, 0.0], abs=1e-15)
        assert row[5:] == [gap, 0]


def test_a_preload_opens_where_the_face_lets_go(fmu, tmp_path):
    """Alike halves of mass and stiffness 1 pressed together by 0.5: only the impulse of a start
    parts them, and the gap is that of one oscillator about its opened position, 0.5 beyond the
    faces.
    """
    alike = {"k2": 1.0, "d1": 0.0, "d2": 0.0, "clearance": -0.5, "box_amplitude": 0.0}
    values = {**alike, "v1_start": -0.75, "v2_start": 0.75, "e": 0.0}
    times = np.linspace(0.1, 2.4, 24)
    rows = run("clearance.rows", fmu, values, times.tolist(), ("x_rel", "v_rel"), cwd=tmp_path)
    gap = -0.5 + 0.5 * np.cos(times) + 1.5 * np.sin(times)
    lands = times < 2.0 * np.arctan(3.0)
    assert lands.sum() > 10
    assert np.array(rows)[:, 0] == pytest.approx(np.where(lands, gap, 0.0), abs=1e-14)


def test_starts_count_from_rest_and_overlap_is_refused(fmu, tmp_path):
    names = ("x1", "x2", "x_rel", "in_contact")
    pressed = {"k2": 1.0, "clearance": -0.5, "x1_start": 0.125, "x2_start": 0.375}
    apart = {"clearance": 0.5, "x1_start": 0.75, "x2_start": 0.3}
    rows = [run("clearance.rows", fmu, v, [0.0], names, cwd=tmp_path)[0] for v in (pressed, apart)]
    assert rows[0] == pytest.approx([0.125 - 0.25, 0.375 + 0.25, 0.25, 0])
    assert rows[1] == pytest.approx([0.75, 0.3, 0.05, 0])
    assert rows[1][:2] == [0.75, 0.3]
    for values, words in (
        ({**pressed, "x2_start": 0.12}, ("x2_start = 0.12 m", "x2_start >= x1_start = 0.125 m")),
        ({**apart, "x2_start": 0.2}, ("x2_start = 0.2 m", "clearance = 0.25 m", "x1_start")),
        ({"clearance": float("nan")}, ("clearance = nan m", "-1e+100 <= clearance <= 1e+100")),
    ):
        message = run("clearance.refusal", fmu, values, cwd=tmp_path)
        for word in words:
            assert word in message


def test_faces_that_touch_at_the_start_are_together(fmu, tmp_path):
    """Whatever the rounding of the start values: pulled together they stay, and nothing impacts."""
    names = ("x_rel", "in_contact", "impact_count")
    for clearance in (0.1, 0.3, 0.7, 1e-3):
        x1 = 17.3 * clearance  # x2 - x1 + clearance is rounding, of either sign
        values = {"clearance": clearance, "x1_start": x1, "x2_start": x1 - clearance}
        values |= {"k1": 0.01, "k2": 1e-3, "box_amplitude": 0.0, "box_acceleration": -1.0}
        values |= {"d1": 1e-3, "d2": 0.1, "v1_start": 10.0, "v2_start": 10.0}
        assert run("clearance.rows", fmu, values, [0.0], names, cwd=tmp_path) == [[0.0, 1, 0]]


def test_bonded_ignores_the_clearance(fmu, tmp_path):
    values = {"bonded": True, "box_frequency": 1.13, "x1_start": 0.5, "x2_start": 0.5}
    names = ("x1", "x2", "v1", "x_rel", "box_force", "impact_count", "x_rel_max")
    times = [0.0, 3.0, 100.0]
    plain = run("clearance.rows", fmu, values, times, names, cwd=tmp_path)
    for clearance in (0.3, -0.3):
        with_clearance = {**values, "clearance": clearance}
        assert run("clearance.rows", fmu, with_clearance, times, names, cwd=tmp_path) == plain


@pytest.mark.parametrize("clearance", [1e6, -1e6])
def test_a_motion_small_against_the_clearance_keeps_its_digits(fmu, tmp_path, clearance):
    """A million times larger than the box's motion: the faces never part, or never meet, and the
    motion is the linear one to all its digits, over inputs that are set at each step.
    """
    values = {"d1": 0.5, "d2": 0.6, "box_frequency": 1.5, "clearance": clearance}
    times = np.linspace(0.5, 60.0, 120).tolist()
    rows = run("clearance.pushed_rows", fmu, values, times, ("v1", "v2"), cwd=tmp_path)
    other = {**values, "clearance": 0.0, "bonded": clearance < 0.0, "x2_start": 0.0}
    if clearance > 0.0:  # as far apart, without a clearance: mass 1 alone
        other |= {"x1_start": 0.0, "x2_start": 0.0, "m2": 1.0, "k2": 1.0, "d2": 0.5}
    plain = run("clearance.pushed_rows", fmu, other, times, ("v1", "v2"), cwd=tmp_path)
    assert np.array(rows)[:, 0] == pytest.approx(np.array(plain)[:, 0], abs=1e-13)
    assert np.abs(np.array(rows)[:, 0]).max() > 1.0
