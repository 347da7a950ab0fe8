"""Jump voltages at rate 0, with a standard error that means something."""

import numpy as np
import pytest

from orchestrate import InputError, jump_voltages
from orchestrate.weak_drive.averaged import folds
from orchestrate.weak_drive.jump_voltages import (
    DIRECTIONS,
    KINDS,
    JumpVoltagesJob,
    extrapolate,
    fit_rate_powers,
)
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.schedule import Ramp

from .coupled import QUICK


def test_the_error_is_that_of_many_trials():
    """Voltages with noise of 1e-3: the error says at least how the values found scatter."""
    rates = np.array([2e-4, 1e-4, 5e-5, 2e-5, 1e-5])
    noise = np.random.default_rng(5).normal(0.0, 1e-3, (2000, len(rates)))
    found = np.array([extrapolate(rates, 1.5 + 9.0 * rates ** (2 / 3) + row) for row in noise])
    assert found[:, 0].mean() == pytest.approx(1.5, abs=2e-4)
    scatter, told = found[:, 0].std(), np.sqrt((found[:, 1] ** 2).mean())
    assert scatter < told < 1.5 * scatter


@pytest.mark.parametrize("rates", [[1e-4, 5e-5, 2.5e-5], [4e-5, 2e-5, 1e-5]])
def test_a_speed_that_passes_a_fold(rates):
    """x' = b (eta0 - x^2 / 2) leaves at eta0 = 0, late; a line in rate^(2/3) is off by more."""
    b, late = 0.05, []
    for rate in rates:
        x, eta0, h = -0.25, -0.03, 0.5
        while x < 0.3:  # where the jump is seen: it takes a time, whatever the rate
            x -= h * b * (-eta0 - 0.5 * x * x)
            eta0 += h * rate
        late.append(eta0)
    value, error = extrapolate(np.array(rates), np.array(late))
    line, _ = fit_rate_powers(np.array(rates), np.array(late), (2.0 / 3.0,))
    assert abs(value) < error < 1e-3
    assert abs(value) < 0.4 * abs(line)


RAMPS = {  # voltages of jumps through both FMUs at 1e-5, 3e-5 and 1e-4, and the branch's folds
    ("bonded", "up"): (1.58310, [1.5877668, 1.5930676, 1.6060338]),
    ("bonded", "down"): (1.43570, [1.4305604, 1.4252238, 1.4125001]),
    ("delaminated", "up"): (1.56970, [1.5744724, 1.5798935, 1.5930892]),
    ("delaminated", "down"): (1.43626, [1.4310957, 1.4257515, 1.4130237]),
}


def test_an_error_that_the_fit_alone_does_not_tell():
    """Down, terms of the lag cancel: the last one of the fit changes a tenth of what is missed."""
    rates = (1e-5, 3e-5, 1e-4)
    table = [[[RAMPS[kind, way][1][i] for way in DIRECTIONS] for kind in KINDS] for i in range(3)]
    speeds, held = np.full_like(table, 1.3), np.full_like(table, np.nan)
    rows = np.stack([table, speeds, held, held], axis=2).reshape(-1, 4, len(DIRECTIONS))
    ramps = tuple(Ramp(1.4, 1.62, rate) for rate in rates)
    job = JumpVoltagesJob("jump_voltages", *QUICK, ramps, Scheme("rollback", 0.4))
    found = job.dataset({"jumps": rows}, {})
    for (kind, way), (fold, voltages) in RAMPS.items():
        at = found.sel(structure=kind, jump=way)
        missed = abs(float(at.jumps) - fold)
        assert missed < 1.2 * float(at.standard_error) < 3e-4
        alone = extrapolate(np.array(rates), np.array(voltages))[1]
        assert (missed > 5.0 * alone) == (way == "down")


def test_voltages_that_were_held_at_every_rate_are_those_at_rate_0():
    """Where folds are close the ramps' voltages were extrapolated several errors past them."""
    ramps = tuple(Ramp(1.4, 1.62, rate) for rate in (5e-5, 1e-4))
    job = JumpVoltagesJob("jump_voltages", *QUICK, ramps, Scheme("rollback", 0.4))
    rows = np.zeros((2, len(KINDS), 4, len(DIRECTIONS)))
    rows[:, :, 0] = np.array([1.40, 1.39])[:, np.newaxis, np.newaxis]
    rows[:, :, 2:] = np.nan
    rows[:, 1, 2, 1], rows[:, 1, 3, 1] = (1.39490, 1.39492), (5e-5, 4e-5)
    rows[0, 1, 2:, 0] = 1.41, 1e-5  # at one rate of two
    found = job.dataset({"jumps": rows.reshape(-1, 4, len(DIRECTIONS))}, {})
    assert found.held.values.tolist() == [[False, False], [False, True]]
    at = found.sel(structure="delaminated", jump="down")
    assert float(at.jumps) == pytest.approx(1.394905) and float(at.standard_error) == (
        pytest.approx(5.5e-5)
    )
    assert float(found.jumps.sel(structure="delaminated", jump="up")) > 1.41


def test_too_few_jumps_give_no_error():
    rates, voltages = np.array([1e-4, 5e-5, 2e-5]), np.array([np.nan, 1.6, 1.59])
    value, error = extrapolate(rates, voltages)
    assert 1.57 < value < 1.59 and np.isnan(error)
    assert np.isnan(extrapolate(rates[:2], voltages[:2])).all()


@pytest.mark.slow
def test_quick():
    """Bonded at the averaged theory's folds, delaminated up and down at lower voltages."""
    rates = [2e-4, 1e-4, 5e-5]
    ends = {"voltage": (1.38, 1.64), "step": 0.2, "settle": 200.0, "progress": False}
    found = jump_voltages(*QUICK, rates=rates, **ends)
    up, down = folds(*QUICK.as_bonded())
    bonded, loose = (found.sel(structure=name) for name in ("bonded", "delaminated"))
    assert bonded.jumps.values == pytest.approx([up.eta0, down.eta0], abs=2e-3)
    assert loose.jumps[0] == pytest.approx(1.5697, abs=3e-3)
    assert ((found.standard_error > 0.0) & (found.standard_error < 3e-3)).all()
    assert found.rate.values.tolist() == sorted(rates)
    assert (np.diff(bonded.voltage.sel(jump="up")) > 0.0).all()  # the faster the later


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ({"rates": [1e-4]}, ["rates = [0.0001]", "two different"]),
        ({"rates": [1e-4, -1e-4]}, ["rate = -0.0001", "> 0"]),
        ({"voltage": 1.4}, ["voltage = 1.4", "duration"]),
    ],
)
def test_mistakes(arguments, parts):
    with pytest.raises(InputError) as caught:
        jump_voltages(*QUICK, progress=False, **{"voltage": (1.3, 1.6), **arguments})
    assert all(part in str(caught.value) for part in parts), str(caught.value)
