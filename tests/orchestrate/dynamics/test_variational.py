"""Flow and saltation matrices against neighbouring runs of the FMU and matrix exponentials."""

import itertools

import numpy as np
import pytest

from orchestrate.dynamics.closed_form import INNER, ClosedForm
from orchestrate.dynamics.impacts_after_transient import simulate_nondimensional_impacts
from orchestrate.dynamics.variational import (
    contact_durations,
    deviation_matrices_and_contacts,
    period_in_tau,
)
from orchestrate.fmu import REST
from orchestrate.model import Excitation, Structure
from orchestrate.response.questions import Point
from orchestrate.response.threshold import threshold_amplitudes

from .stroboscopic import after, differences, moving

make = Structure.nondimensional
ALIKE = (make(), make(e=0.3), make(D=0.05), make(mu=1.5, kappa=2.1))
UNLIKE = (
    make(D1=0.01, D2=0.2),
    make(D1=0.3, D2=0.02, mu=0.6, e=0.4),
    make(D1=0.05, D2=2.0, kappa=1.5),  # mass 2 overdamped
    make(D1=1.0, D2=0.1),  # mass 1 critically damped
    make(D1=3.0, D2=2.5, mu=2.0, e=0.9),  # all three overdamped
    make(D1=0.02, D2=0.03, mu=1.4, e=0.95, e_slope=0.6),
    Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=12.0, e=0.6),
)


def pushed_point(structure, eta, size):
    """The box's motion, with forces and gravity of some size beside its own."""
    level = size * structure.omega**2
    pushes = {"force1": level * structure.m1, "box_acceleration": 0.2 * level}
    if not structure.wall:
        pushes["force2"] = -0.5 * level * structure.m2
    return Point(structure, Excitation.nondimensional(eta, structure, **pushes))


def monodromy(impacts, point, periods=1):
    form = ClosedForm.from_structure(*point)
    end = periods * period_in_tau(form.eta)
    first = impacts.time[0] if len(impacts.time) else end
    matrix = form.flow_matrices(np.array([first]))[0]
    for each in deviation_matrices_and_contacts(impacts, end, point)[0]:
        matrix = each @ matrix
    return matrix


PLAYS = (
    make(D1=0.02, D2=0.05, e=0.8).replace(stroke=1.0, clearance=0.4),
    make(mu=1.5, kappa=2.1, e=0.5).replace(stroke=0.4),
    Structure.one_mass(m=2.0, k=8.0, d=0.3, e=0.7, stroke=1.0, clearance=0.3),
    make(D=0.03, e=0.6, e_slope=0.3).replace(stroke=0.5, clearance=0.2),
)
WALLS = (
    Structure.one_mass(m=3.0, k=2.0, d=0.1, e=0.7, clearance=0.1),
    Structure.one_mass(m=1.0, k=1.0, d=0.4, e=0.4, clearance=-0.2),
)
CASES = list(itertools.product((*ALIKE, *UNLIKE), (0.3, 1.047), (0.0,)))
CASES += itertools.product((*PLAYS, *WALLS), (0.6, 1.047), (0.0, 0.7))


@pytest.mark.parametrize(
    ("structure", "eta", "pushed"), [*CASES, *((each, 1.047, 0.7) for each in UNLIKE)]
)
def test_monodromy_equals_differences_of_the_fmu(instances, structure, eta, pushed):
    plain, eventful = instances
    point = pushed_point(structure, eta, pushed)
    start = after(plain, point, REST, 200)
    gap = start[1] - start[0] + structure.gap_offset
    if min(gap, (structure.stroke or np.inf) - gap) < 1e-3 * np.abs(start).max():
        # in contact there is no neighbour beyond
        start = point.state_units * [-0.05, 0.05, 1.0, -1.0]
    impacts = simulate_nondimensional_impacts(eventful, point, start, 2)
    assert len(impacts.time)
    expected = differences(plain, point, start, 2)
    found = monodromy(impacts, point, 2)
    np.testing.assert_allclose(found[moving(point), moving(point)], expected, atol=2e-5)
    outside = np.diff(impacts.state[:, :2])[:, 0] > 0.5 * structure.stroke / point.displacement_unit
    assert not structure.stroke or 0 < outside.sum() < len(outside)


@pytest.mark.parametrize("above", [1e-5, 5e-4])
def test_short_openings_are_seen_wherever_a_contact_begins(above):
    """On the common steady motion, which opens for less than a sample, by 400,000 of its phases."""
    pressed = make(kappa=1.5, D=0.01).replace(clearance=-1.0)
    (level,) = threshold_amplitudes(pressed, np.array([0.7]))
    excitation = Excitation(frequency=0.7, amplitude=level * (1.0 + above))
    form = ClosedForm.from_structure(pressed, excitation)
    phases = np.linspace(0.0, 2.0 * np.pi, 400_001)
    x, _, v, _ = form.steady_response(phases, INNER).T
    opened = phases[form.contact_force(phases, x, v) >= 0.0]
    assert 0.0 < np.ptp(opened) < 2.0 * np.pi / 64.0
    begins = np.linspace(0.0, 2.0 * np.pi, 2000)
    begins = begins[(begins < opened[0]) | (begins > opened[-1])]
    spans = np.full(len(begins), period_in_tau(form.eta))
    found = contact_durations(form, begins, form.steady_response(begins, INNER), spans)
    expected = (opened[0] - begins) % (2.0 * np.pi) / form.eta
    np.testing.assert_allclose(found, expected, atol=5e-5)
