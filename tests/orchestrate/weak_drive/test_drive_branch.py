"""Branches of the coupled system: against the averaged theory, ramps, and what motions do."""

import numpy as np
import pytest

from orchestrate import InputError, drive_branch
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, Instance, find
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.drive_tracer import motion_near
from orchestrate.weak_drive.shooting import Shooter

from .coupled import BEAM, QUICK
from .monolithic import Monolith
from .validation import Whole, branch_of


@pytest.fixture(scope="module")
def branch():
    most = np.int64(30)  # as NumPy counts
    asked = {"speed": (1.27, 1.39), "longest": 0.15, "most": most, "progress": False}
    return drive_branch(*QUICK.as_bonded(), **asked)


def points(branch, structure, kind):
    """Voltages of the bifurcations of a kind, in the order along the branch."""
    chosen = (branch.bifurcation_structure == structure) & (branch.bifurcation_kind == kind)
    return branch.bifurcation_voltage.values[chosen.values]


@pytest.mark.slow
def test_folds(branch):
    """By the averaged theory, to 1e-4."""
    expected = [fold.eta0 for fold in averaged.folds(*QUICK.as_bonded())]
    assert points(branch, "bonded", "fold") == pytest.approx(expected, abs=1e-4)


@pytest.mark.slow
def test_voltage_of_the_bonded_branch(branch):
    """The fluctuation of the speed changes little."""
    bonded = branch.sel(structure="bonded", leg="from below").dropna("point")
    theory = averaged.no_load_speed(*QUICK.as_bonded(), bonded.speed.values)
    assert bonded.voltage.values == pytest.approx(theory, abs=2e-4)
    assert branch.end.sel(structure="bonded").values[0] == "limit"


@pytest.mark.slow
def test_between_the_folds_it_is_unstable(branch):
    """Speeds between both folds, and only they."""
    bonded = branch.sel(structure="bonded", leg="from below").dropna("point")
    up, down = (fold.Omega for fold in averaged.folds(*QUICK.as_bonded()))
    speed = bonded.speed.values
    clear = np.minimum(abs(speed - up), abs(speed - down)) > 2e-3
    between = (speed > up) & (speed < down)
    assert (bonded.stable.values == ~between)[clear].all()


@pytest.fixture(scope="module")
def upper():
    """The upper branches of `beam`, near where they are lost."""
    omega = BEAM.structure.omega
    return drive_branch(
        *BEAM.as_bonded(), speed=(1.362 * omega, 1.37 * omega), settle=8.0, progress=False
    )


@pytest.mark.slow
def test_neimark_sacker_point(upper):
    """The upper branch of `beam` is lost before its fold; by the averaged theory's growth rates."""
    (expected,) = averaged.neimark_sacker_points(*BEAM.as_bonded())
    assert expected.Omega > averaged.folds(*BEAM.as_bonded())[-1].Omega
    omega, volts = BEAM.structure.omega, BEAM.drive.volts(BEAM.structure)
    found = upper.isel(bifurcation=upper.bifurcation_structure.values == "bonded")
    assert found.bifurcation_kind.values.tolist() == ["Neimark-Sacker"]
    assert found.bifurcation_voltage[0] / volts == pytest.approx(expected.eta0, abs=1e-4)
    assert found.bifurcation_speed[0] / omega == pytest.approx(expected.Omega, abs=1e-4)
    pair = found.isel(multiplier=slice(2))
    size = np.hypot(pair.bifurcation_multiplier_real, pair.bifurcation_multiplier_imag)
    assert size.values == pytest.approx(1.0, abs=1e-4)


def test_an_orbit_and_its_multipliers_are_the_whole_systems():
    """The motion repeats in the monolithic solution, and a change grows as the multipliers say."""
    speed = 1.29
    with Instance(find(OSCILLATOR).path) as one, Instance(find(MOTOR_SHAKER).path) as other:
        shooter = Shooter((one, other), *QUICK, revolutions=2, steps=48, length=20.0)
        volts = float(averaged.no_load_speed(*QUICK, speed))
        state = shooter.settle(volts, speed, 600.0)
        motion = motion_near(shooter, np.append(state, [volts, speed]), up=True)
        fresh = Shooter((one, other), *QUICK, revolutions=2, steps=48, length=20.0)
        fresh.angle = shooter.angle
        shots = [each.shoot(motion.root.unknowns).end for each in (shooter, fresh)]
    assert np.array_equal(*shots)  # the master of many shots remembers none of them
    assert shooter.names == ("x1", "v1", "x2", "v2", "box_position", "box_velocity", "speed")
    x1, v1, x2, v2, y, v, w = motion.root.unknowns[:-2] * shooter.units
    start = np.array([x1, v1, x2, v2, y, v, shooter.angle, w, 0.0])
    period = 4.0 * np.pi / speed
    whole = Monolith(*QUICK, float(motion.root.unknowns[-2]))
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
    assert np.sort(abs(motion.multipliers)) == pytest.approx(np.sort(abs(truth)), abs=5e-4)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"speed": (1.4, 1.2)}, "speed = \\(1.4, 1.2\\) rad/s: expected"),
        ({"most": 1}, "most = 1: expected a whole number from 2"),
        ({"period": True}, "period = True: expected a whole number"),
        ({"longest": 2.0}, "longest = 2.0"),
        ({"period": 0}, "period = 0"),
        ({"settle": -1.0}, "settle = -1.0"),
    ],
)
def test_mistakes(arguments, text):
    with pytest.raises(InputError, match=text):
        drive_branch(*QUICK, progress=False, **arguments)


@pytest.mark.slow
def test_the_doubling_of_one_revolution_motions():
    """Located with multiplier -1, and the branch of twice the period goes off it."""
    omega, volts = BEAM.structure.omega, BEAM.drive.volts(BEAM.structure)
    asked = {"speed": (1.29 * omega, 1.37 * omega), "longest": 0.1, "most": 60}
    found = drive_branch(*BEAM, **asked, progress=False)
    of_one = (found.bifurcation_structure == "delaminated") & (found.bifurcation_revolutions == 1)
    flip = found.isel(bifurcation=(of_one & (found.bifurcation_kind == "period doubling")).values)
    assert flip.bifurcation_voltage.values / volts == pytest.approx([1.51831], abs=1e-4)
    nearest = abs(flip.bifurcation_multiplier_real + 1.0).min("multiplier")
    assert nearest.values == pytest.approx([0.0], abs=1e-3)
    doubled = found.sel(structure="delaminated", leg="first doubled").dropna("point")
    assert (doubled.revolutions == 2).all() and doubled.sizes["point"] > 10
    assert doubled.voltage.values[0] / volts == pytest.approx(1.51831, abs=2e-4)
    assert found.end.sel(structure="delaminated", leg="first doubled") == "grazing of a flight"
    at = points(found, "delaminated", "grazing of a flight") / volts
    assert at == pytest.approx([1.3664], abs=1e-4)


@pytest.mark.slow
def test_a_branch_ends_where_the_masses_touch():
    """In the monolithic solution too: they turn away from each other with next to no gap."""
    legs, length = branch_of(QUICK, most=60, range_=(0.975, 1.05))
    (leg,) = (one for one in legs if one.end == "grazing of a flight")
    motion, omega = leg.bifurcations[-1].point, QUICK.structure.omega
    turns = motion.period.revolutions
    whole = Whole(QUICK, turns, motion.angle, length)
    unknowns = motion.root.unknowns
    start = whole.full(unknowns[:-1]) * whole.units
    times = np.linspace(0.0, turns * 2.0 * np.pi / (unknowns[-1] * omega), 8001)
    rows, impacts = Monolith(*QUICK, float(unknowns[-2])).solve(start, times)
    gap, slow = rows[:, 2] - rows[:, 0], np.abs(rows[:, 3] - rows[:, 1]) < 0.02 * length
    assert impacts == motion.period.impacts == 2
    assert gap[slow].min() < 1e-4 * length
