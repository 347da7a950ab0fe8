"""Where the record of a ramp shows a jump, by made-up slips."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.weak_drive.ramp_record import RampRecord
from orchestrate.weak_drive.schedule import Ramp


def record_of(slips):
    """The record of a ramp from 1.2 to 1.4 by slips at some times."""
    time = np.arange(0.0, 2000.0, 5.0)
    eta0 = 1.2 + 1e-4 * time
    slip = np.interp(time, *zip(*slips, strict=True))
    drive = SimpleNamespace(b=lambda _: 0.1, volts=lambda _: 1.0)
    own = {"structure": SimpleNamespace(omega=1.0), "drive": drive}
    job = SimpleNamespace(**own, schedule=Ramp(1.2, 1.4, 1e-4, back=False))
    return time, RampRecord(job, {"time": time, "voltage": eta0, "speed": eta0 - slip}, up=True)


def test_where_a_ramp_shows_a_jump():
    """Late, where the slip falls from that before to that after; not at all if the ramp ends."""
    time, ramp = record_of([(0, 0.03), (800, 0.03), (900, 0.01), (2000, 0.01)])
    rows = ramp.row_positions_of_jump(1.26, 1.2601, 1.23, 1.2501)
    before, half, after = np.interp(rows, range(len(time)), time)
    assert before == pytest.approx(810.0, abs=15.0)
    assert half == pytest.approx(850.0, abs=15.0) and after == pytest.approx(890.0, abs=15.0)
    assert np.isnan(ramp.row_positions_of_jump(1.26, 1.2601, 1.23, 1.2901)).all()


def test_a_ramp_that_is_past_a_jump_before_its_voltage():
    """By an earlier one, its slip is below that after the jump from the first row on."""
    _, ramp = record_of([(0, 0.01), (2000, 0.005)])
    assert np.isfinite(ramp.row_positions_of_jump(1.26, 1.2601, 1.23, 1.2401)).all()
