"""Amplitudes between communication points, through impacts, against the whole system's solution."""

import numpy as np
import pytest

from orchestrate.weak_drive.extremes import range_of_mass
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.revolutions import Revolutions

from .coupled import QUICK, master, rest, settled
from .monolithic import Monolith

TIME, VOLTAGE = 45.0, 1.5


@pytest.mark.parametrize(("bonded", "h"), [(True, 0.17), (False, 0.17)])
def test_amplitudes(bonded, h):
    """To 1e-5; a parabola through both ends is off by up to 1e-3 where there are impacts."""
    system = QUICK.as_bonded() if bonded else QUICK
    state = settled(system, VOLTAGE, 1.25)
    times = np.linspace(0.0, TIME, 45_001)
    truth, impacts = Monolith(*system, VOLTAGE).solve(state, times)
    assert (impacts == 0) == bonded
    revolutions, rows = Revolutions(system.structure), []
    with master(system, Scheme(h), state) as m:
        begin = 0.0
        while m.time < TIME - h:
            row = revolutions.add(m.step(VOLTAGE))[0]
            if len(row["time"]):
                rows.append((begin, m.time, row["amplitude"][0], row["box_amplitude"][0]))
                begin = m.time
    assert len(rows) >= 7
    for begin, end, amplitude, box_amplitude in rows:
        part = truth[(times > begin - 1e-9) & (times < end + 1e-9)]
        assert amplitude == pytest.approx(0.5 * np.ptp(part[:, 0]), rel=1e-5)
        assert box_amplitude == pytest.approx(0.5 * np.ptp(part[:, 4]), rel=1e-5)


def test_a_mass_may_turn_before_and_after_an_impact_within_a_step():
    """Steps with one impact each, against steps of a thousandth, which miss the corner itself."""
    rng, turns = np.random.default_rng(1), 0
    for _ in range(30):
        x1, v1, v2 = rng.uniform(-1.0, 1.0, 3)
        state = [x1, v1, x1 + 0.05, min(v2, v1 - 0.1), *rest(1.2)[4:]]
        with master(QUICK, Scheme(0.4), state) as m:
            low, high = range_of_mass(QUICK.structure, m.step(VOLTAGE))
            impacts = m["impacts"]
        with master(QUICK, Scheme(0.001), state) as m:
            fine = m.run([VOLTAGE] * 400)
        if impacts == 1.0:
            found = (low[0], high[0])
            assert found == pytest.approx((fine["x1"].min(), fine["x1"].max()), abs=1e-3)
            struck = int(np.argmax(fine["impacts"] > 0.0))
            turns += np.ptp(np.sign(fine["v1"][struck:])) > 1.0
    assert turns >= 1
