"""The weak drive of a structure with a gap between its faces, or with them pressed together."""

import numpy as np
import pytest

from orchestrate import couple
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.revolutions import Revolutions

from ...sparing import ordinary
from .coupled import GRID, QUICK, history, master, rest, settled
from .monolithic import Monolith

OPEN = QUICK.with_structure(clearance=3.0)  # two halves that strike each other once a revolution
PRESSED = QUICK.with_structure(clearance=-3.0)  # part, chatter and stick in each revolution
SLOWER = OPEN.with_structure(e=0.9, e_slope=0.2)  # restitution that decreases with speed
SHUT = QUICK.with_structure(clearance=-20.0)  # never part
APART = QUICK.with_structure(clearance=100.0)  # never touch
SYSTEMS = {"open": OPEN, "pressed": PRESSED, "slower": SLOWER}
VOLTAGE, SPEED, TIME = 1.5, 1.25, 40.0
EXACT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
SHORT = {"voltage": VOLTAGE, "speed_start": SPEED, "duration": 60.0}
SHORT |= {"jobs": 1, "progress": False}


class Case:
    """A settled motion, and the truth from there on."""

    def __init__(self, system):
        self.system, self.state = system, settled(system, VOLTAGE, SPEED, 200.0)
        times = np.linspace(0.0, TIME, 20_001)
        truth, self.impacts = Monolith(*system, VOLTAGE, EXACT).solve(self.state, times)
        self.times, self.fine, self.truth = times, truth, truth[:: round(20_000 * GRID / TIME)]
        self.amplitude = 0.5 * np.ptp(truth[:, 0])


@pytest.fixture(scope="module", params=ordinary(SYSTEMS))
def case(request):
    return Case(SYSTEMS[request.param])


def impact_energies(case):
    """Energy lost in impacts in the monolithic solution, by what all others leave of it."""
    whole, s, o = Monolith(*case.system, VOLTAGE), case.system.drive, case.system.structure
    rows = case.fine
    x1, v1, x2, v2, y, v, phi, w = rows.T[:8]
    torque = np.array([whole.electric(speed, 0.0, 0.0)[0] for speed in w])
    lost = o.d1 * v1**2 + o.d2 * v2**2 + s.box_damping * v**2
    kinetic = 0.5 * (o.m1 * (v1 + v) ** 2 + o.m2 * (v2 + v) ** 2 + s.box_mass * v**2)
    rotor = 0.5 * s.rotor_inertia * w**2 + whole.unbalance * w * v * np.cos(phi)
    springs = 0.5 * (o.k1 * x1**2 + o.k2 * x2**2 + s.box_stiffness * y**2)
    stored = kinetic + rotor + springs
    return np.trapezoid(torque * w - lost, case.times) - (stored[-1] - stored[0])


def test_the_motion_is_that_of_the_whole_system(case):
    """Displacements, impacts, contact phases; speed, and the energies, of the springs too."""
    rows, energies = history(case.system, Scheme(0.1), VOLTAGE, case.state, TIME)
    with master(case.system, Scheme(0.1), case.state) as m:
        m.run([VOLTAGE] * round(TIME / 0.1))
        assert m["impacts"] == case.impacts >= 5
    errors = np.abs(rows - case.truth).max(axis=0)
    assert errors[[0, 2, 4]].max() < 1e-6 * case.amplitude
    assert errors[7] < 1e-7
    assert abs(energies.missing) < 1e-6 * energies.motor
    assert energies.impact_loss == pytest.approx(impact_energies(case), rel=1e-3)
    gaps = case.truth[:, 2] - case.truth[:, 0] + case.system.structure.clearance
    assert gaps.min() > -1e-12 and gaps.max() > 0.05
    assert ((np.abs(gaps) < 1e-12).mean() > 0.3) == (case.system is PRESSED)


def test_amplitudes_between_communication_points(case):
    """In contact both masses swing about the position in which the springs balance."""
    with master(case.system, Scheme(0.17), case.state) as m:
        revolutions, begin = Revolutions(case.system.structure), 0.0
        seen = 0
        while m.time < TIME - 0.2:
            for amplitude in revolutions.add(m.step(VOLTAGE))[0]["amplitude"]:
                part = case.fine[(case.times > begin - 1e-9) & (case.times < m.time + 1e-9), 0]
                assert amplitude == pytest.approx(0.5 * np.ptp(part), rel=1e-5)
                begin, seen = m.time, seen + 1
    assert seen >= 6


def test_pressed_so_much_that_it_never_parts_it_moves_as_the_bonded_one():
    """From rest, where the springs are loaded and push nothing."""
    pressed, bonded = (couple(*one, **SHORT) for one in (SHUT, SHUT.as_bonded()))
    assert pressed.impacts.max() == 0.0
    for name in ("speed", "amplitude", "motor", "stored", "dampers"):
        size = np.abs(bonded[name].values).max()
        assert pressed[name].values == pytest.approx(bonded[name].values, abs=1e-9 * size), name
    assert abs(pressed.missing[-1]) < 1e-6 * pressed.motor[-1]


def test_so_far_apart_that_they_never_touch_the_halves_swing_freely():
    run = couple(*APART, **SHORT)
    assert run.impacts.max() == 0.0
    times = np.arange(0.0, 60.0 + GRID / 2, GRID)
    truth = Monolith(*APART, VOLTAGE).solve(rest(SPEED), times)[0]
    rows, _ = history(APART, Scheme(0.1), VOLTAGE, rest(SPEED), 60.0)
    assert np.abs(rows - truth)[:, [0, 2]].max() < 1e-6 * np.ptp(truth[:, 0])
    assert run.amplitude.max() == pytest.approx(np.ptp(truth[:, 0]) / 2, rel=0.2)


def test_the_bonded_structure_ignores_it():
    scheme, states = Scheme(0.1), []
    for system in (QUICK, OPEN, PRESSED):
        with master(system.as_bonded(), scheme, rest(SPEED)) as m:
            states.append(m.run([VOLTAGE] * 200).columns.tobytes())
    assert states[0] == states[1] == states[2]


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_all_scaled_the_motion_scales(system):
    """Lengths twice, the slope of e(v) half, torques four times: equal speeds, energies 4 times."""
    drive = system.drive
    twice = drive.replace(
        unbalance_radius=2.0 * drive.unbalance_radius,
        rotor_inertia=4.0 * drive.rotor_inertia,
        armature_resistance=0.25 * drive.armature_resistance,
    )
    own = system.structure
    structure = own.replace(clearance=2.0 * own.clearance, e_slope=0.5 * own.e_slope)
    small, large = couple(*system, **SHORT), couple(structure, twice, **SHORT)
    assert small.impacts.sum() > 5
    for name, unit in {"speed": 1.0, "amplitude": 2.0, "impact_loss": 4.0, "motor": 4.0}.items():
        assert np.array_equal(large[name], unit * small[name]), name
    other = couple(system.structure, twice, **SHORT)
    assert np.abs(other.speed - small.speed).max() > 1e-4  # the structure is not scaled
