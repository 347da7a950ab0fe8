"""Jumps are where a branch ends; a speed that follows the voltage does not jump."""

import numpy as np
import pytest

from orchestrate.weak_drive import averaged

from .coupled import BEAM, QUICK
from .test_couple import run


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_motor_without_folds():
    """A steep torque line: the speed goes through the resonance there and back."""
    resistance = QUICK.drive.armature_resistance / 20.0
    strong = QUICK._replace(drive=QUICK.drive.replace(armature_resistance=resistance))
    found = run(strong.as_bonded(), (1.25, 1.45), 4e-4)
    assert np.isnan(found.jumps).all() and np.isnan(found.averaged_jumps).all()
    assert all("no jump" in text for text in found.no_jump.values)


@pytest.mark.slow
def test_a_spin_up_that_ends_beyond_the_resonance():
    """Too fast a one, near the fold: no jump of the ramp that follows is made of it."""
    asked = {"settle": 150.0, "spin_up": 300.0, "back": False, "step": 0.4}
    found = run(BEAM.as_bonded(), (1.53, 1.55), 2e-5, **asked)
    assert found.speed.max() > 1.4 * BEAM.structure.omega
    assert np.isnan(found.jumps).all()


def test_what_the_averaged_theory_loses_first():
    """The upper branch of `beam`: a Neimark-Sacker point before its fold."""
    limits = averaged.stability_limits(*BEAM.as_bonded())
    assert [place.kind for place in limits] == ["fold", "Neimark-Sacker"]
    assert limits[1].eta0 == pytest.approx(1.3731, abs=1e-4)
