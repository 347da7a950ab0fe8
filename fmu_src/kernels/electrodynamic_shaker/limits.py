"""The first event of an interval: the first root of the guards, which are positive up to it.

Guards are power series in parts of the interval. Where every term but the first is too small to
bring one to zero, it has no root; else the certified steps of :mod:`..numerics.first_root` walk
through the interval.
"""

from ..numerics.first_root import EPS, NO_NUMBER, next_step_or_root
from . import memory as at
from .amplifier import write_balance, write_guard

NONE = 2.0  # behind the interval
MOST_STEPS = 10000  # through an interval
LEAST = 1e-40  # of the bound, relative to the terms: its inverse stays far from the largest number


def find_event(m):
    m[at.EVENT] = NONE
    m[at.EVENT_KIND] = at.NO_EVENT
    if m[at.COMMAND_LIMIT] > 0.0:
        watch_command_limit(m)
    if m[at.OTHER_LIMIT] > 0.0:
        watch_other_limit(m)
    if m[at.TRAVEL_LIMIT] > 0.0:
        limit = m[at.TRAVEL_LIMIT]
        note_roots_at_limits(m, at.POSITION_SERIES, at.TERMS, limit, 1.0, 0, at.TRAVEL_EVENT)


def watch_command_limit(m):
    """Look for the event that the command reaches its limit, or comes back to it."""
    limit, side = m[at.COMMAND_LIMIT], m[at.COMMAND_SIDE]
    order = int(m[at.COMMAND_ORDER]) if m[at.INTERVAL] == 0.0 else 0
    if m[at.CLIPPED] != 0.0:
        write_guard(m, at.COMMAND_SERIES, at.CUBIC, m[at.CLIPPED], -limit)
        note_earlier_root(m, order, at.COMMAND_EVENT)
    else:
        note_roots_at_limits(m, at.COMMAND_SERIES, at.CUBIC, limit, side, order, at.COMMAND_EVENT)


def watch_other_limit(m):
    """Look for the event that the other quantity reaches its limit, or leaves it."""
    limit, side = m[at.OTHER_LIMIT], m[at.OTHER_SIDE]
    order = int(m[at.OTHER_ORDER]) if m[at.INTERVAL] == 0.0 else 0
    own, other = at.VOLTAGE_SERIES, at.CURRENT_SERIES
    if m[at.CURRENT_CONTROL] != 0.0:
        own, other = at.CURRENT_SERIES, at.VOLTAGE_SERIES
    if m[at.HELD] != 0.0:
        write_balance(m, own, m[at.HELD])
        note_earlier_root(m, order, at.OTHER_EVENT)
    else:
        note_roots_at_limits(m, other, at.TERMS, limit, side, order, at.OTHER_EVENT)


def note_roots_at_limits(m, series, terms, limit, side, order, kind):
    """Note where a series reaches its limit on ``side``, ``order`` terms from it, or the other."""
    write_guard(m, series, terms, -side, limit)
    note_earlier_root(m, order, kind)
    write_guard(m, series, terms, side, limit)
    note_earlier_root(m, 0, kind)


def note_earlier_root(m, order, kind):
    """Make the root of GUARD the interval's event where it is earlier."""
    root = first_guard_root(m, order)
    if root < m[at.EVENT] or root != root:
        m[at.EVENT] = root
        m[at.EVENT_KIND] = kind


def first_guard_root(m, order):
    """Return the first root of GUARD, or NONE; terms before ``order`` vanish, but for rounding."""
    first = order
    while first < at.TERMS and (
        m[at.GUARD + first] == 0.0 or (order > 0 and m[at.GUARD + first] < 0.0)
    ):
        first += 1
    if first == at.TERMS:
        return NONE
    lowest, size = m[at.GUARD + first], abs(m[at.GUARD + first])
    if lowest < 0.0:
        return 0.0
    for k in range(first + 1, at.TERMS):
        lowest += min(m[at.GUARD + k], 0.0)
        size += abs(m[at.GUARD + k])
    return NONE if lowest > 0.0 else walk_to_guard_root(m, first, size)


def walk_to_guard_root(m, first, size):
    """Return the first root of GUARD over its ``first`` power, NONE, or NaN: undecided."""
    bound = LEAST * size
    for k in range(first + 5, at.TERMS):
        j = k - first
        bound += abs(m[at.GUARD + k]) * (j * (j - 1) * (j - 2) * (j - 3) * (j - 4))
    part = 0.0
    for _ in range(MOST_STEPS):
        h0, h1, h2, h3, h4 = guard_derivatives(m, first, part)
        step, found = next_step_or_root(h0, h1, h2, h3, h4, bound, 1.0, 1.0 - part, EPS)
        part += step
        if found:
            return part
        if part >= 1.0:
            return NONE
    return NO_NUMBER


def guard_derivatives(m, first, part):
    """Return value and four derivatives of GUARD over the power of its ``first`` term."""
    h0, h1, h2, h3, h4 = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(at.DEGREE, first - 1, -1):
        h4 = h4 * part + h3
        h3 = h3 * part + h2
        h2 = h2 * part + h1
        h1 = h1 * part + h0
        h0 = h0 * part + m[at.GUARD + k]
    return h0, h1, 2.0 * h2, 6.0 * h3, 24.0 * h4
