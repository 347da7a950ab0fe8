"""Jump voltages at rate 0, with a standard error that means something."""

import numpy as np
import pytest

from orchestrate import InputError, jump_voltages
from orchestrate.weak_drive.averaged import folds
from orchestrate.weak_drive.jump_voltages import extrapolate

from .coupled import QUICK


def test_the_error_is_that_of_many_trials():
    """Voltages with noise of 1e-3: the values found scatter as much as the error says."""
    rates = np.array([2e-4, 1e-4, 5e-5, 2e-5, 1e-5])
    noise = np.random.default_rng(5).normal(0.0, 1e-3, (2000, len(rates)))
    found = np.array([extrapolate(rates, 1.5 + 9.0 * rates ** (2 / 3) + row) for row in noise])
    assert found[:, 0].mean() == pytest.approx(1.5, abs=1e-4)
    assert np.sqrt((found[:, 1] ** 2).mean()) == pytest.approx(found[:, 0].std(), rel=0.05)


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
