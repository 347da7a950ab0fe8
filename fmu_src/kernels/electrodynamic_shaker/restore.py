"""A saved state that came from outside, made whole again.

Its checksum says that it was not damaged, not who made it. What is integrated can be anything
finite; all that follows from it or from the parameters is computed anew.
"""

import math

from . import memory as at
from .motion import begin_interval, begin_state, local_time, renew_inputs
from .outputs import check_finite, write_outputs
from .stepper import derive

LONGEST = 9007199254740992.0  # 2**53: intervals that can be counted


def refuse_slot(m, slot, complaint):
    """Record which slot is wrong, and why, and return FORGED."""
    m[at.TARGET] = m[slot]
    m[at.WORK] = slot
    m[at.REPORT] = complaint
    return at.FORGED


def restore(m, time):
    """Check a memory that was read, and compute what follows from other numbers; it began at
    ``time`` (s).

    The variables have been checked against their ranges. Outputs are those for the inputs as they
    are.

    Returns
    -------
    int
        OK, or FORGED with what is wrong in WORK, TARGET and REPORT, or another code of
        :mod:`.memory`.
    """
    for i in range(at.SPACING, at.COMMAND_SET):
        m[i] = 0.0
    for i in range(at.WORK, at.SIZE):
        m[i] = 0.0
    for i in range(at.SIZE):
        if m[i] - m[i] != 0.0:
            return refuse_slot(m, i, at.NOT_A_NUMBER)
    code = check_flags(m)
    if code == at.OK:
        code = check_times(m, time)
    if code != at.OK:
        return code
    code = derive(m)
    if code != at.OK:
        return code
    if m[at.INTERVAL] == 0.0:
        begin_state(m)
    else:
        code = check_sides(m)
        if code != at.OK:
            return code
        begin_interval(m)
    begun, local = m[at.INTERVAL] * m[at.SPACING], local_time(m, m[at.TIME])
    if not begun <= local < begun + m[at.SPACING]:
        return refuse_slot(m, at.INTERVAL, at.NO_COUNT)
    if m[at.EVENT_KIND] != at.NO_EVENT and begun + m[at.EVENT] * m[at.SPACING] < local:
        return refuse_slot(m, at.INTERVAL, at.NO_COUNT)
    renew_inputs(m)
    write_outputs(m)
    return check_finite(m)


def check_flags(m):
    """Return OK, or FORGED where a flag is none."""
    for i in range(at.FOLLOWED, at.OTHER_LOWEST + 1):
        if m[i] != 0.0 and m[i] != 1.0:
            return refuse_slot(m, i, at.NO_FLAG)
    for i in range(at.COMMAND_SET, at.FORCE_SET + 1):
        if m[i] != 0.0 and m[i] != 1.0:
            return refuse_slot(m, i, at.NO_FLAG)
    return at.OK


def check_times(m, time):
    """Return OK, or FORGED where a time or a count does not fit the others."""
    now = m[at.TIME]
    if now < time:
        return refuse_slot(m, at.TIME, at.NO_TIME)
    if not time <= m[at.COMMAND_TIME] <= now:
        return refuse_slot(m, at.COMMAND_TIME, at.NO_TIME)
    if not time <= m[at.FORCE_TIME] <= now:
        return refuse_slot(m, at.FORCE_TIME, at.NO_TIME)
    close = 1e-15 * (abs(m[at.ORIGIN]) + abs(time))
    if not time - close <= m[at.ORIGIN] <= now + close:
        return refuse_slot(m, at.ORIGIN, at.NO_TIME)
    if abs(m[at.ORIGIN_LOW]) > close:
        return refuse_slot(m, at.ORIGIN_LOW, at.NO_TIME)
    number = m[at.INTERVAL]
    if not 0.0 <= number < LONGEST or number != math.floor(number):
        return refuse_slot(m, at.INTERVAL, at.NO_COUNT)
    return at.OK


def check_sides(m):
    """Return OK, or FORGED where what the amplifier does cannot be."""
    if not is_side(m[at.CLIPPED], m[at.COMMAND_LIMIT]):
        return refuse_slot(m, at.CLIPPED, at.NO_SIDE)
    if abs(m[at.COMMAND_SIDE]) != 1.0:
        return refuse_slot(m, at.COMMAND_SIDE, at.NO_SIDE)
    if not is_side(m[at.HELD], m[at.OTHER_LIMIT]):
        return refuse_slot(m, at.HELD, at.NO_SIDE)
    if abs(m[at.OTHER_SIDE]) != 1.0:
        return refuse_slot(m, at.OTHER_SIDE, at.NO_SIDE)
    return at.OK


def is_side(side, limit):
    """Return whether a side can be the one of a limit that acts, or 0."""
    return side == 0.0 or (abs(side) == 1.0 and limit > 0.0)
