"""Which limits act: the commanded quantity is clipped, the other one is held at its limit.

A voltage amplifier clips its command at the voltage limit; where the current then would exceed its
own limit, it is held there, by whatever voltage that takes. A current amplifier clips its command
at the current limit; where the current then would take more than the voltage limit, the voltage is
held there, and the current is what it makes of it. Held is what the source would drive beyond the
limit: it is decided by the first term that does not vanish of the *balance*, the source minus what
holding takes. Its terms are those of a prescribed current in both cases.
"""

from . import memory as at
from .inputs import write_input_series, write_source_series
from .series import write_constant_series, write_motion_and_voltage_series, write_source_into

SAME = 1e-12  # relative: a current so near to a new command has no way to go


def decide_active_limits(m):
    """Decide which limits act from the present state's beginning on."""
    h = m[at.CURRENT_SPACING]
    m[at.CLIPPED] = 0.0
    write_input_series(m, h)
    decide_clipping(m)
    write_source_series(m)
    m[at.HELD] = 0.0
    m[at.OTHER_SIDE] = 1.0
    m[at.OTHER_ORDER] = 0.0
    if m[at.CURRENT_CONTROL] != 0.0:
        decide_voltage_limit(m, h)
    elif m[at.OTHER_LIMIT] > 0.0:
        decide_current_limit(m, h)


def first_nonzero_guard_term(m, lowest):
    """Return the number of GUARD's first term from ``lowest`` on that is not zero, else TERMS."""
    order = int(lowest)
    while order < at.TERMS and m[at.GUARD + order] == 0.0:
        order += 1
    return order


def decide_clipping(m):
    limit = m[at.COMMAND_LIMIT]
    side = 1.0 if m[at.COMMAND_SERIES] >= 0.0 else -1.0
    m[at.COMMAND_SIDE] = side
    m[at.COMMAND_ORDER] = 0.0
    if limit == 0.0:
        return
    write_guard(m, at.COMMAND_SERIES, at.CUBIC, side, -limit)
    order = first_nonzero_guard_term(m, m[at.COMMAND_LOWEST])
    m[at.COMMAND_ORDER] = order
    if order < at.TERMS and m[at.GUARD + order] > 0.0:
        m[at.CLIPPED] = side


def write_guard(m, series, terms, factor, constant):
    """Write ``factor`` times a series, plus a constant, into GUARD."""
    for k in range(at.TERMS):
        m[at.GUARD + k] = factor * m[series + k] if k < terms else 0.0
    m[at.GUARD] += constant


def write_balance(m, series, side):
    """Write the source minus a series, on a side, into GUARD."""
    write_guard(m, series, at.TERMS, -side, 0.0)
    for k in range(at.CUBIC):
        m[at.GUARD + k] += side * m[at.SOURCE_SERIES + k]


def decide_current_limit(m, h):
    """Decide whether the current of a voltage amplifier is held at its limit."""
    limit, lags = m[at.OTHER_LIMIT], m[at.COIL_INDUCTANCE] > 0.0
    current = m[at.STATE + at.COIL_CURRENT]
    if not lags:
        induced = m[at.FORCE_FACTOR] * m[at.STATE + at.VELOCITY]
        current = (m[at.SOURCE_SERIES] - induced) / m[at.COIL_RESISTANCE]
    side = 1.0 if current >= 0.0 else -1.0
    m[at.OTHER_SIDE] = side
    if lags and side * current < limit:
        return
    m[at.STATE + at.COIL_CURRENT] = side * limit
    write_constant_series(m, at.CURRENT_SERIES, side * limit)
    write_motion_and_voltage_series(m, h)
    write_balance(m, at.VOLTAGE_SERIES, side)
    decide_held_by_guard(m, side, lags)


def decide_voltage_limit(m, h):
    """Decide whether the voltage of a current amplifier is held at its limit.

    A current that is not the command's is on its way there; without a voltage limit it jumps.
    """
    limit, lags = m[at.OTHER_LIMIT], m[at.COIL_INDUCTANCE] > 0.0
    current, source = m[at.STATE + at.COIL_CURRENT], m[at.SOURCE_SERIES]
    if lags and m[at.FOLLOWED] == 0.0:
        gap = source - current
        if limit > 0.0 and abs(gap) > SAME * (abs(source) + abs(current)):
            m[at.OTHER_SIDE] = 1.0 if gap > 0.0 else -1.0
            m[at.HELD] = m[at.OTHER_SIDE]
            return
        m[at.STATE + at.INPUT_WORK] += 0.5 * m[at.COIL_INDUCTANCE] * gap * (source + current)
    m[at.STATE + at.COIL_CURRENT] = source
    if limit == 0.0:
        return
    write_source_into(m, at.CURRENT_SERIES)
    write_motion_and_voltage_series(m, h)
    side = 1.0 if m[at.VOLTAGE_SERIES] >= 0.0 else -1.0
    m[at.OTHER_SIDE] = side
    write_guard(m, at.VOLTAGE_SERIES, at.TERMS, side, -limit)
    decide_held_by_guard(m, side, lags)


def decide_held_by_guard(m, side, lags):
    """Decide by the balance in GUARD whether the other quantity is held.

    The guard of what is decided begins with as many zeros as the balance; where it is one of a
    current that follows by its inductance, with one more.
    """
    order = first_nonzero_guard_term(m, m[at.OTHER_LOWEST])
    commanded = m[at.CURRENT_CONTROL] != 0.0
    held = not commanded
    if order < at.TERMS:
        held = m[at.GUARD + order] > 0.0
    m[at.HELD] = side if held else 0.0
    if lags and order < at.TERMS and held == commanded:
        order += 1
    m[at.OTHER_ORDER] = order
