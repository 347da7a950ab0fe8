"""Controllers: against a simulation and a law of their own; how a machine gets across."""

import math

import numpy as np
import pytest

from orchestrate import SpeedControl, SpeedGradient, passage

from .coupled import BEAM, QUICK
from .monolithic import Monolith

WEAK = BEAM._replace(drive=BEAM.drive.replace(armature_resistance=120.0))  # a weak motor
SWING = SpeedGradient(filter_time=0.4, passed=101.0, low=0.6)


def pi_law(target, gain, reset_time, limit, h):
    """A PI law of the test's own: velocity form, the integral kept while it is limited."""
    total = 0.0

    def law(time, speed):
        nonlocal total
        missing = target - speed
        total += missing * h
        wanted = gain * missing + gain / reset_time * total
        if wanted > limit and missing > 0.0 or wanted < 0.0 and missing < 0.0:
            total -= missing * h
        return min(max(wanted, 0.0), limit)

    return law


def swing_law(control, limit, h):
    """On while the speed is above its running mean, low otherwise."""
    mean = 0.0

    def law(time, speed):
        nonlocal mean
        mean += (1.0 - math.exp(-h / control.filter_time)) * (speed - mean)
        on = mean > control.passed or speed >= mean
        return limit if on else limit * control.low

    return law


CONTROL = SpeedControl(speed=1.5, gain=5.0, reset_time=50.0)
RUNS = [
    (QUICK, CONTROL, pi_law(1.5, 5.0, 50.0, 1.8, 0.1), 1.8, 300.0),
    (WEAK, SWING, swing_law(SWING, 8.73, 0.1 / 75.0), 8.73, 3.0),
]


@pytest.mark.parametrize(("system", "control", "law", "volts", "time"), RUNS, ids=["PI", "swing"])
def test_a_run_has_the_voltages_and_speeds_of_the_plain_simulation(
    system, control, law, volts, time
):
    system, h = system.as_bonded(), 0.1 / system.structure.omega
    run = {"duration": time, "control": control, "step": h, "progress": False}
    found = passage(*system, voltage=volts, **run)
    speeds, voltages = Monolith(*system, volts).bonded_run(law, h, found.sizes["time"])
    assert (np.abs(found.voltage - voltages) < 1e-3 * volts).mean() > 0.999
    assert found.speed.values == pytest.approx(speeds, abs=2e-4 * max(speeds))
    if control is CONTROL:
        assert (found.voltage.min() >= 0.0) and found.voltage.max() == 1.8
        assert float(found.passage_time) < 150.0
        assert found.speed[-200:].mean() == pytest.approx(1.5, abs=2e-3)
