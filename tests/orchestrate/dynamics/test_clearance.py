"""Orbits, branches, exponents, attractors and basins of structures with a gap or a preload."""

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure
from orchestrate.dynamics.closed_form import ClosedForm
from orchestrate.model import Excitation
from orchestrate.response.questions import Point

DAMPED = Structure(d1=0.1, d2=0.12, e=0.5)
BOX = {"frequency": 1.2, "amplitude": 1.0}


def test_a_border_begins_where_an_open_structure_touches():
    """Grazing of the linear orbit over the clearance is the threshold of contact, and its curve
    over clearance and amplitude is the straight line that scaling says.
    """
    open_structure = DAMPED.replace(clearance=2.0)
    level = orchestrate.contact_threshold(open_structure, frequency=1.2)
    touching = 2.0 / float(level.threshold_amplitude[0])  # clearance at amplitude 1
    wide = open_structure.replace(clearance=1.2 * touching)
    form = ClosedForm.from_structure(wide, Excitation(**BOX))
    steady = Point(wide, Excitation(**BOX)).from_faces(form.steady_response(np.zeros(1)))
    apart = orchestrate.orbit(wide, **BOX, guess=steady[0])  # from rest it impacts: another branch
    assert float(apart.impacts_per_period) == 0.0
    limits = (0.9 * touching, 1.4 * touching)
    found = orchestrate.branch(wide, start=apart, over="clearance", limits=limits)
    assert found.bifurcation_value.values == pytest.approx([touching], rel=1e-9)
    curve = orchestrate.border(
        wide,
        start=found,
        bifurcation=0,
        over=("clearance", "amplitude"),
        limits=[(0.5 * touching, 1.4 * touching), (0.6, 1.3)],
        longest=0.1,
    )
    assert curve.sizes["point"] > 3
    assert curve.clearance.values / curve.amplitude.values == pytest.approx(touching, rel=1e-8)


@pytest.mark.slow
def test_a_border_follows_the_opening_of_a_pressed_structure():
    """The earlier release of the motion that is held together for good is the threshold; over
    frequency and amplitude it is the closed form's curve, which has a resonance between the limits.
    """
    pressed = DAMPED.replace(clearance=-0.2)
    level = orchestrate.contact_threshold(pressed, frequency=1.2)
    opening = float(level.threshold_amplitude[0])
    held = orchestrate.orbit(pressed, frequency=1.2, amplitude=0.5 * opening)
    assert bool(held.permanent_contact) and float(held.impacts_per_period) == 0.0
    limits = (0.4 * opening, 1.3 * opening)
    found = orchestrate.branch(pressed, start=held, over="amplitude", limits=limits)
    assert found.bifurcation_value.values == pytest.approx([opening], rel=1e-9)
    names = ("amplitude", "frequency")
    box = [(0.01, 5.0), (0.7, 1.6)]
    curve = orchestrate.border(
        pressed, start=found, bifurcation=0, over=names, limits=box, longest=0.3
    )
    assert curve.attrs["kind"] == found.attrs["last_end"] == "earlier release"
    assert curve.frequency.values[[0, -1]].tolist() == [0.7, 1.6]
    expected = orchestrate.contact_threshold(pressed, frequency=curve.frequency.values)
    assert curve.amplitude.values == pytest.approx(expected.threshold_amplitude.values, rel=1e-9)
    assert curve.sizes["point"] > 5 and 0 < curve.amplitude.values.argmin() < len(curve.point) - 1
