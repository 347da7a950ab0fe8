"""Impact statistics against the impacts of the motion itself."""

import numpy as np
import pytest

from orchestrate.dynamics.impact_statistics import impact_statistics
from orchestrate.model import Structure
from orchestrate.response.simulate import simulate

PAPER = Structure.nondimensional()
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=2.9, e=0.6)

pytestmark = pytest.mark.usefixtures("exported")


@pytest.mark.parametrize(("structure", "eta"), [(PAPER, 0.4), (PAPER, 0.6), (OWN, 1.5)])
def test_they_are_those_of_the_motion(structure, eta):
    found = impact_statistics(structure, eta=eta, transient=800, periods=10).isel(eta=0)
    motion = simulate(structure, eta=eta, transient=800, periods=10, points=20)
    period = 2.0 * np.pi / (eta * structure.omega)
    times = motion.impact_time.values / period
    each = np.bincount((times - 800).astype(int), minlength=10)
    assert float(found.impacts) == motion.sizes["impact"] / 10
    assert (float(found.fewest), float(found.most)) == (each.min(), each.max())
    assert float(found.contacts) == int(motion.sticks.sum()) / 10
    speeds = motion.impact_velocity.values / structure.omega
    assert float(found.closing_max) == pytest.approx(speeds.max(), rel=1e-6)
    assert float(found.closing_min) == pytest.approx(speeds.min(), rel=1e-3)
    assert float(found.closing_sum) == pytest.approx(speeds.sum() / 10, rel=1e-6)
    apart = np.diff(times)
    assert float(found.distance_max) == pytest.approx(apart.max(), rel=1e-6)
    assert float(found.distance_min) == pytest.approx(apart.min(), rel=1e-3)


@pytest.mark.parametrize(
    ("structure", "eta", "periods"),
    [
        (PAPER, 0.25, 3),  # contact at the beginning, from rest
        (Structure.nondimensional(e=0.0), 1.3, 10),  # contact at the end too
        (OWN, 1.5, 10),
        (Structure.nondimensional(mu=0.8, kappa=1.5, D=0.02, e=0.5, clearance=-1.0), 1.1, 10),
    ],
)
def test_the_share_of_permanent_contact_is_that_of_the_motion(structure, eta, periods):
    found = impact_statistics(structure, eta=eta, transient=0, periods=periods).isel(eta=0)
    motion = simulate(structure, eta=eta, periods=periods, points=40_000)
    expected = float(motion.in_contact.mean())
    assert 0.01 < expected < 0.99
    assert float(found.contact_share) == pytest.approx(expected, abs=2e-4)
