"""Impact statistics against the impacts of the motion itself."""

import numpy as np
import pytest

from orchestrate.dynamics.impact_statistics import impact_statistics
from orchestrate.fmu import OSCILLATOR, Instance, begin, find
from orchestrate.model import Excitation, Structure
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


def contact_of(structure, eta, periods, start=None):
    """Share of permanent contact by the FMU: its beginnings, and its ends by bisection."""
    excitation = Excitation.nondimensional(eta, structure)
    points, path = 50, find(OSCILLATOR).path
    motion = simulate(structure, eta=eta, periods=periods, points=points, start=start)
    stuck = motion.impact_time.values[motion.sticks.values == 1]
    begins = np.append(0.0, stuck) if motion.in_contact[0] else stuck
    with Instance(path) as instance:

        def touching(time):
            begin(instance, structure, excitation, start or (0.0,) * 4)
            instance.step(0.0, time)
            return instance.get("in_contact")[0]

        total, end = 0.0, float(motion.time[-1])
        for low in begins:
            high = low + excitation.period / points
            while high < end and touching(high):
                low, high = high, high + excitation.period / points
            high = min(high, end)
            if touching(high):
                low = high
            while high - low > 1e-10 * end:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if touching(middle) else (low, middle)
            total += high - begins[begins <= low][-1]
    return total / end


@pytest.mark.parametrize(
    ("structure", "eta", "periods"),
    [
        (PAPER, 0.25, 3),  # contact at the beginning, from rest
        (Structure.nondimensional(e=0.0), 1.3, 10),  # contact at the end too
        (OWN, 1.5, 10),
        (Structure.nondimensional(mu=0.8, kappa=1.5, D=0.02, e=0.5, clearance=-1.0), 1.1, 10),
    ],
)
def test_the_share_of_permanent_contact_is_the_fmu_s(structure, eta, periods):
    found = impact_statistics(structure, eta=eta, transient=0, periods=periods).isel(eta=0)
    expected = contact_of(structure, eta, periods)
    assert 0.01 < expected < 0.99
    assert float(found.contact_share) == pytest.approx(expected, abs=1e-8)
