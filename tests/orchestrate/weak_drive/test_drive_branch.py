"""Branches of the coupled system: against the averaged theory, and what motions do."""

import numpy as np
import pytest

from orchestrate import couple, drive_branch
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.drive_branch import DriveBranchJob
from orchestrate.weak_drive.drive_tracer import find_motion_near
from orchestrate.weak_drive.shooting import Shooter

from .coupled import BEAM, QUICK, instances
from .monolithic import Monolith

APART = QUICK.with_structure(clearance=100.0)  # never touch
OPEN = QUICK.with_structure(clearance=3.0)
PRESSED = QUICK.with_structure(clearance=-3.0)  # part from an amplitude of about 16 on
EXACT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}


def branch_of(system, most, range_):
    """Legs of a branch over a range of the resonance, and the unit of length."""
    omega = system.structure.omega
    resonance = averaged.bonded_resonance(*system.as_bonded())
    speeds = tuple(share * resonance * omega for share in range_)
    asked = {"longest": 0.1, "most": most, "period": 2, "steps": 48, "settle": 600.0 / omega}
    job = DriveBranchJob("branch", *system, speeds, **asked)
    with instances() as fmus:
        shooter = job.make_shooter(fmus, system.structure)
        return job.trace_legs(shooter), shooter.length


def motion_of(system, speed, revolutions=1):
    """The motion of a speed, and its state of the whole system as :mod:`.monolithic` has it."""
    settings = {"revolutions": revolutions, "steps": 48, "length": 20.0}
    with instances() as fmus:
        shooter = Shooter(fmus, *system, **settings)
        volts = float(averaged.stationary_voltage(*system, speed))
        state = shooter.simulate_at_speed(volts, speed, 600.0)
        motion = find_motion_near(shooter, np.append(state, [volts, speed]), up=True)
        fresh = Shooter(fmus, *system, **settings)
        fresh.angle = shooter.angle
        shots = [each.shoot(motion.root.unknowns).end for each in (shooter, fresh)]
    assert np.array_equal(*shots)  # the master of many shots remembers none of them
    return motion


def whole_state(system, motion, length):
    """The state at the begin of a motion's period as :mod:`.monolithic` has it."""
    unit = length * system.structure.omega
    x1, v1, *box = motion.root.unknowns[:-2]
    x2, v2 = (x1, v1) if motion.in_contact else box[:2]
    y, v, w = motion.root.unknowns[-5:-2]
    rest_1, rest_2 = system.structure.at_rest
    masses = [x1 * length + rest_1, v1 * unit, x2 * length + rest_2, v2 * unit]
    speed = w * system.structure.omega
    return np.array([*masses, y * length, v * unit, motion.angle, speed, 0.0])


def assert_repeats(system, motion, length, points=200):
    """The motion is one of the whole system, with as many impacts; return its states."""
    start, turns = whole_state(system, motion, length), motion.period.revolutions
    voltage, speed = motion.coordinates
    times = np.linspace(0.0, turns * 2.0 * np.pi / speed, points)
    rows, impacts = Monolith(*system, voltage, EXACT).solve(start, times)
    turned = start + np.array([0, 0, 0, 0, 0, 0, turns * 2.0 * np.pi, 0, 0])
    assert rows[-1] == pytest.approx(turned, abs=2e-5) and impacts == motion.period.impacts
    return rows


def assert_held(system, motion):
    """A motor whose voltage is held settles at that speed and amplitude."""
    voltage, speed = motion.coordinates
    asked = {"speed_start": 0.0, "duration": 900.0, "jobs": 1, "progress": False}
    run = couple(*system, voltage=float(voltage), **asked).isel(revolution=slice(-10, None))
    assert np.abs(motion.multipliers).max() < 1.0
    assert run.speed.mean() == pytest.approx(speed, abs=1e-4)
    assert run.amplitude.max() == pytest.approx(motion.period.amplitude, rel=1e-3)


def test_a_pressed_structure_moves_as_the_bonded_one_until_it_parts():
    """On one branch: without impacts by the averaged theory, then with a flight a revolution."""
    (leg, *_), length = branch_of(PRESSED, 40, (0.98, 1.0))
    motions = leg.points
    impacts = np.array([motion.period.impacts for motion in motions])
    shut = impacts == 0
    assert leg.end == "limit" and 2 <= shut.sum() <= len(shut) - 2
    assert (np.diff(shut.astype(int)) <= 0).all()
    sizes = np.array([motion.period.amplitude for motion in motions])
    kappa, mu = PRESSED.structure.kappa, PRESSED.structure.mu  # f of (18) is 0 at this amplitude
    opening = 3.0 * kappa / mu * (1.0 + mu) / (1.0 + kappa) / (kappa / mu - 1.0)
    assert sizes[shut].max() < opening < sizes[~shut].min()
    places = np.array([motion.coordinates for motion in motions])
    theory = averaged.stationary_voltage(*PRESSED.as_bonded(), places[:, 1])
    assert places[shut, 0] == pytest.approx(theory[shut], abs=2e-4)
    assert theory[-1] - places[-1, 0] > 8e-4
    for motion in (motions[0], motions[-1]):
        assert motion.in_contact
        assert_repeats(PRESSED, motion, length)
    assert_held(PRESSED, next(motion for motion in motions if motion.period.impacts > 20))


def test_with_a_gap():
    """Impacts of two halves that are apart at rest."""
    (leg, *_), length = branch_of(OPEN, 40, (0.975, 0.98))
    last = leg.points[-1]
    assert leg.end == "limit" and last.period.impacts == last.period.revolutions == 1
    assert not last.in_contact
    assert_repeats(OPEN, last, length)
    assert_held(OPEN, last)


def test_halves_that_never_touch_are_two_oscillators():
    """By the averaged torque of two masses in one box, each on its own spring."""
    structure, drive = APART
    speeds = np.array([1.033, 1.26])  # the first: both halves against each other
    motions = [motion_of(APART, speed) for speed in speeds.tolist()]
    s = 1j * speeds
    box = s**2 + 2.0 * drive.D_b(structure) * s + drive.Omega_b(structure) ** 2
    for m, k, d in ((1.0, 1.0, structure.D1), (structure.mu, structure.kappa, structure.D2)):
        pull = drive.beta(structure) * (k + 2.0 * d * m * s)
        inertia = drive.beta(structure) * m * s**2
        box = box + pull * inertia / (pull + inertia)
    expected = speeds - 0.5 * drive.epsilon * speeds**4 * (1.0 / box).imag / drive.b(structure)
    assert [motion.coordinates[0] for motion in motions] == pytest.approx(expected, abs=2e-4)
    assert not any(motion.period.impacts for motion in motions)


def test_multipliers_are_the_whole_systems():
    """A change grows over the period as the multipliers say."""
    motion = motion_of(QUICK, 1.29, 2)
    start = whole_state(QUICK, motion, 20.0)
    end = assert_repeats(QUICK, motion, 20.0)[-1]
    whole, columns = Monolith(*QUICK, float(motion.coordinates[0])), []
    for i in range(8):
        moved = start.copy()
        moved[i] += -1e-5 if i == 0 else 1e-5
        times = np.linspace(0.0, 4.0 * np.pi / 1.29, 2)
        after = whole.solve(moved, times)[0][-1]
        columns.append((after - end)[:8] / (moved - start)[i])
    truth = np.linalg.eigvals(np.stack(columns, axis=1))
    truth = np.delete(truth, np.argmin(abs(truth - 1.0)))  # along the motion
    assert np.sort(abs(motion.multipliers)) == pytest.approx(np.sort(abs(truth)), abs=5e-4)


def points(branch, structure, kind):
    """Voltages of the bifurcations of a kind, in the order along the branch."""
    chosen = (branch.bifurcation_structure == structure) & (branch.bifurcation_kind == kind)
    return branch.bifurcation_voltage.values[chosen.values]


def test_folds_and_what_lies_between():
    """By the averaged theory, to 1e-4; unstable between both folds, and only there."""
    bonded = QUICK.as_bonded()
    asked = {"speed": (1.29, 1.385), "longest": 0.15, "most": np.int64(30), "progress": False}
    branch = drive_branch(*bonded, settle=200.0, steps=24, **asked)
    up, down = averaged.folds(*bonded)
    assert points(branch, "bonded", "fold") == pytest.approx([up.eta0, down.eta0], abs=1e-4)
    leg = branch.sel(structure="bonded", leg="from below").dropna("point")
    speed = leg.speed.values
    theory = averaged.stationary_voltage(*bonded, speed)
    assert leg.voltage.values == pytest.approx(theory, abs=2e-4)
    assert branch.end.sel(structure="bonded").values[0] == "limit"
    clear = np.minimum(abs(speed - up.Omega), abs(speed - down.Omega)) > 2e-3
    between = (speed > up.Omega) & (speed < down.Omega)
    assert (leg.stable.values == ~between)[clear].all() and between.any()


@pytest.mark.slow
def test_neimark_sacker_point():
    """The upper branch of `beam` is lost before its fold; by the averaged theory's growth rates."""
    omega, volts = BEAM.structure.omega, BEAM.drive.volts(BEAM.structure)
    asked = {"speed": (1.362 * omega, 1.37 * omega), "settle": 8.0, "progress": False}
    upper = drive_branch(*BEAM.as_bonded(), **asked)
    (expected,) = averaged.neimark_sacker_points(*BEAM.as_bonded())
    assert expected.Omega > averaged.folds(*BEAM.as_bonded())[-1].Omega
    found = upper.isel(bifurcation=upper.bifurcation_structure.values == "bonded")
    assert found.bifurcation_kind.values.tolist() == ["Neimark-Sacker"]
    assert found.bifurcation_voltage[0] / volts == pytest.approx(expected.eta0, abs=1e-4)
    assert found.bifurcation_speed[0] / omega == pytest.approx(expected.Omega, abs=1e-4)
    pair = found.isel(multiplier=slice(2))
    size = np.hypot(pair.bifurcation_multiplier_real, pair.bifurcation_multiplier_imag)
    assert size.values == pytest.approx(1.0, abs=1e-4)


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


def test_a_branch_ends_where_the_masses_touch():
    """In the monolithic solution too: they turn away from each other with next to no gap."""
    legs, length = branch_of(QUICK, 30, (0.98, 1.06))
    (leg,) = (one for one in legs if one.end == "grazing of a flight")
    rows = assert_repeats(QUICK, leg.bifurcations[-1].point, length, 8001)
    gap, slow = rows[:, 2] - rows[:, 0], np.abs(rows[:, 3] - rows[:, 1]) < 0.02 * length
    assert leg.bifurcations[-1].point.period.impacts == 2 and gap[slow].min() < 1e-4 * length
