"""Unstable manifolds: curves that are known exactly, and that of a saddle by its inverse map."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import orchestrate
from orchestrate import Structure
from orchestrate.dynamics import manifolds
from orchestrate.dynamics.curve_growth import (
    CurveGrower,
    CurvePoint,
    GrownCurve,
    GrowthSettings,
    ItineraryChange,
    shrinking_power,
)
from orchestrate.model.ranges import PUSHES

from .single_impact import SingleImpact

PAPER = Structure.nondimensional()
QUIET = {"progress": False}
SETTINGS = GrowthSettings(length=3.0, spacing=0.02, angle=0.2, max_points=3000, resolution=1e-10)
START = 1e-5  # of the first piece, from the saddle


def grown(image, spacing=1.0, **more):
    """The numbers of a curve's points, of states along an axis or in a plane."""
    usual = {"length": 1e9, "angle": 0.2, "max_points": 5}
    settings = GrowthSettings(**usual | more, spacing=spacing)
    asked = iter(range(200))  # at most
    point = lambda s: CurvePoint(s, *image(s + 0.0 * next(asked)))  # noqa: E731
    return [each.s for each in CurveGrower(point, settings).grow().points]


def line(s):
    return np.array([s + 3.0, 4.0]), (0,)


def bent(angle):
    """A line that turns at 0.05."""
    beyond = lambda s: max(s - 0.05, 0.0)  # noqa: E731
    turn = np.array([math.cos(angle) - 1.0, math.sin(angle)])
    return lambda s: (line(s)[0] + beyond(s) * turn, (0,))


GAP_LEFT = 0.05 / 2**20  # by halves


@pytest.mark.parametrize(
    ("image", "asked", "expected"),
    [
        (line, {"max_points": 7}, [0.0, 0.05, 0.125, 0.2375, 0.40625, 0.65625, 0.90625]),
        (line, {"spacing": 0.05 / 0.49}, [0.0, 0.05, 0.125, 0.2, 0.275]),  # easy: below a half
        (line, {"spacing": 0.05 / 0.51}, [0.0, 0.05, 0.1, 0.15, 0.2]),
        (line, {"spacing": 0.049}, [0.0, 0.025, 0.05, 0.075, 0.1]),
        (bent(0.099), {}, [0.0, 0.05, 0.125, 0.2375, 0.40625]),
        (bent(-0.101), {}, [0.0, 0.05, 0.125, 0.2, 0.3125]),
        (bent(0.199), {}, [0.0, 0.05, 0.125, 0.2, 0.3125]),
        (bent(0.201), {"max_points": 3}, [0.0, 0.05, 0.059375]),  # a hundredth may bend at will
        (bent(3.1), {"max_points": 3, "spacing": 0.93}, [0.0, 0.05, 0.0546875]),
        (  # of impacts that change, and steps of a thousandth behind
            lambda s: (line(s)[0], (int(s > 0.06),)),
            {"max_points": 6},
            [0.0, 0.05, 0.06, 0.06, 0.061, 0.0625],
        ),
        *(
            (
                lambda s: (np.array([s + 9.0 * (s > 0.0), 0.0]), (0,)),
                {"max_points": 2, "resolution": GAP_LEFT / part},
                [0.0, GAP_LEFT * (1.0 if part > 0.5 else 2.0)],
            )
            for part in (0.7, 0.45)
        ),
    ],
)
def test_steps_adapt_to_distance_and_bend(image, asked, expected):
    assert grown(image, **asked) == pytest.approx(expected, rel=1e-12)


GROWER = CurveGrower(None, GrowthSettings(length=3.0, spacing=0.02, angle=0.2, max_points=7))


@pytest.mark.parametrize("low", [0.0, 3.0])
def test_a_change_is_bisected_to_rounding(low):
    """To 1e-14, of larger numbers to that part: here 20 times."""
    asked = []

    def image(s):
        asked.append(s)
        return CurvePoint(s, np.zeros(2), (int(s > low),))

    start, width = CurvePoint(low, np.zeros(2), (0,)), 0.7e-14 * max(low, 1.0)
    found = CurveGrower(image, GROWER.settings).bisect_change(start, image(low + 2**20 * width))
    assert len(asked) == 21 and found.high.s - low == pytest.approx(width, rel=0.1)


@pytest.mark.parametrize(
    ("distance", "power", "size", "broken"),
    [
        *((1.01e-12, 0.24, 1.0, True), (0.99e-12, 0.0, 1.0, False), (1.0, 0.26, 1.0, False)),
        *((1.99e-12, 0.0, 2.0, False), (2.01e-12, 0.0, 2.0, True)),
    ],
)
def test_a_break_is_no_root_and_more_than_rounding(distance, power, size, broken):
    settings = GROWER.settings if size == 1.0 else replace(GROWER.settings, size=size)
    grower, here = CurveGrower(None, settings), CurvePoint(0.0, np.zeros(2), ())
    curve = GrownCurve([here], [0.0])
    grower.append_beyond_change(curve, ItineraryChange(here, here, distance, power))
    assert (list(curve.breaks), curve.arclength) == ([1] * broken, [0.0, distance * (not broken)])
    grower.direction = np.array([1.0, 0.0])
    up = CurvePoint(0.0, np.array([0.0, distance]), ())
    assert grower.angle_to(here, up) == (0.5 * math.pi if distance > 1e-12 * size else 0.0)


def test_the_angle_of_chords_in_one_line_is_none():
    """Whatever rounding makes of their cosine."""
    grower, here = CurveGrower(None, GROWER.settings), CurvePoint(0.0, np.zeros(4), ())
    for chord in np.random.default_rng(1).normal(size=(200, 4)):
        grower.direction = chord / np.linalg.norm(chord)
        angles = [grower.angle_to(here, CurvePoint(0.0, one, ())) for one in (chord, -chord)]
        assert angles == pytest.approx([0.0, math.pi], abs=1e-7)


@pytest.mark.parametrize(
    ("count", "far", "near", "power"),
    [
        *((9, (4.0, 8.0), (1.0, 1.0), 1.5), (7, (4.0, 2.0), (1.0, 1.0), 0.5)),
        *((7, (1.0, 2.0), (1.0, 1.0), 0.0), (7, (1.0, 2.0), (1.0, 0.0), 1.0)),
        *((7, (4.0, 0.0), (1.0, 1.0), 0.0), (7, (4.0, 1.0), (1.0, 0.0), 1.0)),
    ],
)
def test_the_power_is_that_of_the_last_quarter_of_a_bisection(count, far, near, power):
    history = [(math.nan, math.nan)] * count
    history[-1 - count // 4], history[-1] = far, near
    assert shrinking_power(history) == pytest.approx(power)


@pytest.mark.parametrize(
    ("lengths", "more", "end"),
    [
        *(([0, 1, 2, 2.5, 2.9, 2.99], {}, ""), ([0, 1, 2, 2.5, 2.9, 3.01], {}, "length")),
        ([0, 1, 2, 2.5, 2.9, 2.95, 2.99], {}, "most points"),
        ([0, 0.5, 1, 1, 1, 1 + 0.99e-7], {}, "converges"),
        ([0, 0.5, 1, 1, 1, 1 + 1.01e-7], {}, ""),
        *(([0, 0.5, 0.9, 1, 1, 1], {}, ""), ([0, 0.019, 0.019, 0.019, 0.019, 0.019], {}, "")),
        *(([0, 0.5, 1, 1, 1, 1], {"max_step": 1.4}, "converges"), ([1, 1], {}, "")),
        ([0, 0.5, 1, 1, 1, 1], {"max_step": 1.6}, ""),
    ],
)
def test_why_a_curve_ends(lengths, more, end):
    """It converges where the last two pieces, or steps, gain less than 1e-7."""
    curve = GrownCurve([CurvePoint(float(s), None, ()) for s in range(len(lengths))], lengths)
    assert CurveGrower(None, replace(GROWER.settings, **more)).end_reason(curve) == end


def images(step, growth, fold=lambda state: (0,)):
    """The images of the first piece along the first co-ordinate under a map with a saddle at 0."""

    def image(s):
        state = np.array([START * growth ** (s - math.floor(s)), 0.0])
        itinerary = np.zeros(1, dtype=int)
        for _ in range(math.floor(s)):
            itinerary += fold(state)
            state = step(state)
        return CurvePoint(s, state, tuple(itinerary.tolist()))

    return image


def test_a_parabola_that_is_a_manifold_exactly():
    """Of (a x, b y + (a^2 - b) x^2), y = x^2 is invariant; distance and angle are kept."""
    a, b = 1.7, 0.4
    step = lambda z: np.array([a * z[0], b * z[1] + (a * a - b) * z[0] ** 2])  # noqa: E731
    curve = CurveGrower(images(step, a), SETTINGS).grow()
    states = np.array([point.state for point in curve.points])
    x, y = states.T
    assert y == pytest.approx(x**2, abs=3.0 * START**2)
    assert curve.end == "length" and not curve.breaks
    chords = np.diff(states, axis=0)
    assert np.linalg.norm(chords, axis=1).max() <= SETTINGS.spacing
    angles = np.arctan2(chords[:, 1], chords[:, 0])
    assert np.abs(np.diff(angles)).max() <= SETTINGS.angle
    exact = 0.5 * x[-1] * math.hypot(1.0, 2.0 * x[-1]) + 0.25 * math.asinh(2.0 * x[-1])
    assert curve.arclength[-1] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(("power", "impacts"), [(0.0, True), (0.0, False), (0.5, True)])
def test_a_jump_breaks_the_curve_and_a_root_does_not(power, impacts):
    """Beyond x = 1: y is higher, by a step at once or by a square root as at a grazing impact;
    where no impact tells, numbers are divided as far as may be.
    """

    def step(z):
        more = 0.5 * max(z[0] - 1.0, 0.0) ** power if z[0] > 1.0 else 0.0
        return np.array([1.7 * z[0], 0.4 * z[1] + more])

    image = images(step, 1.7, lambda z: (int(impacts and z[0] > 1.0),))
    curve = CurveGrower(image, replace(SETTINGS, length=2.5)).grow()
    if power:
        assert not curve.breaks and curve.arclength[-1] > 2.5
        return
    ((number, border),) = curve.breaks.items()
    assert border.distance == pytest.approx(0.5, rel=1e-6) and abs(border.power) < 0.03
    assert border.low.state[0] <= 1.7 < border.high.state[0] == pytest.approx(1.7, abs=1e-8)
    assert curve.arclength[number] == curve.arclength[number - 1]


def test_its_direction_is_the_eigenvector_at_phase_0():
    """Of flight, saltation and flight, as single impacts have them."""
    saddle, hit = manifolds.ManifoldJob(**job_fields()).solve_saddle(), SingleImpact(3.0, 1)
    first = hit.phase / 3.0
    matrix = expm(hit.a * (hit.time - first)) @ hit.saltation @ expm(hit.a * first)
    image = matrix @ saddle.direction
    assert image == pytest.approx(saddle.multiplier * saddle.direction, abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_first_piece_ends_where_its_image_begins(instances, sign):
    """But for the square of the distance: by direction, multiplier and periods of a return."""
    job = manifolds.ManifoldJob(**job_fields())
    saddle = job.solve_saddle()
    image = job.make_point_function(instances[0], saddle, sign)
    end, begin, saddle_state = image(1.0 - 1e-15).state, image(1.0).state, saddle.state
    assert np.abs(begin - end).max() < 1e-3 * np.abs(end - saddle_state).max()
    assert sign * np.diff((begin - saddle_state)[:2]) > 0.0  # the gap grows, or falls


def job_fields():
    found = manifolds.guess_from_result(orchestrate.orbit(PAPER, eta=3.0, **QUIET))
    names = {"name": "manifold", "structure": PAPER, "excitation": (("eta", 3.0),)}
    return {**names, **dict.fromkeys(PUSHES, 0.0), "start": found, "period": 1}


def test_breaks_are_rows_of_nan_and_never_connected():
    data = orchestrate.manifold(PAPER, eta=3.0, length=0.6, **QUIET)
    for number, side in enumerate("+-"):
        part = data.sel(side=side)
        last = int(np.flatnonzero(np.isfinite(part.arclength.values))[-1])
        inside = part.isel(point=slice(0, last + 1))
        holes = np.flatnonzero(np.isnan(inside.x_rel.values))
        assert len(holes) == int((data.break_side == number).sum())
        chords = np.linalg.norm(np.diff(inside.xi.values, axis=0), axis=1)
        assert np.nanmax(chords) <= 1.001 * 0.005 * float(data.orbit_size)
    # an impact that passes phase 0 is the first break: it closes the gap there
    first = data.isel({"break": 0})
    part = data.isel(side=int(first.break_side))
    hole = int(np.flatnonzero(np.isnan(part.x_rel.values))[0])
    assert abs(part.x_rel.values[[hole - 1, hole + 1]]).max() < 1e-9
    rates = part.v_rel.values[[hole - 1, hole + 1]]
    assert max(rates) == pytest.approx(-PAPER.e * min(rates), rel=1e-5)
    assert abs(int(first.break_impacts)) == 1
