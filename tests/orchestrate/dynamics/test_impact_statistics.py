"""Impact statistics against the impacts of the motion itself."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.dynamics.impact_statistics import impact_statistics
from orchestrate.response.simulate import simulate
from orchestrate.structures import Structure

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
    stuck = apart[motion.sticks.values[:-1].astype(bool)].sum() / 10
    assert float(found.contact_share) == pytest.approx(stuck, rel=1e-6, abs=1e-12)


def test_without_impacts_there_is_no_velocity():
    found = impact_statistics(PAPER.as_bonded(), eta=1.3, transient=5, periods=10).isel(eta=0)
    assert [float(found[name]) for name in ("impacts", "most", "closing_sum")] == [0.0, 0.0, 0.0]
    assert np.isnan(found.closing_max)
    assert np.isnan(found.distance_min)
    assert float(found.exponent) == pytest.approx(-0.005, rel=1e-12)


def test_few_impacts_have_no_exponent():
    found = impact_statistics(PAPER, eta=4.0, transient=2000, periods=8)
    assert np.isnan(found.exponent).all()
    assert found.impacts.values.tolist() == [0.5]
