"""The master against one system of equations: errors, orders, and the energy balance."""

import numpy as np
import pytest

from orchestrate.errors import InputError
from orchestrate.weak_drive.master import ALGORITHMS, Master, Scheme

from .coupled import GRID, QUICK, history, master, rest, settled, state_of
from .monolithic import Monolith

TIME = 40.0
# Observed order of the displacements' error between two communication steps, on settled motion with
# impacts, and how far it may be off; docs/coupling_scheme.md has these numbers.
ORDERS = {
    "jacobi": (0.025, 0.0125, 1.0, 0.2),
    "jacobi-derivative": (0.05, 0.025, 2.0, 0.2),
    "gauss-seidel": (0.1, 0.05, 3.0, 0.5),
    "rollback": (0.2, 0.1, 4.0, 0.6),
    "iterated": (0.4, 0.2, 5.0, 1.3),
}


class Case:
    """A settled motion, and the truth from there on."""

    def __init__(self, system, voltage, speed, time=TIME):
        self.system, self.voltage, self.time = system, voltage, time
        self.state = settled(system, voltage, speed)
        times = np.arange(0.0, time + GRID / 2, GRID)
        self.truth, self.impacts = Monolith(*system, voltage).solve(self.state, times)
        self.amplitude = np.abs(self.truth[:, 0]).max()

    def errors(self, algorithm, h, matched=True, columns=(0, 2, 4)):
        """Largest errors of x1, x2 and y, over the amplitude of x1; and the energies."""
        scheme = Scheme(algorithm, h, matched)
        rows, energies = history(self.system, scheme, self.voltage, self.state, self.time)
        truth = self.truth[:: max(1, round(h / GRID))][: len(rows)]
        return np.abs(rows - truth)[:, columns].max() / self.amplitude, energies


@pytest.fixture(scope="module")
def quick():
    return Case(QUICK, 1.5, 1.25)


@pytest.fixture(scope="module")
def jumping():
    """Damping of the masses differs, so the force on the box jumps at impacts."""
    return Case(QUICK.with_structure(D1=0.01, D2=0.05), 1.3, 1.2, 24.0)


def test_default_master_agrees_with_the_whole_system(quick):
    assert quick.impacts >= 5
    error, energies = quick.errors("rollback", 0.1)
    assert error < 1e-6  # asked for: 1e-5
    assert abs(energies.missing) < 1e-6 * energies.motor


@pytest.mark.parametrize("lag", [0.3, 3.0])
@pytest.mark.parametrize("bonded", [True, False])
def test_inductance_of_the_armature(lag, bonded):
    """Current and torque lag behind the voltage; the current is compared too."""
    system = QUICK.with_lag(lag)
    case = Case(system.as_bonded() if bonded else system, 1.5, 1.25, 20.0)
    assert (case.impacts == 0) == bonded
    assert case.errors("rollback", 0.1)[0] < 1e-6
    rows, _ = history(case.system, Scheme("rollback", 0.1), 1.5, case.state, case.time)
    current = case.truth[:, 8]
    assert np.abs(rows[:, 8] - current).max() < 1e-5 * np.ptp(current)


@pytest.mark.parametrize("algorithm", ORDERS)
def test_order(quick, algorithm):
    coarse, fine, order, slack = ORDERS[algorithm]
    errors = [quick.errors(algorithm, h, columns=(0, 2))[0] for h in (coarse, fine)]
    assert abs(np.log2(errors[0] / errors[1]) / np.log2(coarse / fine) - order) < slack, errors


def test_iterated_is_a_reference(quick):
    assert quick.errors("iterated", 0.1)[0] < 1e-8


def test_jacobi_is_negative_damping(quick):
    """The coupling feeds energy in; with the derivative too it does so much less."""
    _, energies = quick.errors("jacobi", 0.1)
    assert energies.missing < -0.3 * energies.motor
    assert energies.defect_sizes > 0.3 * energies.motor
    better = quick.errors("jacobi-derivative", 0.1)[1]
    assert abs(better.missing) < 0.01 * energies.motor


def test_point_values_fall_back_to_first_order_where_the_force_jumps(jumping):
    steps = (0.2, 0.1, 0.05, 0.025)
    points = [jumping.errors("iterated", h, matched=False)[0] for h in steps]
    matched = jumping.errors("iterated", 0.1)[0]
    assert np.log2(points[0] / points[-1]) / 3.0 < 1.5
    assert matched < 1e-6 < 1e-4 < points[1]


def test_a_small_defect_does_not_prove_accuracy(jumping):
    """Gauss-Seidel: the energy balance shows far less than the motion is wrong by."""
    error, energies = jumping.errors("gauss-seidel", 0.1)
    assert energies.defect_sizes < 3e-4 * energies.motor
    assert error > 5e-4


class Recording(Master):
    """A master that keeps the lengths of its steps."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.lengths = []

    def _accept_step(self, done, h):
        self.lengths.append(h)
        super()._accept_step(done, h)


def controlled(case, tolerance):
    """Error of the displacements over the amplitude with the step control, and the steps done."""
    scheme = Scheme("rollback", 0.4, tolerance=tolerance)
    with master(case.system, scheme, case.state, kind=Recording) as m:
        rows = [case.state]
        for _ in range(round(case.time / 0.4)):
            m.step(case.voltage)
            rows.append(state_of(m))
    error = np.abs(np.array(rows) - case.truth[::2])[:, [0, 2]].max()
    return error / case.amplitude, m.lengths


@pytest.mark.parametrize("name", ["quick", "jumping"])
def test_the_control_keeps_the_error_by_the_tolerance(name, request):
    """As cheap as fixed steps of 0.1, and as good where the force jumps at impacts."""
    case = request.getfixturevalue(name)
    for tolerance in (1e-6, 1e-8):
        error, lengths = controlled(case, tolerance)
        assert error < 20.0 * tolerance, (tolerance, error)
        assert sum(lengths) == pytest.approx(case.time)
        assert {0.4 / 2**k for k in range(11)}.issuperset(lengths)
    assert len(lengths) < 1.1 * case.time / 0.1
    fixed = case.errors("rollback", 0.1, columns=(0, 2))[0]
    assert error < (fixed if name == "quick" else 0.05 * fixed)


def test_the_control_goes_on_with_the_same_bits():
    """Its memory has the length of the next step."""
    scheme = Scheme("rollback", 0.4, tolerance=1e-8)
    with master(QUICK, scheme, rest(1.2)) as m:
        for _ in range(41):
            m.step(1.5)
        kept = m.get_state(), m.oscillator.instance.save_state(), m.shaker.instance.save_state()
        assert m.level > 0
        for _ in range(41):
            m.step(1.5)
        expected = state_of(m)
    with master(QUICK, scheme, rest(1.2)) as m:
        m.oscillator.instance.restore_state(kept[1])
        m.shaker.instance.restore_state(kept[2])
        m.set_state(kept[0])
        for _ in range(41):
            m.step(1.5)
        assert state_of(m) == expected


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
def test_all_forms_give_the_same_bits(form):
    """States are saved and restored by the native and by the pythonfmu form alike."""
    scheme = Scheme("rollback", 0.1)
    expected, energies = history(QUICK, scheme, 1.5, rest(1.2), 30.0, "fmi2-python")
    found, others = history(QUICK, scheme, 1.5, rest(1.2), 30.0, form)
    assert np.array_equal(found, expected)
    assert energies == others
    assert energies.impact_loss > 0.0


def test_losses_of_the_balance_are_those_of_the_dampers():
    """The structure's losses from the exchange, against the integral of d v^2."""
    system = QUICK.as_bonded()
    damping = system.structure.d1 + system.structure.d2
    with master(system, Scheme("rollback", 0.05), rest(1.2)) as m:
        powers = [damping * m.motion.v1**2]
        for _ in range(400):
            m.step(1.5)
            powers.append(damping * m.motion.v1**2)
        assert m.balance.lost > 0.0
        inner = 4 * sum(powers[1:-1:2]) + 2 * sum(powers[2:-1:2])
        simpson = 0.05 / 3 * (powers[0] + powers[-1] + inner)
        assert m.balance.lost == pytest.approx(simpson, rel=1e-6)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_clock_is_kept(algorithm):
    with master(QUICK, Scheme(algorithm, 0.1), rest()) as m:
        for _ in range(1000):
            m.step(1.4)
        assert m.time == pytest.approx(100.0, abs=1e-9)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("euler", 0.1), ["euler", "rollback"]),
        (("jacobi", 0.0), ["0.0", "> 0"]),
        (("jacobi", 0.1, True, 1e-6), ["rollback"]),
        (("rollback", 0.1, True, -1.0), ["tolerance -1.0", ">= 0"]),
    ],
)
def test_mistakes(arguments, parts):
    with pytest.raises(InputError) as caught:
        Scheme(*arguments)
    assert all(part in str(caught.value) for part in parts)
