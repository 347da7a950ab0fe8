"""Saved states that somebody changed are refused by their checksum. With one that fits: refused, if
a number that indexes, counts or bounds a loop is out of its range, or an instance that runs (what
such a state can do to the kernels: ``tests/kernels/test_forged.py``).
"""

import hashlib
import math
import random
import struct

import pytest

from fmu_src.kernels.oscillator import memory as oscillator

from ..sparing import ordinary
from .driver import FORMS, MODELS, OSCILLATOR, path_of
from .programs.driver import Refused, open_fmu

HEAD, NUMBERS = 64, 3  # bytes before phase, start time and flags, which come before the memory
DRIVE = {"box_amplitude": 0.8, "box_frequency": 1.13}


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


@pytest.mark.parametrize("form", ordinary(FORMS))
@pytest.mark.parametrize(
    ("slot", "value", "words"),
    [
        (oscillator.K1, -1.0, "k1 = -1.0"),
        (oscillator.IMPACT_COUNT, 1e18, "impact_count = 1"),  # beyond FMI's integers
        (oscillator.X1, math.nan, "x1 = nan"),
        (oscillator.EVALUATION_LIMIT, 1e9, "evaluation_limit = 1000000000"),
        (oscillator.MODE, 7.0, "7.0 in slot"),
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
