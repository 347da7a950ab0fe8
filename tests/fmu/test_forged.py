"""Saved states that somebody changed are refused by their checksum. With one that fits: refused, if
a number that indexes, counts or bounds a loop is out of its range, or an instance that runs.

No forged state hangs, hands out what is no number, or has a derived constant read from it.
"""

import hashlib
import math
import random
import struct
import time

import pytest

from fmu_src.kernels.electrodynamic_shaker import memory as coil
from fmu_src.kernels.motor_shaker import memory as shaker
from fmu_src.kernels.oscillator import memory as oscillator

from ..sparing import ordinary
from .driver import FORMS, MODELS, OSCILLATOR, path_of
from .programs.driver import Refused, open_fmu

HEAD, NUMBERS = 64, 3  # bytes before phase, start time and flags, which come before the memory
NASTY = (math.nan, math.inf, -math.inf, -1.0, 0.5, 3.0, 5e-324, 2.0**53, 1e18, 1e300, -1e300)
PATIENCE = 2.0  # s
DRIVE = {"box_amplitude": 0.8, "box_frequency": 1.13}
RUNS = {  # settings, start time, and when to save
    OSCILLATOR: [  # flight and contact, chattering with its short flights, a cubic force, bonded
        (DRIVE, 0.0, [0.0, 3.3, 17.9, 60.0]),
        ({**DRIVE, "e": 0.3, "gamma": 1e-7, "k2": 1.9}, 0.0, [2.0, 2.6, 3.4, 4.0, 30.0]),
        ({"box_jerk": 0.02, "x2_start": 0.5, "sample_count": 3}, -5.0, [-4.0, 2.0]),
        ({**DRIVE, "bonded": True}, 0.0, [9.0]),
        ({**DRIVE, "e": 0.3, "clearance": -0.2}, 0.0, [0.0, 2.0, 3.4, 30.0]),
        ({**DRIVE, "clearance": 0.2}, 0.0, [0.0, 3.3, 17.9]),
    ],
    "MotorShaker": [({}, 0.0, [0.0, 0.02]), ({"armature_inductance": 0.01}, 3.0, [3.05])],
    "ElectrodynamicShaker": [  # free, held and clipped; voltage and current control
        ({"command": 3.0, "box_force_1": 5.0}, 0.0, [0.0, 0.3]),
        ({"command": 9.0, "coil_inductance": 0.02, "current_limit": 1.0}, -3.0, [-2.9, -2.0]),
        ({"command_1": 9.0, "voltage_limit": 5.0, "current_control": True}, 0.0, [0.2, 1.0]),
    ],
}
# variables that somebody may set are not forged into what they may be: the head, outputs, the rest
SLOTS = {
    OSCILLATOR: [
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
    OSCILLATOR: (oscillator.OMEGA, oscillator.SEGMENT_INPUTS),
    "MotorShaker": (shaker.UNBALANCE, shaker.UNBALANCE + 1),
    "ElectrodynamicShaker": (coil.VOLTAGE_SPACING, coil.BEGIN),
}


def sealed(data):
    """A native FMU's state, or one by pythonfmu, with the checksum that belongs to its content."""
    if data[HEAD - 8 : HEAD] != bytes(8):
        head = data[: HEAD - 8]
        return head + hashlib.sha256(head + data[HEAD:]).digest()[:8] + data[HEAD:]
    checksum = 0xCBF29CE484222325
    for byte in data[:-8]:
        checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
    return data[:-8] + struct.pack("<Q", checksum)


def forged(data, slot, value):
    """A state with another number in a slot of the memory; slots below 0 are the head's."""
    place = HEAD + 8 * (NUMBERS + slot)
    return sealed(data[:place] + struct.pack("<d", value) + data[place + 8 :])


def run_on(f, begun):
    """Outputs now and after two steps."""
    return [f.outputs(), *(f.step(begun + more).outputs() for more in (0.1, 3.0))]


def sane(values):
    """Whether outputs are numbers, and the masses apart or together."""
    finite = all(math.isfinite(value) for value in values.values())
    return finite and values.get("x_rel", 0.0) >= 0.0


def problem_of(f, data, begun, slot, value, derived):
    """What is wrong about what an FMU makes of a forged state; empty where nothing is."""
    clock, found = time.process_time(), None
    f.reset()
    try:
        found = run_on(f.restore(forged(data, slot, value), begun), begun)
    except Refused as refused:
        # pythonfmu puts a line of its own before an exception
        if not refused.messages or refused.messages[-1].count("\n") > 1:
            return f"refused with {refused.messages}"
    if time.process_time() - clock > PATIENCE:
        return f"took {time.process_time() - clock:.1f} s"
    if found and not all(map(sane, found)):
        return "handed out what is no number, or x_rel < 0"
    if found and derived[0] <= slot < derived[1]:
        f.reset()
        if found != run_on(f.restore(data, begun), begun):
            return "a derived constant was read"
    return ""


def forge(model, form, share):
    """Forge slots with nasty values, a share of all pairs drawn at random; returns how many were
    tried, and what was wrong.
    """
    path, draw, tried, problems = path_of(model, form), random.Random(1), 0, []
    f = open_fmu(path).start()
    for settings, start, times in RUNS[model]:
        saver = open_fmu(path).start(start, **settings)
        for data, begun in (saver.step(when).save() for when in times):
            for slot in (slot for first, last in SLOTS[model] for slot in range(first, last)):
                own = struct.unpack_from("<d", data, HEAD + 8 * (NUMBERS + slot))[0]
                for value in (*NASTY, -own, own * 1.01, own + 1.0):
                    if draw.random() >= share:
                        continue
                    tried += 1
                    wrong = problem_of(f, data, begun, slot, value, DERIVED[model])
                    if wrong:
                        problems.append(f"slot {slot} = {value} (was {own}): {wrong}")
    return tried, problems


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("model", MODELS)
def test_some_forged_states(form, model):
    tried, problems = forge(model, form, 0.0015 if model == OSCILLATOR else 0.006)
    assert tried > 20
    assert problems == []


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("model", MODELS)
def test_every_slot_forged(form, model):
    tried, problems = forge(model, form, 1.0)
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
        (oscillator.X1, math.nan, "x1 = nan"),
        (oscillator.EVALUATIONS, -1.0, "evaluations = -1"),
        (oscillator.EVALUATION_LIMIT, 0.0, "evaluation_limit = 0"),
        (oscillator.EVALUATION_LIMIT, 1e9, "evaluation_limit = 1000000000"),
        (oscillator.MODE, 7.0, "7.0 in slot"),
        (oscillator.SERIES, 1e6, "1000000.0 in slot"),
        (oscillator.END, -1.0, "-1.0 in slot"),
        (oscillator.BEGIN, math.nan, "nan in slot"),
        (oscillator.ORIGIN, -1e300, "too long"),  # more oscillations than can be counted
    ],
)
def test_the_message_says_what_is_wrong(form, slot, value, words):
    f = open_fmu(path_of(OSCILLATOR, form)).start(**DRIVE).step(3.3)
    data, begun = f.save()
    with pytest.raises(Refused) as refused:
        f.restore(forged(data, slot, value), begun)
    told = refused.value.messages[-1]
    assert words in told and "a saved state that this FMU never had" in told


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("model", MODELS)
def test_a_damaged_state_is_refused_by_its_checksum(form, model):
    """Any bit, the checksum's too; a state that was cut; one of another model of the same form."""
    f, draw = open_fmu(path_of(model, form)).start(), random.Random(1)
    data, begun = f.save()
    other = MODELS[(MODELS.index(model) + 1) % len(MODELS)]
    damaged = [data[:-8], data + bytes(8), b"", open_fmu(path_of(other, form)).start().save()[0]]
    for place in (0, HEAD - 1, HEAD, len(data) - 1, *draw.sample(range(len(data)), 40)):
        bit = bytes([data[place] ^ 1 << draw.randrange(8)])
        damaged.append(data[:place] + bit + data[place + 1 :])
    for changed in damaged:
        with pytest.raises(Refused) as refused:
            f.restore(changed, begun)
        message = refused.value.messages[-1]
        assert "expected a state saved by this FMU" in message and "undamaged" in message
    f.restore(data, begun)
