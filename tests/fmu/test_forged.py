"""Saved states that somebody changed, with a checksum that fits: refused, or an instance that runs.

No forged state hangs, hands out what is no number, or has a derived constant read from it.
"""

import pytest

from fmu_src.kernels.electrodynamic_shaker import memory as coil
from fmu_src.kernels.oscillator import memory as oscillator
from fmu_src.kernels.shaker import memory as shaker

from ..sparing import ordinary
from .driver import BUILD, FORMS, run

DRIVE = {"box_amplitude": 0.8, "box_frequency": 1.13}
OSCILLATOR = [  # flight and contact, chattering with its short flights, a cubic force, bonded
    (DRIVE, 0.0, [0.0, 3.3, 17.9, 60.0]),
    ({**DRIVE, "e": 0.3, "gamma": 1e-7, "k2": 1.9}, 0.0, [2.0, 2.6, 3.4, 4.0, 30.0]),
    ({"box_jerk": 0.02, "x2_start": 0.5, "sample_count": 3}, -5.0, [-4.0, 2.0]),
    ({**DRIVE, "bonded": True}, 0.0, [9.0]),
    ({**DRIVE, "e": 0.3, "clearance": -0.2}, 0.0, [0.0, 2.0, 3.4, 30.0]),
    ({**DRIVE, "clearance": 0.2}, 0.0, [0.0, 3.3, 17.9]),
]
SHAKER = [({}, 0.0, [0.0, 0.02]), ({"armature_inductance": 0.01}, 3.0, [3.05])]
COIL = [  # free, held and clipped; voltage and current control
    ({"command": 3.0, "box_force_1": 5.0}, 0.0, [0.0, 0.3]),
    ({"command": 9.0, "coil_inductance": 0.02, "current_limit": 1.0}, -3.0, [-2.9, -2.0]),
    ({"command_1": 9.0, "voltage_limit": 5.0, "current_control": True}, 0.0, [0.2, 1.0]),
]
# variables that somebody may set are not forged into what they may be: the head, outputs, the rest
SLOTS = {
    "TwoMassImpactOscillator": [
        (-3, 0),
        (oscillator.X1, oscillator.X1_SAMPLE + 2),
        (oscillator.EVALUATIONS, oscillator.EVALUATION_LIMIT + 1),
        (oscillator.TIME, oscillator.SIZE),
    ],
    "MotorShaker": [(-3, 0), (shaker.BOX_POSITION, shaker.SIZE)],
    "ElectrodynamicShaker": [
        (-3, 0),
        (coil.BOX_POSITION, coil.SPEED_SERIES + 2),
        (coil.EVENT, coil.SIZE),
    ],
}
DERIVED = {
    "TwoMassImpactOscillator": (oscillator.OMEGA, oscillator.SEGMENT_INPUTS),
    "MotorShaker": (shaker.UNBALANCE, shaker.UNBALANCE + 1),
    "ElectrodynamicShaker": (coil.VOLTAGE_SPACING, coil.BEGIN),
}
RUNS = {
    "TwoMassImpactOscillator": OSCILLATOR,
    "MotorShaker": SHAKER,
    "ElectrodynamicShaker": COIL,
}


def campaign(form, model, share, seed, cwd):
    """Forged states that were tried, and what was wrong about what the FMU made of them."""
    path = BUILD / form / f"{model}.fmu"
    asked = (RUNS[model], SLOTS[model], DERIVED[model], share, seed)
    return run("forged.campaign", path, *asked, cwd=cwd, timeout=1500)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("model", RUNS)
def test_some_forged_states(form, model, tmp_path):
    tried, problems = campaign(form, model, 0.01, 1, tmp_path)
    assert tried > 20
    assert problems == []


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("model", RUNS)
def test_every_slot_forged(form, model, tmp_path):
    tried, problems = campaign(form, model, 1.0, 1, tmp_path)
    assert tried > 1000
    assert problems == []


@pytest.mark.parametrize("form", ordinary(FORMS))
@pytest.mark.parametrize(
    ("slot", "value", "words"),
    [
        (oscillator.K1, -1.0, "k1 = -1.0"),
        (oscillator.BONDED, 0.5, "bonded = 0.5"),
        (oscillator.IMPACT_COUNT, 0.5, "impact_count = 0.5"),
        (oscillator.IMPACT_COUNT, 1e18, "impact_count = 1"),  # beyond FMI's integers
        (oscillator.X1, float("nan"), "x1 = nan"),
        (oscillator.EVALUATIONS, -1.0, "evaluations = -1"),
        (oscillator.EVALUATION_LIMIT, 0.0, "evaluation_limit = 0"),
        (oscillator.EVALUATION_LIMIT, 1e9, "evaluation_limit = 1000000000"),
        (oscillator.MODE, 7.0, "7.0 in slot"),
        (oscillator.MODE, 7.0, "0 in flight, 1 in permanent contact, 2 where bonded"),
        (oscillator.SERIES, 1e6, "0, or 8 or 12 in a short flight"),
        (oscillator.BEGIN + 2, -1e3, "expected x_rel = x2 - x1 + clearance >= 0"),
        (oscillator.END, -1.0, "a state begins before the communication point"),
    ],
)
def test_the_message_says_what_is_wrong(form, slot, value, words, tmp_path):
    path = BUILD / form / "TwoMassImpactOscillator.fmu"
    told = run("forged.message", path, DRIVE, 3.3, slot, value, cwd=tmp_path)
    assert words in told
    assert "a saved state that this FMU never had" in told
