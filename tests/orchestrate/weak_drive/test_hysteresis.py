"""The hysteresis loop tells a motion that is lost from a steep branch, on a speed with a known fold."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrate.weak_drive.hysteresis import LOST, NONE, UNDECIDED, HysteresisLoop, Settings, HeldPoint
from orchestrate.weak_drive.schedule import Ramp

H = 5.0
STIFF = 20.0
COUNT=[0]

class Rotor:
    """A speed that follows eta0 = 1.5 + slope x + stiff x^3, x = speed - 1.3; a step a revolution."""

    def __init__(self, schedule, slope, start, stiff=STIFF):
        self.schedule, self.slope, self.speed = schedule, slope, start
        self.stiff = stiff
        self.master = SimpleNamespace(close=lambda: None)

    def revolve(self, steps):
        speeds = []
        for i in steps:
            x = self.speed - 1.3
            needed = 1.5 + self.slope * x + self.stiff * x**3
            self.speed += 0.02 * H * (self.schedule.voltage((i + 0.5) * H) - needed)
            speeds.append(self.speed)
        COUNT[0]+=len(speeds)
        return {"speed": np.array(speeds)}

    def get_state(self):
        return {"speed": np.array([self.speed])}

    def set_state(self, table):
        self.speed = float(table["speed"][0])


def decided(slope, up=True, start=1.1, first=1.4, longest=2e4, stiff=STIFF, last=1.6, at=0.3, **settings):
    """The jumps of a course from before a fold to past it."""
    ends = (first, last) if up else (last, first)
    loop = HysteresisLoop(lambda other: Rotor(other, slope, start, stiff), Ramp(*ends, 1e-4, back=False), H, 1.0, 1.0, longest, Settings(**settings))
    COUNT[0]=0
    first = loop.hold_step(round(at * (last-first) / 1e-4 / H))
    j= loop.jumps(first, ends[1])
    print(slope, up, COUNT[0]*H, j)
    return j

def fold_of(slope, up=True, stiff=STIFF):
    x = (-slope / 3.0 / stiff) ** 0.5
    return 1.5 - (1 if up else -1) * 2.0 / 3.0 * slope * x


@pytest.mark.parametrize(("up", "start"), [(True, 1.1), (False, 1.5)])
@pytest.mark.parametrize("slope", [-0.2, -0.05, -0.02])
def test_a_fold(slope, up, start):
    """It is bracketed; -0.02: the other one is 5e-4 away."""
    (jump,) = decided(slope, up=up, start=start)
    low, high = sorted((jump.low, jump.high))
    assert jump.outcome == LOST
    assert low - 5e-6 <= fold_of(slope, up) <= high + 5e-6 and high - low < 2e-4

NARROW = {"first": 1.47, "last": 1.53, "stiff": 2500.0}  # speeds change little between its folds

@pytest.mark.parametrize("at", [0.1, 0.2,0.25, 0.3,.35])
@pytest.mark.parametrize(("up", "start"), [(True, 1.27), (False, 1.33)])
def test_folds_that_are_close_in_speed_too(up, start, at):
    (jump,) = decided(-0.0365, up=up, start=start, at=at, **NARROW)
    low, high = sorted((jump.low, jump.high))
    assert jump.outcome == LOST
    fold = fold_of(-.0365,up,2500.)
    assert low - 5e-6 <= fold <= high + 5e-6 and high - low < 2e-4

@pytest.mark.parametrize("slope", np.linspace(-0.05, 0.03, 17).round(4).tolist())
def test_no_two_courses_contradict_each_other(slope):
    """What lies between a jump and none is undecided."""
    said = {tuple(j.outcome for j in decided(slope, start=1.27, at=at, **NARROW)) for at in (.1,.2,.25,.3)}
    print("SAID", slope, said)
    assert said <= {(LOST,), (UNDECIDED,)} or said <= {(), (UNDECIDED,)}
    assert said == {(LOST,)} or slope > -0.035
    assert said == {()} or slope < 0.005

@pytest.mark.parametrize("slope", [0.005, 0.02, 0.1])
def test_a_steep_branch(slope):
    assert decided(slope, longest=2e5) == []

@pytest.mark.parametrize("slope", [-0.02, -0.005, 0.0, 0.005])
@pytest.mark.parametrize("longest", [1500.0, 5000.0])
def test_a_short_hold_is_never_wrong(slope, longest):
    lost = fold_of(slope) - fold_of(slope, up=False) > 1e-4 if slope < 0.0 else False
    said = {j.outcome for j in decided(slope, longest=longest)}
    assert said <= ({LOST, UNDECIDED} if lost else {UNDECIDED})
    if lost: assert said
