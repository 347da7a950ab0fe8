"""Jump voltages at rate 0, with a standard error that means something."""

import numpy as np
import pytest

from orchestrate import jump_voltages
from orchestrate.weak_drive.averaged import folds
from orchestrate.weak_drive.couple import schedule_from_arguments, scheme_from_arguments
from orchestrate.weak_drive.jump_voltages import JumpVoltagesJob

from .coupled import QUICK


@pytest.mark.slow
def test_quick():
    """Bonded at the averaged theory's folds, delaminated up and down at lower voltages."""
    rates = [2e-4, 1e-4, 5e-5]
    ends = {"voltage": (1.38, 1.64), "step": 0.2, "settle": 200.0, "progress": False}
    found = jump_voltages(*QUICK, rates=rates, **ends)
    up, down = folds(*QUICK.as_bonded())
    bonded, loose = (found.sel(structure=name) for name in ("bonded", "delaminated"))
    assert bonded.jumps.values == pytest.approx([up.eta0, down.eta0], abs=2e-4)
    assert loose.jumps.values == pytest.approx([1.56970, 1.43626], abs=1e-4)
    assert ((found.standard_error > 0.0) & (found.standard_error < 1.1e-4)).all()
    assert found.rate.values.tolist() == sorted(rates)
    assert (np.diff(bonded.voltage.sel(jump="up")) > 0.0).all()  # the faster the later


def test_over_a_parameter_the_bonded_structure_is_computed_once():
    ramps = tuple(
        schedule_from_arguments(*QUICK, (1.3, 1.6), None, r, None, 0.0, False) for r in (1, 2)
    )
    scheme = scheme_from_arguments(QUICK[0], 0.2)
    job = JumpVoltagesJob("x", *QUICK, ramps, scheme, "clearance", (0.0, 0.01))
    assert [one.bonded for one in job.items()] == [True, False, False]
    assert [one.clearance for one in job.items()[1:]] == [0.0, 0.01]
    jumps = np.arange(3.0)[:, None, None] + np.zeros((3, 3, 2))
    how, shown = np.full((3, 2), "by held voltages"), np.arange(24.0).reshape(3, 2, 2, 2)
    data = job.dataset({"jumps": jumps, "decided": how, "shown": shown})
    assert data.jumps.dims == ("structure", "clearance", "jump")
    assert data.jumps.sel(jump="up").values.tolist() == [[0.0, 0.0], [1.0, 2.0]]
    at = {"rate": 1, "jump": 0}
    assert data.voltage.isel(at).values.tolist() == [[4.0, 4.0], [12.0, 20.0]]
