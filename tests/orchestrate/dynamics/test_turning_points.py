"""Amplitudes of orbits against the FMU's; the contact force's derivatives by differences."""

import numpy as np
import pytest

from orchestrate.dynamics.closed_form import ClosedForm
from orchestrate.dynamics.orbits import orbit
from orchestrate.dynamics.periodic_orbit import ImpactSequence, PeriodicOrbit
from orchestrate.dynamics.turning_points import pressing_force
from orchestrate.model import Excitation, Structure
from orchestrate.response.sweep import sweep

NODES = ("node_phase", "node_position", "node_velocity", "node_closing")


@pytest.mark.parametrize(("eta", "period"), [(1.5, 1), (4.0, 2), (0.4, 1), (1.0, 1)])
def test_amplitudes_are_those_of_the_settled_response(eta, period):
    structure = Structure.nondimensional()
    found = orbit(structure, eta=eta, period=period)
    seen = sweep(structure, eta=[eta], transient=4000, samples=8)
    assert found.xi_rel_max.item() == pytest.approx(seen.xi_rel_max.item(), rel=1e-9)
    for name in ("xi1_max", "xi2_max"):
        assert found[name].item() == pytest.approx(seen[name].item(), rel=1e-5)


def test_derivatives_of_the_contact_force():
    structure = Structure.nondimensional(D1=0.02, D2=0.005, mu=0.8)
    found = orbit(structure, eta=0.4)
    form = ClosedForm.from_structure(structure, Excitation.nondimensional(0.4, structure))
    nodes = np.stack([found[name].values for name in NODES], axis=1)
    solution = PeriodicOrbit(ImpactSequence(1, tuple(found.node_kind.values.tolist())), form, nodes)
    segment = np.flatnonzero(solution.contact)
    middle = 0.5 * (solution.begins + solution.ends)[segment]
    step = 1e-5 * form.eta
    before, here, after = (
        pressing_force(solution, segment, middle + s) for s in (-step, 0.0, step)
    )
    for order in (0, 1):
        slope = (after[order] - before[order]) / 2e-5
        assert here[order + 1] == pytest.approx(slope, rel=1e-7)
    assert here[0] > 0.0
