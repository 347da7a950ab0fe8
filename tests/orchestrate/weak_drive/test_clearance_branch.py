"""Branches of the drive with a gap or a preload: what they follow, and against what holds."""

import numpy as np
import pytest

from orchestrate import couple
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, Instance, find
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.drive_tracer import motion_near
from orchestrate.weak_drive.shooting import Shooter

from .coupled import QUICK
from .monolithic import Monolith
from .validation import branch_of

APART = QUICK.with_structure(clearance=100.0)  # never touch
OPEN = QUICK.with_structure(clearance=3.0)
PRESSED = QUICK.with_structure(clearance=-3.0)  # part from an amplitude of about 16 on


def leg_of(system, range_, most=40):
    """The first leg's motions, its end, and the unit of length."""
    legs, length = branch_of(system, most, range_)
    return legs[0].points, legs[0].end, length


def motion_of(system, speed):
    """The motion of a speed."""
    with Instance(find(OSCILLATOR).path) as one, Instance(find(MOTOR_SHAKER).path) as other:
        shooter = Shooter((one, other), *system, revolutions=1, steps=48, length=20.0)
        volts = float(averaged.no_load_speed(*system, speed))
        state = shooter.settle(volts, speed, 600.0)
        return motion_near(shooter, np.append(state, [volts, speed]), up=True)


def whole_state(system, motion, length):
    """The state at the begin of a motion's period as :mod:`.monolithic` has it."""
    unit = length * system.structure.omega
    state = motion.root.unknowns[:-2]
    x1, v1, *box = state
    x2, v2 = (x1, v1) if motion.together else box[:2]
    y, v, w = state[-3:]
    rest_1, rest_2 = system.structure.at_rest
    masses = [x1 * length + rest_1, v1 * unit, x2 * length + rest_2, v2 * unit]
    speed = w * system.structure.omega
    return np.array([*masses, y * length, v * unit, motion.angle, speed, 0.0])


def assert_repeats(system, motion, length):
    """The motion is one of the whole system, with as many impacts."""
    start, turns = whole_state(system, motion, length), motion.period.revolutions
    voltage, speed = motion.coordinates
    times = np.linspace(0.0, turns * 2.0 * np.pi / speed, 200)
    exact = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    rows, impacts = Monolith(*system, voltage, exact).solve(start, times)
    turned = start + np.array([0, 0, 0, 0, 0, 0, turns * 2.0 * np.pi, 0, 0])
    assert rows[-1] == pytest.approx(turned, abs=2e-5)
    assert impacts == motion.period.impacts


def assert_held(system, motion):
    """A motor whose voltage is held settles at that speed and amplitude."""
    voltage, speed = motion.coordinates
    asked = {"speed_start": 0.0, "duration": 900.0, "jobs": 1, "progress": False}
    run = couple(*system, voltage=float(voltage), **asked).isel(revolution=slice(-10, None))
    assert run.speed.mean() == pytest.approx(speed, abs=1e-4)
    assert run.amplitude.max() == pytest.approx(motion.period.amplitude, rel=1e-3)


def is_stable(motion):
    return np.abs(motion.multipliers).max() < 1.0


@pytest.fixture(scope="module")
def pressed():
    return leg_of(PRESSED, (0.98, 1.0))


def test_a_pressed_structure_moves_as_the_bonded_one_until_it_parts(pressed):
    """On one branch: without impacts by the averaged theory, then with a flight a revolution."""
    motions, end, _ = pressed
    assert end == "limit"
    impacts = np.array([motion.period.impacts for motion in motions])
    shut = impacts == 0
    assert 2 <= shut.sum() <= len(shut) - 2 and (np.diff(shut.astype(int)) <= 0).all()
    sizes = np.array([motion.period.amplitude for motion in motions])
    kappa, mu = PRESSED.structure.kappa, PRESSED.structure.mu  # f of (18) is 0 at this amplitude
    opening = 3.0 * kappa / mu * (1.0 + mu) / (1.0 + kappa) / (kappa / mu - 1.0)
    assert sizes[shut].max() < opening < sizes[~shut].min()
    places = np.array([motion.coordinates for motion in motions])
    theory = averaged.no_load_speed(*PRESSED.as_bonded(), places[:, 1])
    assert places[shut, 0] == pytest.approx(theory[shut], abs=2e-4)
    assert theory[-1] - places[-1, 0] > 8e-4


def test_its_motions_are_those_of_the_whole_system(pressed):
    motions, _, length = pressed
    assert motions[0].together and motions[-1].together
    for motion in (motions[0], motions[-1]):
        assert is_stable(motion)
        assert_repeats(PRESSED, motion, length)
    assert_held(PRESSED, next(motion for motion in motions if motion.period.impacts > 20))


def test_with_a_gap():
    """Impacts of two halves that are apart at rest."""
    motions, end, length = leg_of(OPEN, (0.975, 0.98))
    assert end == "limit" and motions[-1].period.impacts == motions[-1].period.revolutions == 1
    assert is_stable(motions[-1]) and not motions[-1].together
    assert_repeats(OPEN, motions[-1], length)
    assert_held(OPEN, motions[-1])


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
    torque = 0.5 * drive.epsilon * speeds**4 * (1.0 / box).imag
    expected = speeds - torque / drive.b(structure)
    assert [motion.coordinates[0] for motion in motions] == pytest.approx(expected, abs=2e-4)
    assert not any(motion.period.impacts for motion in motions)
