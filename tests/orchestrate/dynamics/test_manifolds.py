"""Unstable manifolds: curves that are known exactly, and that of a saddle by its inverse map."""

import functools
import math

import numpy as np
import pytest
from scipy.linalg import expm

import orchestrate
from orchestrate import Structure
from orchestrate.dynamics import manifolds
from orchestrate.dynamics.curve_growth import CurveGrower, CurvePoint, GrowthSettings
from orchestrate.fmu import OSCILLATOR, Instance, begin
from orchestrate.model.ranges import PUSHES
from orchestrate.response.questions import make_point

from .single_impact import GAP, SingleImpact

PAPER = Structure.nondimensional()
QUIET = {"progress": False}
SETTINGS = GrowthSettings(length=3.0, spacing=0.02, angle=0.2, max_points=3000, resolution=1e-10)
START = 1e-5  # of the first piece, from the saddle


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
    curve = CurveGrower(
        images(lambda z: np.array([a * z[0], b * z[1] + (a * a - b) * z[0] ** 2]), a), SETTINGS
    ).grow()
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


@pytest.mark.parametrize("height", [0.5, 1e-3])
@pytest.mark.parametrize("power", [0.0, 0.2, 0.3, 0.5])
def test_a_jump_breaks_the_curve_and_a_root_does_not(height, power):
    """Beyond x = 1: y is higher, by a step at once or by a square root as at a grazing impact."""

    def step(z):
        more = height * max(z[0] - 1.0, 0.0) ** power if z[0] > 1.0 else 0.0
        return np.array([1.7 * z[0], 0.4 * z[1] + more])

    settings = GrowthSettings(2.5, 0.02, 0.2, 3000, resolution=1e-10)
    curve = CurveGrower(images(step, 1.7, lambda z: (int(z[0] > 1.0),)), settings).grow()
    if power > 0.25:
        assert not curve.breaks and curve.arclength[-1] > 2.5
        return
    ((number, border),) = curve.breaks.items()
    assert border.distance == pytest.approx(height, rel=1e-6) or power
    assert abs(border.power - power) < 0.03
    assert curve.points[number - 1].state[0] == pytest.approx(1.7, abs=1e-8)
    assert curve.arclength[number] == curve.arclength[number - 1]


def test_a_curve_that_converges_ends():
    """2 x/(1 + x) leads from 0 to 1."""
    map_of = images(lambda z: np.array([2.0 * z[0] / (1.0 + z[0]), 0.5 * z[1]]), 2.0)
    curve = CurveGrower(map_of, SETTINGS).grow()
    assert curve.end == "converges" and curve.arclength[-1] == pytest.approx(1.0, abs=1e-4)


@functools.cache
def curve(**more):
    return orchestrate.manifold(PAPER, eta=3.0, **{"length": 1.0, **more}, **QUIET)


def test_its_direction_is_the_eigenvector_at_phase_0():
    """Of flight, saltation and flight, as single impacts have them."""
    saddle, hit = manifolds.ManifoldJob(**job_fields()).saddle(), SingleImpact(3.0, 1)
    drive = hit.b * math.sin(hit.phase)
    incoming = hit.a @ hit.state + drive
    jump = hit.a @ hit.restitution @ hit.state + drive - hit.restitution @ incoming
    saltation = hit.restitution + np.outer(jump, GAP) / (GAP @ incoming)
    first = hit.phase / 3.0
    matrix = expm(hit.a * (hit.time - first)) @ saltation @ expm(hit.a * first)
    image = matrix @ saddle.direction
    assert image == pytest.approx(saddle.multiplier * saddle.direction, abs=1e-9)


def test_images_of_its_points_lie_on_it():
    """By the FMU, two periods: on the points of numbers greater by 1, to 1e-8."""
    job = manifolds.ManifoldJob(**job_fields())
    saddle, sides = job.saddle(), {}
    with Instance(exported_path()) as instance:
        data = curve()
        part = data.sel(side="-")
        numbers = np.flatnonzero((part.iterate.values > 1.0) & (part.iterate.values < 4.0))[::9]
        box = make_point(PAPER, {"eta": 3.0})
        for i in numbers:
            begin(instance, *box, part.state.values[i])
            instance.step(0.0, 2.0 * box.excitation.period)
            image = np.array(instance.get("x1", "x2", "v1", "v2"))
            s = float(part.iterate[i]) + 1.0
            sides[i] = np.abs(image - job.point_function(instance, saddle, -1.0)(s).state).max()
    assert len(sides) > 5 and max(sides.values()) < 1e-8


def job_fields():
    start = orchestrate.orbit(PAPER, eta=3.0, **QUIET)
    found = manifolds.guess_from_result(start)
    numbers = {"length": 2.0, "spacing": 0.005, "angle": 0.2, "distance": 1e-5, "most": 100}
    names = {"name": "manifold", "structure": PAPER, "excitation": (("eta", 3.0),)}
    pushes = dict.fromkeys(PUSHES, 0.0)
    return {**names, **pushes, "start": found, "period": 1, **numbers}


def exported_path():
    from orchestrate.fmu import finder

    return finder({})(OSCILLATOR).path


def test_breaks_are_rows_of_nan_and_never_connected():
    data = curve()
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
