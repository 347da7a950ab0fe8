"""The master against one system of equations: errors, observed orders, what matching the impulse is worth, and the books."""

from dataclasses import replace

import numpy as np
import pytest

from orchestrate.coupling import ALGORITHMS, Scheme
from orchestrate.errors import UserError
from orchestrate.setups import QUICK

from .coupled import GRID, history, master, settled, state_of
from .monolithic import Monolith

TIME = 40.0
# Observed order of the displacements' error between two communication steps, on settled motion with impacts, and how far it may be off; the table
# is in docs/coupling.md too.
ORDERS = {
    "jacobi": (0.025, 0.0125, 1.0, 0.2),
    "jacobi-derivative": (0.05, 0.025, 2.0, 0.2),
    "gauss-seidel": (0.1, 0.05, 3.0, 0.5),
    "rollback": (0.2, 0.1, 4.0, 0.6),
    "iterated": (0.4, 0.2, 5.0, 1.3),
}


class Case:
    """A settled motion with impacts, and the truth from there on."""

    def __init__(self, setup, voltage, speed, time=TIME):
        self.setup, self.voltage, self.time = setup, voltage, time
        self.state = settled(setup, voltage, speed)
        monolith = Monolith(setup.oscillator(), setup.shaker(), voltage)
        self.truth, self.impacts = monolith.solve(self.state, np.arange(0.0, time + GRID / 2, GRID))
        self.amplitude = np.abs(self.truth[:, 0]).max()

    def errors(self, algorithm, h, matched=True, columns=(0, 2, 4)):
        """Largest errors of x1, x2 and y, over the amplitude of x1; and the ledger."""
        rows, ledger = history(self.setup, Scheme(algorithm, h, matched), self.voltage, self.state, self.time)
        every = max(1, round(h / GRID))
        return np.abs(rows - self.truth[::every][: len(rows)])[:, columns].max() / self.amplitude, ledger


@pytest.fixture(scope="module")
def quick():
    return Case(QUICK, 1.5, 1.25)


@pytest.fixture(scope="module")
def jumping():
    """Damping of the masses differs, so the force on the box jumps at impacts."""
    return Case(replace(QUICK, D=0.01, damping_ratio=5.0), 1.3, 1.2, 24.0)


def test_default_master_agrees_with_the_whole_system(quick):
    assert quick.impacts >= 5
    error, ledger = quick.errors("rollback", 0.1)
    assert error < 1e-6  # asked for: 1e-5
    assert abs(ledger["missing"]) < 1e-6 * ledger["motor"]


@pytest.mark.parametrize("algorithm", ORDERS)
def test_order(quick, algorithm):
    coarse, fine, order, slack = ORDERS[algorithm]
    errors = [quick.errors(algorithm, h, columns=(0, 2))[0] for h in (coarse, fine)]
    assert abs(np.log2(errors[0] / errors[1]) / np.log2(coarse / fine) - order) < slack, errors


def test_iterated_is_a_reference(quick):
    assert quick.errors("iterated", 0.1)[0] < 1e-8


def test_jacobi_is_negative_damping(quick):
    """The coupling feeds energy in; with the derivative too it does so much less."""
    _, ledger = quick.errors("jacobi", 0.1)
    assert ledger["missing"] < -0.3 * ledger["motor"]
    assert ledger["defect_sizes"] > 0.3 * ledger["motor"]
    assert abs(quick.errors("jacobi-derivative", 0.1)[1]["missing"]) < 0.01 * ledger["motor"]


def test_point_values_fall_back_to_first_order_where_the_force_jumps(jumping):
    points = [jumping.errors("iterated", h, matched=False)[0] for h in (0.2, 0.1, 0.05, 0.025)]
    matched = jumping.errors("iterated", 0.1)[0]
    assert np.log2(points[0] / points[-1]) / 3.0 < 1.5
    assert matched < 1e-6 < 1e-4 < points[1]


def test_a_small_defect_does_not_prove_accuracy(jumping):
    """Gauss-Seidel: the books show far less than the motion is wrong by."""
    error, ledger = jumping.errors("gauss-seidel", 0.1)
    assert ledger["defect_sizes"] < 3e-4 * ledger["motor"] and error > 5e-4


def test_steps_are_halved_where_their_defect_is_large(quick):
    """Around impacts and wherever the step is too long; the motion is the better for it."""
    rows, errors, halved = {}, {}, {}
    for tolerance in (0.0, 1e-7):
        with master(QUICK, Scheme("rollback", 0.4, tolerance=tolerance), quick.state) as m:
            rows[tolerance] = [quick.state]
            for _ in range(round(quick.time / 0.4)):
                m.step(quick.voltage)
                rows[tolerance].append(state_of(m))
            halved[tolerance] = m.halved
        errors[tolerance] = np.abs(np.array(rows[tolerance]) - quick.truth[::2])[:, 0].max()
    assert halved[0.0] == 0 < halved[1e-7]
    assert errors[1e-7] < 0.1 * errors[0.0]


@pytest.mark.parametrize("form", ["fmi2", "fmi3"])
def test_all_forms_give_the_same_bits(form):
    """States are saved and restored by the native and by the pythonfmu form alike."""
    start = (0.0,) * 7 + (1.2,)
    expected, books = history(QUICK, Scheme("rollback", 0.1), 1.5, start, 30.0, "fmi2-python")
    found, other = history(QUICK, Scheme("rollback", 0.1), 1.5, start, 30.0, form)
    assert np.array_equal(found, expected)
    assert books == other
    assert books["impacts"] > 0.0


def test_losses_of_the_books_are_those_of_the_dampers():
    """The structure's losses from the exchange, against the integral of d v^2."""
    setup = QUICK.as_bonded()
    damping = setup.oscillator()["d1"] + setup.oscillator()["d2"]
    with master(setup, Scheme("rollback", 0.05), (0.0,) * 7 + (1.2,)) as m:
        before = m.x[2]
        losses, powers = [0.0], [damping * before**2]
        for _ in range(400):
            m.step(1.5)
            powers.append(damping * m.x[2] ** 2)
            losses.append(m.ledger.lost)
        assert losses[-1] > 0.0
        simpson = 0.05 / 3 * (powers[0] + powers[-1] + 4 * sum(powers[1:-1:2]) + 2 * sum(powers[2:-1:2]))
        assert losses[-1] == pytest.approx(simpson, rel=1e-6)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_clock_is_kept(algorithm):
    with master(QUICK, Scheme(algorithm, 0.1)) as m:
        for _ in range(1000):
            m.step(1.4)
        assert m.time == pytest.approx(100.0, abs=1e-9)


@pytest.mark.parametrize(
    ("arguments", "parts"), [(("euler", 0.1), ["euler", "rollback"]), (("jacobi", 0.0), ["0.0", "> 0"]), (("jacobi", 0.1, True, 1e-6), ["rollback"])]
)
def test_mistakes(arguments, parts):
    with pytest.raises(UserError) as caught:
        Scheme(*arguments)
    assert all(part in str(caught.value) for part in parts)
