"""Branches of the coupled system: against the averaged theory, ramps, and what motions do."""

import numpy as np
import pytest

from orchestrate import InputError, drive_branch
from orchestrate.access import OSCILLATOR, SHAKER, Instance, find
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.drive_branch import bifurcations
from orchestrate.weak_drive.shooting import Orbit, Shooter

from .coupled import QUICK
from .monolithic import Monolith


@pytest.fixture(scope="module")
def branch():
    return drive_branch(*QUICK, speed=(1.255, 1.39), count=34, progress=False)


def points(branch, structure, kind):
    """Voltages of the bifurcations of a kind, by speed."""
    chosen = (branch.point_structure == structure) & (branch.point_kind == kind)
    return branch.point_voltage.values[chosen.values]


def test_folds(branch):
    """Bonded by the averaged theory to 1e-4; delaminated where slow ramps jump."""
    expected = [fold.eta0 for fold in averaged.folds(*QUICK.as_bonded())]
    assert points(branch, "bonded", "fold") == pytest.approx(expected, abs=1e-4)
    assert points(branch, "delaminated", "fold")[0] == pytest.approx(1.5697, abs=5e-4)


def test_voltage_of_the_bonded_branch(branch):
    """The fluctuation of the speed changes little."""
    theory = averaged.no_load_speed(*QUICK.as_bonded(), branch.speed.values)
    assert branch.voltage.sel(structure="bonded").values == pytest.approx(theory, abs=2e-4)


def test_between_the_folds_it_is_unstable(branch):
    """Speeds between both folds, and only they."""
    bonded = branch.sel(structure="bonded")
    up, down = (fold.Omega for fold in averaged.folds(*QUICK.as_bonded()))
    speed = branch.speed.values
    clear = np.minimum(abs(speed - up), abs(speed - down)) > 2e-3
    between = (speed > up) & (speed < down)
    assert (bonded.stable.values == ~between)[clear].all()


def test_an_orbit_and_its_multipliers_are_the_whole_systems():
    """The motion repeats in the monolithic solution, and a change grows as the multipliers say."""
    speed = 1.29
    with Instance(find(OSCILLATOR).path) as one, Instance(find(SHAKER).path) as other:
        shooter = Shooter((one, other), *QUICK, revolutions=2, steps=48)
        volts = float(averaged.no_load_speed(*QUICK, speed))
        state = shooter.settle(volts, speed, 600.0)
        orbit = shooter.orbit(Orbit(volts, state, np.empty((0, 0))), speed)
        multipliers = shooter.multipliers(orbit)
    assert shooter.names == ("x1", "v1", "x2", "v2", "box_position", "box_velocity", "speed")
    x1, v1, x2, v2, y, v, w = orbit.state * shooter.units
    start = np.array([x1, v1, x2, v2, y, v, shooter.angle, w, 0.0])
    period = 4.0 * np.pi / speed
    whole = Monolith(*QUICK, orbit.voltage)
    end = whole.solve(start, np.linspace(0.0, period, 200))[0][-1]
    turned = start + np.array([0, 0, 0, 0, 0, 0, 4.0 * np.pi, 0, 0])
    assert end == pytest.approx(turned, abs=2e-5)
    columns = []
    for i in range(8):
        moved = start.copy()
        moved[i] += -1e-5 if i == 0 else 1e-5
        after = whole.solve(moved, np.linspace(0.0, period, 200))[0][-1]
        columns.append((after - end)[:8] / (moved - start)[i])
    truth = np.linalg.eigvals(np.stack(columns, axis=1))
    truth = np.delete(truth, np.argmin(abs(truth - 1.0)))  # along the motion
    assert np.sort(abs(multipliers)) == pytest.approx(np.sort(abs(truth)), abs=2e-3)


def test_bifurcations_of_known_branches():
    """A parabola's top, a pair that leaves the unit circle, and a multiplier that passes -1."""
    speeds = np.linspace(1.0, 2.0, 21)
    pair = (0.8 + 0.2 * speeds)[:, np.newaxis] * np.exp([0.5j, -0.5j])
    other = -(speeds - 0.33)[:, np.newaxis] + 0j
    found = bifurcations(speeds, 2.0 - (speeds - 1.41) ** 2, np.hstack([pair * 0.93, other]))
    places = {kind: speed for kind, speed, _ in found}
    assert places["fold"] == pytest.approx(1.41)
    assert places["period doubling"] == pytest.approx(1.33)
    assert places["Neimark-Sacker"] == pytest.approx((1.0 / 0.93 - 0.8) / 0.2)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"speed": (1.4, 1.2)}, "speed = \\(1.4, 1.2\\) rad/s: expected"),
        ({"count": 2}, "count = 2: expected a whole number >= 4"),
        ({"period": 0}, "period = 0"),
        ({"settle": -1.0}, "settle = -1.0"),
    ],
)
def test_mistakes(arguments, text):
    with pytest.raises(InputError, match=text):
        drive_branch(*QUICK, progress=False, **arguments)
