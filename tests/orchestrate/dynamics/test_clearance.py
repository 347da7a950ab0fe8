"""Orbits, branches, exponents, attractors and basins of structures with a gap or a preload."""

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure
from orchestrate.dynamics.closed_form import FREE, INNER, OUTER, ClosedForm
from orchestrate.model import Excitation
from orchestrate.response.questions import Point

DAMPED = Structure(d1=0.1, d2=0.12, e=0.5)
BOX = {"frequency": 1.2, "amplitude": 1.0}


@pytest.mark.parametrize("clearance", [0.4, -0.4])
@pytest.mark.parametrize("wall", [False, True])
def test_the_closed_form_solves_its_own_equation(clearance, wall):
    """Steady motions in flight and in contact at both ends have the derivative that the field says;
    the contact force is the gap's acceleration of free masses, towards the end.
    """
    structure = DAMPED.replace(clearance=clearance, m2=1.7, stroke=0.7).replace(wall=wall)
    force2 = 0.0 if wall else 0.5
    box = Excitation(**BOX, force1=0.3, force2=force2, box_acceleration=0.2)
    form = ClosedForm.from_structure(structure, box)
    phase, step = np.linspace(0.1, 6.0, 7), 1e-5
    for mode in (FREE, INNER, OUTER):
        ends = [form.steady_response(phase + sign * step * form.eta, mode) for sign in (1, -1)]
        rate = (ends[0] - ends[1]) / (2.0 * step)
        assert rate == pytest.approx(
            form.field(form.steady_response(phase, mode), phase, mode), abs=1e-8
        )
    for mode, gap, sign in ((INNER, 0.0, 1.0), (OUTER, form.limit, -1.0)):
        together = form.steady_response(phase, mode)
        assert together[:, 1] - together[:, 0] == pytest.approx(gap, abs=1e-15)
        free = form.field(together, phase)
        force = form.force(phase, together[:, 0], together[:, 2], mode == OUTER)
        assert force == pytest.approx(sign * (free[:, 3] - free[:, 2]))


@pytest.mark.parametrize("clearance", [0.0, 0.4, -0.4])
def test_states_go_to_faces_and_back(clearance):
    point = Point(DAMPED.replace(clearance=clearance), Excitation(frequency=1.2, amplitude=0.7))
    x1 = np.array([0.3, -0.2, 0.1])
    gap = np.array([0.0, 0.5, 1e-3])
    states = np.column_stack([x1, x1 + gap - clearance, [0.1, 0.2, 0.3], [0.1, 0.5, 0.6]])
    faces = point.faces(states)
    assert faces[:, 1] - faces[:, 0] == pytest.approx(gap / point.length)
    assert faces[0, 1] == faces[0, 0]
    assert point.from_faces(faces) == pytest.approx(states)


@pytest.mark.slow
def test_branches_over_clearance_and_amplitude():
    """Each orbit is run through by the FMU, and solves the equations to rounding; scaling the box
    and the clearance alike gives the same bifurcations.
    """
    structure = DAMPED.replace(clearance=-0.05)
    found = orchestrate.branch(structure, **BOX, over="clearance", limits=(-0.2, 0.1), longest=0.5)
    assert found.sizes["point"] > 5 and found.fmu_same_impacts.all()
    assert float(found.residual.max()) < 1e-9
    assert float(found.fmu_return.max()) < 1e-6
    limits = tuple(-0.05 / np.array([-0.2, -0.01]))
    level = orchestrate.branch(structure, **BOX, over="amplitude", limits=limits, longest=0.5)
    ratios = sorted(-0.05 / level.bifurcation_value.values)
    values = [v for v in found.bifurcation_value.values if -0.2 < v < -0.01]
    assert len(values) > 0
    assert min(abs(np.subtract.outer(values, ratios)).min(axis=1)) < 1e-8


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
