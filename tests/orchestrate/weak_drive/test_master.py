"""The master against one system of equations: errors, orders, and the energy balance."""

import math

import numpy as np
import pytest

from orchestrate.errors import FmuError, InputError
from orchestrate.weak_drive.energy_balance import EnergyBalance
from orchestrate.weak_drive.master import Scheme

from .coupled import GRID, QUICK, history, master, rest, settled, state_of
from .monolithic import Monolith

PRESSED = QUICK.with_structure(clearance=-3.0)  # part, chatter and stick in each revolution
JUMPING = QUICK.with_structure(D1=0.01, D2=0.05)  # the force on the box jumps at impacts
CONTROLLED = Scheme(0.4, 1e-7)


class Case:
    """A settled motion, and the truth from there on."""

    def __init__(self, system, voltage, speed, time):
        self.system, self.voltage, self.time = system, voltage, time
        self.state = settled(system, voltage, speed)
        times = np.arange(0.0, time + GRID / 2, GRID)
        self.truth, self.impacts = Monolith(*system, voltage).solve(self.state, times)
        self.amplitude = np.abs(self.truth[:, 0]).max()

    def run(self, scheme, columns=(0, 2, 4)):
        """Largest errors of x1, x2 and y, over the amplitude of x1; energies, and all rows."""
        rows, energies = history(self.system, scheme, self.voltage, self.state, self.time)
        truth = self.truth[:: max(1, round(scheme.h / GRID))][: len(rows)]
        return np.abs(rows - truth)[:, columns].max() / self.amplitude, energies, rows


@pytest.fixture(scope="module")
def quick():
    return Case(QUICK, 1.5, 1.25, 40.0)


@pytest.fixture(scope="module")
def jumping():
    return Case(JUMPING, 1.3, 1.2, 24.0)


def test_the_error_is_of_fourth_order_and_nothing_is_missing(quick):
    assert quick.impacts >= 5
    errors, energies = zip(*(quick.run(Scheme(h))[:2] for h in (0.2, 0.1)), strict=True)
    assert errors[1] < 1e-6 and errors[0] / errors[1] > 2.0**3.4
    for one in energies:
        assert 0.0 < abs(one.missing) < one.defect_sizes < 1e-5 * one.motor


@pytest.mark.parametrize(("lag", "bonded"), [(0.3, False), (3.0, True)])
def test_inductance_of_the_armature(lag, bonded):
    """Current and torque lag behind the voltage; the current is compared too."""
    system = QUICK.with_lag(lag)
    case = Case(system.as_bonded() if bonded else system, 1.5, 1.25, 20.0)
    assert (case.impacts == 0) == bonded
    error, _, rows = case.run(Scheme(0.1))
    current = case.truth[:, 8]
    assert error < 1e-6 and np.abs(rows[:, 8] - current).max() < 1e-5 * np.ptp(current)


@pytest.mark.parametrize("name", ["quick", "jumping"])
def test_the_control_keeps_the_error_by_the_tolerance(name, request):
    """As cheap as fixed steps of 0.1, and better where the force jumps at impacts."""
    case = request.getfixturevalue(name)
    for tolerance in (1e-6, 1e-7):
        scheme = Scheme(0.4, tolerance)
        error, energies, _ = case.run(scheme, columns=(0, 2))
        assert error < 3.0 * tolerance, (tolerance, error)
        assert energies.defect_sizes < 3.0 * tolerance * energies.motor
    with master(case.system, scheme, case.state) as m:
        record = m.run([case.voltage] * round(case.time / 0.4))
    lengths = record.after["h"]
    assert record["time"][record.ends] == pytest.approx(0.4 * np.arange(1, len(record.ends) + 1))
    assert lengths.sum() == pytest.approx(case.time)
    assert {0.4 / 2**k for k in range(7)}.issuperset(lengths) and lengths.min() < 0.2
    assert len(lengths) < 1.3 * case.time / 0.1
    fixed = case.run(Scheme(0.1), columns=(0, 2))[0]
    assert error < (0.7 if name == "quick" else 0.05) * fixed


def test_losses_of_the_balance_are_those_of_the_dampers():
    """The structure's losses from the exchange, against the integral of d v^2."""
    system = QUICK.as_bonded()
    damping = system.structure.d1 + system.structure.d2
    balance = EnergyBalance(system.structure)
    with master(system, Scheme(0.05), rest(1.2)) as m:
        record = m.run([1.5] * 400)
    dampers = balance.add(record).dampers[-1]
    powers = damping * record["v1"] ** 2
    simpson = 0.05 / 3 * (powers[0] + 4 * powers[1:-1:2].sum() + 2 * powers[2:-1:2].sum())
    assert dampers > 0.0
    assert dampers == pytest.approx(simpson + 0.05 / 3 * powers[-1], rel=1e-6)


# -- the same bits ---------------------------------------------------------------------------------


def test_all_forms_give_the_same_bits():
    """States are saved and restored by the native and by the pythonfmu form alike."""
    rows = [
        history(QUICK, Scheme(0.2), 1.5, rest(1.2), 12.0, form)
        for form in ("fmi2-python", "fmi2", "fmi3")
    ]
    assert rows[0][1].impact_loss > 0.0
    for other, energies in rows[1:]:
        assert np.array_equal(other, rows[0][0]) and energies == rows[0][1]


@pytest.mark.parametrize("system", [QUICK, PRESSED], ids=["open", "pressed"])
def test_it_goes_on_with_the_same_bits(system):
    """Its memory has the length of the next step, too."""
    start = rest(1.2, system.structure)
    with master(system, CONTROLLED, start) as m:
        m.run([1.5] * 41)
        kept = m.get_state(), m.oscillator.instance.save_state(), m.drive.instance.save_state()
        assert m["level"] > 0
        m.run([1.5] * 41)
        expected = state_of(m)
    with master(system, CONTROLLED, start) as m:
        m.oscillator.instance.restore_state(kept[1])
        m.drive.instance.restore_state(kept[2])
        m.set_state(kept[0])
        m.run([1.5] * 41)
        assert state_of(m) == expected


# -- what is refused -------------------------------------------------------------------------------


def test_a_refusal_names_the_variable():
    with master(QUICK, Scheme(), rest(1.2)) as m:
        m.step(1.4)
        with pytest.raises(FmuError, match="voltage = inf"):
            m.run([1.4, math.inf, 1.4])


@pytest.mark.parametrize(
    ("arguments", "text"),
    [((0.0,), "step 0.0: expected a number > 0"), ((0.1, -1.0), "tolerance -1.0: expected")],
)
def test_mistakes(arguments, text):
    with pytest.raises(InputError, match=text):
        Scheme(*arguments)
