"""States of which numbers were changed and the checksum made anew."""

import hashlib
import math
import random
import struct
import time

from driver import Refused, open_fmu

HEAD, NUMBERS = 64, 3  # bytes before phase, start time and flags, which come before the memory
NASTY = (math.nan, math.inf, -math.inf, -1.0, 0.5, 3.0, 5e-324, 2.0**53, 1e18, 1e300, -1e300)
PATIENCE = 2.0  # s


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


def number(data, slot):
    """The number in a slot."""
    return struct.unpack_from("<d", data, HEAD + 8 * (NUMBERS + slot))[0]


def sane(values):
    """Whether outputs are numbers, and the masses apart or together."""
    finite = all(math.isfinite(value) for value in values.values())
    return finite and values.get("x_rel", 0.0) >= 0.0


def run_on(f, begun):
    """Outputs now and after two steps; None where one of the calls was refused."""
    now = f.outputs()
    later = [f.step(begun + more).outputs() for more in (0.1, 3.0)]
    return [now, *later]


def saved_states(path, runs):
    """States on the way of runs: settings, start time, and when to save."""
    for settings, start, times in runs:
        f = open_fmu(path).start(start, **settings)
        for when in times:
            yield f.step(when).save()
        f.free()


def problem_of(f, data, begun, slot, value, derived):
    """What is wrong about what an FMU makes of a forged state; empty where nothing is."""
    clock = time.process_time()
    f.reset()
    try:
        f.restore(forged(data, slot, value), begun)
        found = run_on(f, begun)
    except Refused as refused:
        found = None
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


def campaign(path, runs, slots, derived, share, seed):
    """Forge slots of states with nasty values, a share of all pairs of both drawn at random.

    Parameters
    ----------
    path : str
    runs : list
        See :func:`saved_states`.
    slots : list
        First and one past the last of each stretch of slots to forge.
    derived : list
        The same, of constants that are not to be read from a state.
    share : float
    seed : int

    Returns
    -------
    tried : int
    taken : int
    problems : list of str
    """
    draw, tried, problems = random.Random(seed), 0, []
    for data, begun in saved_states(path, runs):
        f = open_fmu(path)
        f.start()
        for slot in (slot for first, last in slots for slot in range(first, last)):
            own = number(data, slot)
            for value in (*NASTY, -own, own * 1.01, own + 1.0):
                if draw.random() >= share:
                    continue
                tried += 1
                wrong = problem_of(f, data, begun, slot, value, derived)
                if wrong:
                    problems.append(f"slot {slot} = {value} (was {own}): {wrong}")
        f.free()
    return tried, problems


def message(path, settings, when, slot, value):
    """What is said of a forged state."""
    data, begun = open_fmu(path).start(**settings).step(when).save()
    f = open_fmu(path)
    f.start()
    try:
        f.restore(forged(data, slot, value), begun)
    except Refused as refused:
        return refused.messages[-1]
    return ""
