"""Jumps are where a branch ends; a speed that follows the voltage does not jump."""

import numpy as np
import pytest

from orchestrate.weak_drive.jumps import Way, find_jump

from .coupled import BEAM, QUICK
from .test_couple import run


def test_a_run_that_began_beyond_the_resonance():
    """The motor starts at the speed of the first voltage, on the upper branch, and stays there."""
    found = run(QUICK.as_bonded(), (1.45, 1.65), 4e-4, back=False, spin_up=0.0)
    assert np.isnan(found.jumps).all() and np.isnan(found.jump_speed_before).all()
    assert found.no_jump.values.tolist() == [
        "began beyond the resonance",
        "the voltage does not fall",
    ]


def test_a_run_up_begins_below_the_resonance():
    """So the same voltages show the jump; late, as the rate has it."""
    found = run(QUICK.as_bonded(), (1.45, 1.65), 1e-4, back=False)
    up = found.sel(jump="up")
    assert up.jumps == pytest.approx(1.606, abs=1e-3)
    assert up.jump_lag == pytest.approx(float(up.jumps) - 1.58306, abs=1e-5)
    assert up.jump_rate == pytest.approx(1e-4, rel=1e-3)
    assert up.jump_speed_before == pytest.approx(1.315, abs=5e-3)
    assert up.jump_speed_after == pytest.approx(1.602, abs=5e-3)
    assert up.jump_amplitude_before > 19.0 > 4.0 > up.jump_amplitude_after
    assert up.no_jump == ""


def test_the_beam_begins_below_too():
    """It was said to jump at once, at 1.403."""
    found = run(BEAM.as_bonded(), (1.4, 1.6), 5e-5, back=False)
    assert found.jumps[0] / BEAM.drive.volts(BEAM.structure) == pytest.approx(1.5493, abs=1e-3)


def test_a_motor_without_folds():
    """A steep torque line: the speed goes through the resonance there and back."""
    resistance = QUICK.drive.armature_resistance / 20.0
    strong = QUICK._replace(drive=QUICK.drive.replace(armature_resistance=resistance))
    found = run(strong.as_bonded(), (1.25, 1.45), 4e-4)
    assert np.isnan(found.jumps).all() and np.isnan(found.averaged_jumps).all()
    assert all("no fold" in text for text in found.no_jump.values)


def test_a_ramp_too_fast_to_tell():
    """There is a fold, so it is not said that there is none."""
    found = run(QUICK.as_bonded(), (1.26, 1.75), 2e-3, back=False)
    assert np.isnan(found.jumps[0]) and found.averaged_jumps[0] > 1.58
    assert "not told from a steep branch" in str(found.no_jump.values[0])


def way(speed, rate):
    """A ramp from 1.2 to 1.6 and the speed over its voltage, a revolution each 5/omega."""
    time = np.arange(0.0, 0.4 / rate, 5.0)
    eta0 = 1.2 + rate * time
    return Way(time, eta0, speed(eta0, time))


@pytest.mark.parametrize("rate", [1e-4, 1e-5])
def test_a_fast_change_is_a_jump_at_every_rate(rate):
    """Slip grows to the fold at 1.5, where the rotor is set free."""

    def speed(eta0, time):
        free = np.maximum(time - 0.3 / rate, 0.0)
        return eta0 - 0.6 * (eta0 - 1.2) * np.exp(-0.02 * free)

    jump = find_jump(way(speed, rate), 0.02, up=True)
    assert way(speed, rate).eta0[jump.row] == pytest.approx(1.5 + 35.0 * rate, abs=10 * rate)


@pytest.mark.parametrize("rate", [3e-5, 1e-5])
def test_a_steep_branch_is_no_jump(rate):
    """Five times as steep as the voltage, but in the ramp's own time."""

    def speed(eta0, time):
        return eta0 - 0.6 * np.clip(eta0 - 1.2, 0.0, 0.3) + np.clip(4.0 * (eta0 - 1.5), 0.0, 0.18)

    assert find_jump(way(speed, rate), 0.02, up=True) is None


def test_steps_of_the_voltage_are_no_jumps():
    """The speed follows each step in the rotor's own time, but no further than the step."""
    time = np.arange(0.0, 4000.0, 5.0)
    count, since = np.floor(time / 200.0), time % 200.0
    speed = 1.2 + 0.02 * (count - np.exp(-0.02 * since))
    assert find_jump(Way(time, 1.2 + 0.02 * count, speed), 0.02, up=True) is None
