"""Motions in time against SciPy's integrator, momentum, and Newton's law of each mass."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.model import Structure
from orchestrate.response.simulate import simulate

PAPER = Structure.nondimensional()
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=2.9, e=0.6)
STRONG = Structure.nondimensional(D1=0.3, D2=1.2, mu=0.4, kappa=2.0, e=0.5)

pytestmark = pytest.mark.usefixtures("exported")


@pytest.mark.parametrize("structure", [PAPER, OWN, STRONG, OWN.as_bonded()])
@pytest.mark.parametrize("eta", [0.4, 0.9])
def test_newtons_law_of_each_mass_with_the_contact_force(structure, eta):
    m = simulate(structure, eta=eta, transient=30, periods=2, points=1000)
    np.testing.assert_allclose(m.a1_abs, m.a1 + m.box_acceleration, rtol=1e-12, atol=1e-9)
    np.testing.assert_array_equal(m.x_rel, m.x2 - m.x1)
    force = np.where(m.in_contact, m.contact_force, 0.0)
    left = structure.m1 * m.a1_abs + structure.k1 * m.x1 + structure.d1 * m.v1 + force
    right = structure.m2 * m.a2_abs + structure.k2 * m.x2 + structure.d2 * m.v2 - force
    size = 1e-12 * float(structure.k2 * np.abs(m.x2).max())
    if structure.bonded:  # glued, the masses may pull each other as well
        left, right = left + right, 0.0 * right
    assert np.abs(left).max() < size
    assert np.abs(right).max() < size


@pytest.mark.parametrize(
    ("structure", "eta"), [(PAPER, 0.4), (OWN.replace(e_slope=1.5), 1.7), (STRONG, 1.7)]
)
def test_impulses_are_those_of_the_restitution_and_plastic_where_contact_begins(structure, eta):
    m = simulate(structure, eta=eta, transient=50, periods=1)
    assert m.sizes["impact"] and m.sticks.sum() == (eta == 0.4)
    restitution = [structure.restitution(speed) for speed in m.impact_velocity.values]
    part = np.where(m.sticks, 1.0, 1.0 + np.array(restitution))
    mass = structure.m1 * structure.m2 / (structure.m1 + structure.m2)
    np.testing.assert_allclose(m.impulse, part * mass * m.impact_velocity, rtol=1e-12)
