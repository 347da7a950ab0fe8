"""The master against one system of equations: errors, orders, amplitudes and the energy balance."""

import functools
import math

import numpy as np
import pytest

from orchestrate import couple
from orchestrate.errors import FmuError, InputError
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.revolutions import Revolutions

from .coupled import GRID, QUICK, history, master, rest, settled, state_of
from .monolithic import Monolith

OPEN = QUICK.with_structure(clearance=3.0)  # two halves that strike each other once a revolution
PRESSED = QUICK.with_structure(clearance=-3.0)  # part, chatter and stick in each revolution
SHUT = QUICK.with_structure(clearance=-20.0)  # never part
SYSTEMS = {  # with voltage, speed and the fewest impacts
    "quick": (QUICK, 1.5, 1.25, 5),
    "open": (OPEN, 1.5, 1.25, 5),
    "pressed": (PRESSED, 1.5, 1.25, 50),
    "jumping": (QUICK.with_structure(D1=0.01, D2=0.05), 1.3, 1.2, 5),  # its force at impacts
    "inductive": (QUICK.with_lag(0.3), 1.5, 1.25, 5),  # current and torque lag behind
    "bonded": (QUICK.as_bonded().with_lag(3.0), 1.5, 1.25, 0),
}
TIME, FINE = 30.0, 15_000


class Case:
    """A settled motion, and the truth from there on."""

    def __init__(self, system, voltage, speed, few):
        self.system, self.voltage, self.few = system, voltage, few
        self.state = settled(system, voltage, speed, 400.0)
        self.times = np.linspace(0.0, TIME, FINE + 1)
        self.fine, self.impacts = Monolith(*system, voltage).solve(self.state, self.times)
        self.truth = self.fine[:: round(FINE * GRID / TIME)]
        self.amplitude = np.abs(self.truth[:, 0]).max()

    def run(self, scheme, columns=(0, 2, 4)):
        """Largest errors of x1, x2 and y, over the amplitude of x1; energies, and all rows."""
        rows, energies = history(self.system, scheme, self.voltage, self.state, TIME)
        truth = self.truth[:: max(1, round(scheme.h / GRID))][: len(rows)]
        return np.abs(rows - truth)[:, columns].max() / self.amplitude, energies, rows


case_of = functools.cache(lambda name: Case(*SYSTEMS[name]))


@pytest.fixture(params=SYSTEMS)
def case(request):
    return case_of(request.param)


def test_the_motion_is_that_of_the_whole_system(case, request):
    """Of fourth order; displacements, impacts, contact, current; nothing of the energy is lost."""
    (coarse, *_), (error, energies, rows) = (case.run(Scheme(h)) for h in (0.2, 0.1))
    name = request.node.callspec.params["case"]  # after some impacts their times' errors show
    least = 3.0 if name in ("open", "jumping", "inductive") else 9.0
    assert error < (2e-4 if name == "jumping" else 2e-6) and coarse > least * error
    assert np.abs(rows[:, 7] - case.truth[:, 7]).max() < 1e-6
    if case.system.drive.armature_inductance:
        current = case.truth[:, 8]
        assert np.abs(rows[:, 8] - current).max() < 1e-5 * np.ptp(current)
    assert 0.0 < abs(energies.missing) < energies.defect_sizes < 1e-5 * energies.motor
    with master(case.system, Scheme(0.1), case.state) as m:
        m.run([case.voltage] * round(TIME / 0.1))
        assert m["impacts"] == case.impacts >= case.few
    gaps = case.truth[:, 2] - case.truth[:, 0] + case.system.structure.gap_offset
    assert gaps.min() > -1e-12 and (gaps.max() > 0.05) == (case.few > 0)
    assert ((np.abs(gaps) < 1e-12).mean() > 0.3) == (case.few in (0, 50))


def test_amplitudes_between_communication_points(case):
    """To 1e-4; a parabola through both ends is off by up to 1e-3 where there are impacts."""
    with master(case.system, Scheme(0.17), case.state) as m:
        revolutions, begin, seen = Revolutions(case.system.structure), 0.0, 0
        while m.time < TIME - 0.2:
            row = revolutions.add_record(m.step(case.voltage))[0]
            for amplitude, box in zip(row["amplitude"], row["box_amplitude"], strict=True):
                part = case.fine[(case.times > begin - 1e-9) & (case.times < m.time + 1e-9)]
                assert amplitude == pytest.approx(0.5 * np.ptp(part[:, 0]), rel=1e-4)
                assert box == pytest.approx(0.5 * np.ptp(part[:, 4]), rel=1e-4)
                begin, seen = m.time, seen + 1
    assert seen >= 4


@pytest.mark.parametrize("name", ["quick", "jumping"])
def test_the_control_keeps_the_error_by_the_tolerance(name):
    """As cheap as fixed steps of 0.1, and better where the force jumps at impacts."""
    case = case_of(name)
    for tolerance in (1e-6, 1e-7):
        scheme = Scheme(0.4, tolerance)
        error, energies, _ = case.run(scheme, columns=(0, 2))
        assert error < 3.0 * tolerance, (tolerance, error)
        assert energies.defect_sizes < 3.0 * tolerance * energies.motor
    with master(case.system, scheme, case.state) as m:
        record = m.run([case.voltage] * round(TIME / 0.4))
    lengths = record.after["h"]
    assert record["time"][record.ends] == pytest.approx(0.4 * np.arange(1, len(record.ends) + 1))
    assert lengths.sum() == pytest.approx(TIME) and len(lengths) < 1.3 * TIME / 0.1
    assert {0.4 / 2**k for k in range(7)}.issuperset(lengths) and lengths.min() < 0.2
    assert error < (0.7 if name == "quick" else 0.05) * case.run(Scheme(0.1), columns=(0, 2))[0]


def test_gaps_that_never_close_or_open():
    """Pressed so much that it never parts it is the bonded one, which ignores a clearance."""
    short = {"voltage": 1.5, "speed_start": 1.25, "duration": 60.0, "jobs": 1, "progress": False}
    pressed, bonded = (couple(*one, **short) for one in (SHUT, SHUT.as_bonded()))
    for name in ("speed", "amplitude", "motor", "stored", "dampers", "impacts"):
        size = np.abs(bonded[name].values).max()
        assert pressed[name].values == pytest.approx(bonded[name].values, abs=1e-9 * size), name
    assert abs(pressed.missing[-1]) < 1e-6 * pressed.motor[-1]


def test_all_forms_give_the_same_bits():
    """States are saved and restored by the native and by the pythonfmu form alike."""
    run = (QUICK, Scheme(0.2), 1.5, rest(1.2), 12.0)
    rows = [history(*run, form) for form in ("fmi2-python", "fmi2", "fmi3")]
    assert rows[0][1].impact_loss > 0.0
    for other, energies in rows[1:]:
        assert np.array_equal(other, rows[0][0]) and energies == rows[0][1]


@pytest.mark.parametrize("system", [QUICK, PRESSED], ids=["open", "pressed"])
def test_it_goes_on_with_the_same_bits(system):
    """Its memory has the length of the next step, too."""
    controlled, start = Scheme(0.4, 1e-7), rest(1.2, system.structure)
    with master(system, controlled, start) as m:
        m.run([1.5] * 41)
        kept = (
            m.numbers_to_resume(),
            m.oscillator.instance.save_state(),
            m.drive.instance.save_state(),
        )
        assert m["level"] > 0
        m.run([1.5] * 41)
        expected = state_of(m)
    with master(system, controlled, start) as m:
        m.oscillator.instance.restore_state(kept[1])
        m.drive.instance.restore_state(kept[2])
        m.resume_from(kept[0])
        m.run([1.5] * 41)
        assert state_of(m) == expected


def test_what_is_refused():
    with master(QUICK, Scheme(), rest(1.2)) as m:
        m.step(1.4)
        with pytest.raises(FmuError, match="voltage = inf"):
            m.run([1.4, math.inf, 1.4])
    for arguments, text in (((0.0,), "step = 0.0"), ((0.1, -1.0), "tolerance = -1.0")):
        with pytest.raises(InputError, match=text):
            Scheme(*arguments)
