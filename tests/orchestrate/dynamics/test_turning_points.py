"""Amplitudes of orbits against the FMU's; the contact force's derivatives by differences."""

import pytest

from orchestrate.dynamics.orbits import orbit
from orchestrate.model import Structure
from orchestrate.response.sweep import sweep


@pytest.mark.parametrize(("eta", "period"), [(1.5, 1), (4.0, 2), (0.4, 1), (1.0, 1)])
def test_amplitudes_are_those_of_the_settled_response(eta, period):
    structure = Structure.nondimensional()
    found = orbit(structure, eta=eta, period=period)
    seen = sweep(structure, eta=[eta], transient=4000, samples=8)
    assert found.xi_rel_max.item() == pytest.approx(seen.xi_rel_max.item(), rel=1e-9)
    for name in ("xi1_max", "xi2_max"):
        assert found[name].item() == pytest.approx(seen[name].item(), rel=1e-5)
