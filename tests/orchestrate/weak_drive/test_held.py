"""Held voltages tell a motion that is lost from a steep branch, on a speed with a known fold."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.weak_drive.held import FOLLOWS, LEFT_BEFORE, LOST, Holder
from orchestrate.weak_drive.jumps import DOUBTFUL, Passing
from orchestrate.weak_drive.schedule import Ramp

H = 2.0


class Rotor:
    """A speed that follows eta0 = 1.5 + slope x + 20 x^3, x = speed - 1.3; a step a revolution."""

    def __init__(self, schedule, slope, start):
        self.schedule, self.slope, self.speed = schedule, slope, start
        self.master = SimpleNamespace(close=lambda: None)

    def revolve(self, steps):
        speeds = []
        for i in steps:
            x = self.speed - 1.3
            needed = 1.5 + self.slope * x + 20.0 * x**3
            self.speed += 0.1 * H * (self.schedule.voltage((i + 0.5) * H) - needed)
            speeds.append(self.speed)
        return {"speed": np.array(speeds)}

    def memory(self):
        return {"speed": np.array([self.speed])}

    def remember(self, table):
        self.speed = float(table["speed"][0])


def judged(slope, up=True, start=1.1, first=1.4):
    """The verdict on the whole ramp, from its beginning to its end."""
    schedule = Ramp(first, 1.6, 1e-4, back=False) if up else Ramp(1.6, first, 1e-4, back=False)
    steps = round(schedule.duration / H)
    holder = Holder(lambda other: Rotor(other, slope, start), schedule, H, 1.0, 1.0)
    passing = Passing(round(0.8 * steps), steps // 4, steps - 1, DOUBTFUL, 0.8 * steps)
    return holder.judge(passing, 0, 1.3, up)


@pytest.mark.parametrize(("up", "start"), [(True, 1.1), (False, 1.5)])
@pytest.mark.parametrize("slope", [-0.2, -0.05])
def test_a_fold(slope, up, start):
    """Where the derivative is 0: 1.5 plus or minus 2/3 |slope| x there."""
    x = (-slope / 60.0) ** 0.5
    fold = 1.5 - (1 if up else -1) * 2.0 / 3.0 * slope * x
    verdict = judged(slope, up, start)
    assert verdict.what == LOST
    assert sorted((verdict.low, verdict.high)) == pytest.approx([fold, fold], abs=5e-4)


@pytest.mark.parametrize("slope", [0.02, 0.1])
def test_a_steep_branch(slope):
    """Fifty times as steep as the voltage, but the speed comes back with it."""
    verdict = judged(slope)
    assert verdict.what == FOLLOWS and np.isnan(verdict.low)


def test_what_has_left_before():
    """The first state of the way is beyond already."""
    assert judged(-0.2, start=1.45, first=1.5).what == LEFT_BEFORE
