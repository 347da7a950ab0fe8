"""The Sommerfeld effect's numbers: jumps, capture, the books over a whole run, and the theory beside it."""

import numpy as np
import pytest

from orchestrate import averaged
from orchestrate.coupling import Scheme
from orchestrate.driveresult import jumps
from orchestrate.exchange import OSCILLATOR, SHAKER
from orchestrate.schedule import Plan, Schedule
from orchestrate.setups import BEAM, QUICK
from orchestrate.weakdrive import COLUMNS, run

from ..conftest import BUILD

FMUS = tuple(BUILD / "fmi2" / f"{model}.fmu" for model in (OSCILLATOR, SHAKER))
RATES = (1e-4, 3e-5)


class Memory:
    """A journal without a disk."""

    def __init__(self):
        self.kept = []

    def length(self):
        return len(self.kept)

    def row(self, index):
        return self.kept[index]

    def append(self, index, data):
        assert index == len(self.kept)
        self.kept.append(data)


def revolutions(setup, schedule, speed, h=0.2, journal=None):
    """Rows of a run, and its plan."""
    plan = Plan(setup, schedule, Scheme("rollback", h), speed, ())
    return run(plan, FMUS, journal or Memory()), plan


def column(rows, name):
    return rows[:, COLUMNS.index(name)]


def extrapolated(setup, first, last, speed, rates=RATES):
    """The jump at rate 0: it comes late by about rate^(2/3)."""
    found = [jumps(*revolutions(setup, Schedule(first, last, rate, back=False), speed))[int(first > last)] for rate in rates]
    return np.linalg.lstsq(np.array([[1.0, rate ** (2 / 3)] for rate in rates]), np.array(found), rcond=None)[0][0], found


def test_non_dimensional_numbers():
    assert (BEAM.beta, BEAM.epsilon, BEAM.b) == pytest.approx((3 / 11, 1 / 1100, 0.08))
    assert (QUICK.beta, QUICK.epsilon, QUICK.b) == pytest.approx((3 / 11, 1 / 1100, 0.02))
    assert (QUICK.length, QUICK.volts, QUICK.energy) == pytest.approx((1.0, 1.0, 1.0))
    assert BEAM.volts == pytest.approx(4.5)


def test_folds_of_the_averaged_theory():
    (up, top), (down, _) = averaged.folds(QUICK)
    assert up == pytest.approx(1.58306, abs=5e-6)
    assert top == pytest.approx(1.3089, abs=1e-3)
    assert down == pytest.approx(1.4357, abs=1e-4)
    assert averaged.amplitude(QUICK, 1.3089) == pytest.approx(19.99, abs=0.05)
    assert averaged.folds(BEAM)[0][0] == pytest.approx(1.5419, abs=2e-4)


def test_jump_up_bonded():
    value, found = extrapolated(QUICK.as_bonded(), 1.535, 1.62, 0.0)
    assert found == pytest.approx([1.606, 1.593], abs=5e-4)
    assert value == pytest.approx(1.5831, abs=2e-3)


def test_jump_down_bonded():
    assert extrapolated(QUICK.as_bonded(), 1.46, 1.39, 1.44)[0] == pytest.approx(1.4357, abs=2e-3)


def test_jump_up_delaminated():
    """Lower than bonded, and so is the peak: from the branch that comes from below."""
    assert extrapolated(QUICK, 1.45, 1.61, 0.0)[0] == pytest.approx(1.5697, abs=3e-3)


@pytest.mark.slow
def test_jumps_of_the_beam():
    rates = (4e-5, 2e-5, 1e-5)
    bonded = extrapolated(BEAM.as_bonded(), 1.33, 1.57, 1.25, rates)[0]
    delaminated = extrapolated(BEAM, 1.33, 1.57, 1.25, rates)[0]
    assert (bonded, delaminated) == pytest.approx((1.5419, 1.510), abs=1e-3)


@pytest.mark.parametrize(("eta0", "caught"), [(1.540, True), (1.547, False)])
def test_capture(eta0, caught):
    """From rest at constant voltage the motor hangs at the resonance below a critical voltage."""
    rows, _ = revolutions(QUICK.as_bonded(), Schedule(eta0, eta0, 1.0, 700.0, back=False), 0.0)
    assert (column(rows, "Omega")[-1] < 1.32) == caught


@pytest.mark.parametrize("bonded", [True, False])
def test_books_of_a_whole_run(bonded):
    """Up and down through both jumps: nothing is missing, and nothing is counted twice."""
    setup = QUICK.as_bonded() if bonded else QUICK
    rows, plan = revolutions(setup, Schedule(1.34, 1.68, 2e-4, 200.0), 1.26, h=0.1)
    up, down = jumps(rows, plan)
    assert 1.58 < up < 1.65 and 1.36 < down < 1.43
    motor = column(rows, "motor")[-1]
    assert abs(column(rows, "missing")[-1]) < 1e-6 * motor
    assert column(rows, "defect_sizes")[-1] < 1e-6 * motor
    assert all(column(rows, name)[-1] > 0.0 for name in ("dampers", "box_damper"))
    assert (column(rows, "impact_loss")[-1] == 0.0) == bonded


def test_a_run_goes_on_with_the_same_bits():
    schedule = Schedule(1.4, 1.41, 2e-5, 100.0)
    expected, plan = revolutions(QUICK, schedule, 1.25)
    journal = Memory()

    class Enough(Exception):
        pass

    def stop(done):
        if done >= 2000:
            raise Enough

    with pytest.raises(Enough):
        run(plan, FMUS, journal, stop)
    assert 0 < journal.length() < 3
    assert np.array_equal(run(plan, FMUS, journal), expected)


def test_schedule():
    ramp = Schedule(1.0, 1.2, 1e-3, 50.0)
    assert [ramp.eta0(t) for t in (0.0, 50.0, 150.0, 250.0, 350.0, 450.0, 999.0)] == pytest.approx([1.0, 1.0, 1.1, 1.2, 1.1, 1.0, 1.0])
    steps = Schedule(1.2, 1.0, 1e-3, 0.0, increment=0.05)
    assert [steps.eta0(t) for t in (0.0, 49.0, 51.0, 199.0, 201.0, 249.0, 251.0, 400.0)] == pytest.approx([1.2, 1.2, 1.15, 1.05, 1.0, 1.0, 1.05, 1.2])
    assert (ramp.duration, steps.duration) == pytest.approx((450.0, 400.0))
