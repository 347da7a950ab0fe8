"""Answers about structures whose restitution decreases with the closing speed: orbits and their
multipliers against the FMU's own map, branches and borders, exponents, maps.
"""

import numpy as np
import pytest

import orchestrate
from orchestrate import Structure
from orchestrate.model import Excitation

from .stroboscopic import assert_multipliers

BOX = {"frequency": 1.2, "amplitude": 1.0}
SLOWER = Structure(d1=0.02, d2=0.05, m2=1.3, e=0.9, e_slope=0.3)
IN_SI = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=2.0, e=0.8, e_slope=1.5)
CASES = [
    (SLOWER, {"frequency": 2.9, "amplitude": 0.7}),
    (IN_SI, {"frequency": 130.0, "amplitude": 2e-3}),
    (Structure(e=0.5, e_slope=0.4), {"frequency": 0.4, "amplitude": 6.25}),  # with a contact
]


@pytest.mark.parametrize(("structure", "box"), CASES)
def test_the_fmu_runs_through_orbits_and_its_map_has_their_multipliers(structure, box):
    """By central differences around the orbit; their product by Liouville's formula."""
    found = orchestrate.orbit(structure, **box)
    assert bool(found.fmu_same_impacts) and float(found.fmu_return) < 1e-11
    assert_multipliers(found, structure, Excitation(**box))
    speed = found.impact_velocity.values
    parted = [structure.restitution(v) * v for v in (speed, speed * (1 + 1e-6), speed * (1 - 1e-6))]
    rate = (parted[1] - parted[2]) / (2e-6 * speed)
    losses = structure.d1 / structure.m1 + structure.d2 / structure.m2
    span = 2.0 * np.pi / box["frequency"]
    expected = np.prod(parted[0] / speed * rate) * np.exp(-losses * span)
    if not found.permanent_contact:
        assert np.prod(found.multipliers.values @ [1, 1j]) == pytest.approx(expected)
        assert float(found.multiplier_product) == pytest.approx(expected)


@pytest.mark.slow
def test_a_branch_over_the_slope_ends_where_its_limits_are_and_is_run_through():
    """From e at all speeds on, point by point as the orbits that are computed alone."""
    structure = SLOWER.replace(e_slope=0.0)
    found = orchestrate.branch(structure, **BOX, over="e_slope", limits=(0.0, 0.1), longest=0.2)
    along = found.e_slope.values
    assert along.min() == 0.0 and along.max() == 0.1
    for point in (len(along) // 2, -1):
        alone = orchestrate.orbit(structure.replace(e_slope=float(along[point])), **BOX)
        found_here = found.isel(point=point)
        assert float(found_here.xi_rel_max) == pytest.approx(float(alone.xi_rel_max), rel=1e-9)


def test_impulses_are_the_changes_of_momentum():
    """Of mass 2 alone, at each impact: by its velocities on both sides, in simulate and in map."""
    motion = orchestrate.simulate(SLOWER, **BOX, transient=50, periods=1, points=4000)
    reduced = SLOWER.m1 * SLOWER.m2 / (SLOWER.m1 + SLOWER.m2)
    speed = motion.impact_velocity.values
    expected = reduced * (1.0 + SLOWER.restitution(speed)) * speed
    assert motion.impulse.values == pytest.approx(expected, rel=1e-13)
    assert motion.sizes["impact"] >= 1
    found = orchestrate.map(
        IN_SI, frequency=[130.0, 131.0], e_slope=[1.0, 1.5], amplitude=2e-3, transient=100
    )
    alone = orchestrate.simulate(IN_SI, frequency=130.0, amplitude=2e-3, transient=400, periods=2)
    unit = IN_SI.m1 * IN_SI.omega * 2e-3 * (130.0 / IN_SI.omega) ** 2
    largest = float(found.impulse_max.sel(frequency=130.0, e_slope=1.5))
    assert largest == pytest.approx(float(alone.impulse.max()) / unit, rel=1e-6)
