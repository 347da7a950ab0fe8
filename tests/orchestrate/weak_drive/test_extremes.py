"""Amplitudes between communication points, through impacts, against the whole system's solution."""

import numpy as np
import pytest

from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.revolutions import COLUMNS, Revolutions

from .coupled import QUICK, master, settled
from .monolithic import Monolith

TIME, VOLTAGE = 45.0, 1.5


def rows_of(system, state, h):
    """Revolutions of a run from a state, and the times between which the watch was kept."""
    with master(system, Scheme(h), state) as m:
        revolutions = Revolutions(m, lambda: 0.0)
        rows, begins = [], [0.0]
        for _ in range(round(TIME / h)):
            m.step(VOLTAGE)
            row = revolutions.add()
            if row:
                rows.append(dict(zip(COLUMNS, row, strict=True)))
                begins.append(m.time)
    return rows, list(zip(begins, begins[1:], strict=False))


@pytest.mark.parametrize("bonded", [True, False])
@pytest.mark.parametrize("h", [0.1, 0.17])
def test_amplitudes(bonded, h):
    """To 1e-5; a parabola through both ends is off by up to 1e-3 where there are impacts."""
    system = QUICK.as_bonded() if bonded else QUICK
    state = settled(system, VOLTAGE, 1.25)
    times = np.linspace(0.0, TIME, 90_001)
    truth, impacts = Monolith(*system, VOLTAGE).solve(state, times)
    assert (impacts == 0) == bonded
    rows, spans = rows_of(system, state, h)
    assert len(rows) >= 7
    for row, (begin, end) in zip(rows, spans, strict=True):
        part = truth[(times > begin - 1e-9) & (times < end + 1e-9)]
        assert row["amplitude"] == pytest.approx(0.5 * np.ptp(part[:, 0]), rel=1e-5)
        assert row["box_amplitude"] == pytest.approx(0.5 * np.ptp(part[:, 4]), rel=1e-5)
