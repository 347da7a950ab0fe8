"""Controllers: against a simulation and a law of their own; how a machine gets across."""

import math

import numpy as np
import pytest

from orchestrate import InputError, SpeedControl, SpeedGradient, couple, passage

from . import bonded
from .coupled import BEAM, QUICK

WEAK = BEAM._replace(drive=BEAM.drive.replace(armature_resistance=120.0))  # a weak motor
SWING = SpeedGradient(filter_time=0.4, passed=101.0, low=0.6)


class Pi:
    """A PI law of the test's own: velocity form, the integral kept while it is limited."""

    def __init__(self, target, gain, reset_time, limit, h):
        self.target, self.gain, self.reset, self.limit, self.h = target, gain, reset_time, limit, h
        self.sum = 0.0

    def __call__(self, time, speed):
        missing = self.target - speed
        self.sum += missing * self.h
        wanted = self.gain * missing + self.gain / self.reset * self.sum
        if wanted > self.limit and missing > 0.0 or wanted < 0.0 and missing < 0.0:
            self.sum -= missing * self.h
        return min(max(wanted, 0.0), self.limit)


class Swing:
    """On while the speed is above its running mean, low otherwise."""

    def __init__(self, control, limit, h):
        self.control, self.limit, self.mean = control, limit, 0.0
        self.share = 1.0 - math.exp(-h / control.filter_time)

    def __call__(self, time, speed):
        self.mean += self.share * (speed - self.mean)
        on = self.mean > self.control.passed or speed >= self.mean
        return self.limit if on else self.limit * self.control.low


def agrees(system, control, law, voltage, time):
    """A run of both FMUs has the voltages and speeds of the plain simulation."""
    h = 0.1 / system.structure.omega
    found = passage(
        *system, voltage=voltage, duration=time, control=control, step=h, progress=False
    )
    speeds, voltages = bonded.run(system, law, h, found.sizes["time"], parts=2)
    assert (np.abs(found.voltage - voltages) < 1e-3 * voltage).mean() > 0.999
    assert found.speed.values == pytest.approx(np.array(speeds), abs=2e-4 * max(speeds))
    return found


def test_speed_control():
    h = 0.1
    control = SpeedControl(speed=1.5, gain=5.0, reset_time=50.0)
    found = agrees(QUICK.as_bonded(), control, Pi(1.5, 5.0, 50.0, 1.8, h), 1.8, 300.0)
    assert float(found.voltage.min()) >= 0.0 and float(found.voltage.max()) == 1.8
    assert float(found.passage_time) < 150.0
    assert found.speed[-200:].mean() == pytest.approx(1.5, abs=2e-3)


@pytest.mark.slow
def test_speed_gradient():
    law = Swing(SWING, 8.73, 0.1 / 75.0)
    found = agrees(WEAK.as_bonded(), SWING, law, 8.73, 6.0)
    assert set(np.unique(found.voltage.values.round(9))) == {5.238, 8.73}


@pytest.mark.slow
def test_speed_control_may_hang_where_the_source_passes():
    """Near the speed that is wanted it gives less than the source, and the rotor its momentum."""
    quick, asked = QUICK.as_bonded(), {"voltage": 1.5465, "duration": 500.0, "progress": False}
    control = SpeedControl(speed=1.5, gain=1.0, reset_time=50.0)
    alone = couple(*quick, speed_start=0.0, **asked)
    held = couple(*quick, control=control, **asked)
    assert float(alone.passage_time) < 300.0 and alone.speed[-50:].mean() > 1.5
    assert np.isnan(held.passage_time) and held.speed[-50:].mean() < 1.3
    assert held.voltage[-50:].min() == 1.5465  # it gives all there is again: too late


def test_a_machine_that_is_captured_gets_across():
    """Switched on at once the motor hangs at the resonance; swung, it passes."""
    asked = {"voltage": 8.73, "duration": 5.0, "progress": False}
    at_once = couple(*WEAK, speed_start=0.0, **asked)
    swung = couple(*WEAK, control=SWING, **asked)
    assert np.isnan(at_once.passage_time) and at_once.speed[-1] < 101.0
    assert float(swung.passage_time) < 4.0 and swung.speed[-1] > 120.0
    assert swung.no_jump.values.tolist() == ["a controller sets the voltage"] * 2


@pytest.mark.parametrize(
    ("make", "parts"),
    [
        (lambda: SpeedControl(speed=math.nan, gain=1.0), ["speed = nan", "finite"]),
        (lambda: SpeedControl(speed=1.0, gain=0.0), ["gain = 0.0 V.s/rad", "0 < gain"]),
        (lambda: SpeedControl(speed=1.0, gain="1"), ["gain = 1", "0 < gain"]),
        (lambda: SpeedControl(speed=1.0, gain=1.0, reset_time=0.0), ["0 < reset_time"]),
        (lambda: SpeedControl(speed=1.0, gain=1.0, rise=-1.0), ["0 < rise"]),
        (lambda: SpeedGradient(filter_time=-1.0, passed=1.0), ["0 < filter_time"]),
        (lambda: SpeedGradient(filter_time=1.0, passed=0.0), ["0 < passed"]),
        (lambda: SpeedGradient(filter_time=1.0, passed=1.0, low=1.5), ["0 <= low <= 1"]),
        (
            lambda: couple(*QUICK, voltage=1.5, duration=1.0, control="pi"),
            ["control = 'pi'", "SpeedControl(...)"],
        ),
    ],
)
def test_mistakes(make, parts):
    with pytest.raises(InputError) as caught:
        make()
    assert all(part in str(caught.value) for part in parts), str(caught.value)
