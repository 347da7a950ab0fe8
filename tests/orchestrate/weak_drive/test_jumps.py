"""Jumps are where a branch ends; a speed that follows the voltage does not jump."""

import numpy as np
import pytest

from orchestrate.weak_drive import averaged

from .coupled import BEAM, QUICK
from .test_couple import run
from .validation import random_sets


def test_a_run_that_began_beyond_the_resonance():
    """The motor starts at the speed of the first voltage, on the upper branch, and stays there."""
    found = run(QUICK.as_bonded(), (1.45, 1.65), 4e-4, back=False, spin_up=0.0)
    assert np.isnan(found.jumps).all() and np.isnan(found.jump_speed_before).all()
    assert found.no_jump.values.tolist() == [
        "no jump: held voltages lead back to the same speeds",
        "the voltage does not fall",
    ]


def test_a_run_up_begins_below_the_resonance():
    """So the same voltages show the jump; late, as the rate has it."""
    found = run(QUICK.as_bonded(), (1.45, 1.65), 1e-4, back=False)
    up = found.sel(jump="up")
    assert up.jumps == pytest.approx(1.58310, abs=1.5e-4)
    assert up.ramp_voltage == pytest.approx(1.606, abs=1e-3)
    assert up.jump_lag == pytest.approx(float(up.ramp_voltage - up.jumps), abs=1e-9)
    assert up.jump_rate == pytest.approx(1e-4, rel=1e-2)
    assert up.jump_speed_before == pytest.approx(1.335, abs=1e-2)
    assert up.jump_speed_after == pytest.approx(1.58, abs=1e-2)
    assert up.jump_amplitude_before > 17.0 > 6.0 > up.jump_amplitude_after
    assert up.no_jump == ""


def test_the_beam_begins_below_too():
    """It was said to jump at once, at 1.403."""
    found = run(BEAM.as_bonded(), (1.4, 1.6), 5e-5, back=False)
    volts = BEAM.drive.volts(BEAM.structure)
    assert float(found.jumps[0]) / volts == pytest.approx(1.54187, abs=1.5e-4)
    assert float(found.ramp_voltage[0]) / volts == pytest.approx(1.5493, abs=2e-3)


def test_a_motor_without_folds():
    """A steep torque line: the speed goes through the resonance there and back."""
    resistance = QUICK.drive.armature_resistance / 20.0
    strong = QUICK._replace(drive=QUICK.drive.replace(armature_resistance=resistance))
    found = run(strong.as_bonded(), (1.25, 1.45), 4e-4)
    assert np.isnan(found.jumps).all() and np.isnan(found.averaged_jumps).all()
    assert all("no jump" in text for text in found.no_jump.values)


@pytest.mark.slow
def test_a_ramp_too_fast_to_tell():
    """The record shows no jump, the theory a fold: held voltages decide."""
    found = run(QUICK.as_bonded(), (1.5, 1.75), 2e-3, back=False, step=0.4)
    up = found.sel(jump="up")
    assert up.decided == "by held voltages" and up.no_jump == ""
    assert up.jumps == pytest.approx(1.58310, abs=1.5e-4)


def test_a_spin_up_that_ends_beyond_the_resonance():
    """Too fast a one, near the fold: no jump of the ramp that follows is made of it."""
    asked = {"settle": 150.0, "spin_up": 300.0, "back": False, "step": 0.4}
    found = run(BEAM.as_bonded(), (1.53, 1.55), 2e-5, **asked)
    assert found.speed.max() > 1.4 * BEAM.structure.omega
    assert np.isnan(found.jumps).all()


def test_what_the_averaged_theory_loses_first():
    """The upper branch of `beam` by a Neimark-Sacker point, that of `quick` by its fold."""
    beam, quick = (averaged.stability_limits(*one.as_bonded()) for one in (BEAM, QUICK))
    assert [place.kind for place in (*beam, *quick)] == ["fold", "Neimark-Sacker", "fold", "fold"]
    assert beam[1].eta0 == pytest.approx(1.3731, abs=1e-4)
    assert quick[1].eta0 == pytest.approx(1.43568, abs=1e-5)


@pytest.mark.slow
def test_a_steep_motor_with_folds():
    """A quick rotor follows the vibration: its inertia takes little torque, though it jumps."""
    stronger = {"b": (0.02, 0.5), "epsilon": (1e-4, 2e-3)}
    steep = random_sets(15, 17, stronger)[1].as_bonded()
    volts = steep.drive.volts(steep.structure)
    ends = averaged.folds(*steep)
    asked = {"speed_start": 1.3, "settle": 200.0, "step": None}
    found = run(steep, (1.40, 1.60), 1e-4, **asked)
    assert found.decided.values.tolist() == ["by held voltages"] * 2
    expected = [ends[0].eta0, ends[-1].eta0]
    assert found.jumps.values / volts == pytest.approx(expected, abs=5e-4)
