"""The largest values over a step: of the gap, of displacements and of accelerations.

From summit to summit, with the certified steps of the root finder. A signal is named by the slot
of its maximum.
"""

from ..numerics.first_root import EPS, LEAST_BOUND, clear_step, parabola_root
from . import memory as at
from .event_function import AHEAD, envelope_bound, evaluate_event_function
from .hermite import is_interval_below, may_have_summit
from .motion_signal import evaluate_motion_signal
from .nodes import move_to_interval_at
from .roots import cross_clear_intervals, move_clear_from_node, step_inside_interval, walk_to_event
from .series import taylor_value

# least progress, of a spacing: a summit is flat, nothing is lost; it grows from step to step, so
# that no rounding can hold the search up: after 95 steps an interval is through
SMALLEST, GROWTH = 1e-9, 1.25


def walk_with_largest_gap(m, start, target):
    """Walk to ``target``; record the largest gap from ``start``, both ends left to the caller."""
    if m[at.SIDE] < 0.0:  # rarely
        walk_to_event(m, target)
        record_least_gap(m, start, target if target < m[at.END] else m[at.END])
        return
    if m[at.SERIES] != 0.0:
        stop = target if target < m[at.END] else m[at.END]
        # a concave gap stays below its tangents at both ends
        rise, fall = m[at.SERIES_GAP + 2], -taylor_value(m, at.SERIES_GAP + 2, m[at.END])
        if rise * fall * m[at.END] > (rise + fall) * m[at.X_REL_MAX]:
            m[at.X_REL_MAX] = largest_signal_value(
                m, at.X_REL_MAX, 1.0, start, stop, m[at.X_REL_MAX]
            )
        return
    tau = start
    while m[at.END_KIND] == at.END_OPEN and m[at.CLEAR] <= target and m[at.WORK] < m[at.WORK_LIMIT]:
        if m[at.CLEAR] >= m[at.RIGHT_AGE]:
            record_largest_gap(m, tau, m[at.RIGHT_AGE])
            cross_clear_intervals(m, target, m[at.X_REL_MAX])
            tau = m[at.LEFT_AGE]
        elif m[at.CLEAR] != m[at.LEFT_AGE] or not move_clear_from_node(m):
            step_inside_interval(m)
    record_largest_gap(m, tau, target if target < m[at.END] else m[at.END])


def record_least_gap(m, start, stop):
    """Raise the maximum to what the stroke leaves of the mirrored system's least gap in a part."""
    if m[at.X_REL_MAX] >= m[at.LIMIT]:
        return
    place = m[at.LEFT_AGE] + m[at.HALF_SPACING]
    highest = largest_signal_value(
        m, at.X_REL_MAX, -1.0, start, stop, m[at.X_REL_MAX] - m[at.LIMIT]
    )
    m[at.X_REL_MAX] = m[at.LIMIT] + highest
    if m[at.SERIES] == 0.0:
        move_to_interval_at(m, place)


def record_largest_gap(m, start, stop):
    highest = m[at.X_REL_MAX]
    if is_interval_below(m, highest) or stop <= start:
        return
    if m[at.CLEAR] <= m[at.RIGHT_AGE] and not may_have_summit(m, start, stop):
        if start == m[at.LEFT_AGE] and m[at.LEFT_VALUES] > highest:
            highest = m[at.LEFT_VALUES]
        if stop == m[at.RIGHT_AGE] and m[at.RIGHT_VALUES] > highest:
            highest = m[at.RIGHT_VALUES]
        m[at.X_REL_MAX] = highest
        return
    m[at.X_REL_MAX] = largest_signal_value(m, at.X_REL_MAX, 1.0, start, stop, highest)


def record_peaks(m, start, stop):
    place = m[at.LEFT_AGE] + m[at.HALF_SPACING]
    for slot in range(at.X1_MAX, at.A2_MAX + 1):
        highest = largest_signal_value(m, slot, 1.0, start, stop, m[slot])
        m[slot] = largest_signal_value(m, slot, -1.0, start, stop, highest)
    if m[at.SERIES] == 0.0:
        move_to_interval_at(m, place)


def step_to_summit(h1, h2, h3, h4, bound, reach):
    """Return a step to the next summit, within 1e-9 of its height, and whether it ends there."""
    root = parabola_root(h1, h2, h3)
    if root < reach and (abs(h4) + bound * root) * root * root * root <= -6e-9 * reach * (
        h2 + h3 * root
    ):
        return root, True
    return scaled_clear_step(h1, h2, h3, h4, -bound, 0.0, reach), False


def scaled_clear_step(h0, h1, h2, h3, h4, bound, reach):
    """Return ``clear_step`` in units of the bound, or of ``-h4``: scaling keeps steps."""
    unit = bound if bound > 0.0 else -h4
    scale = 1.0 / unit if unit > LEAST_BOUND else 1.0
    return clear_step(
        h0 * scale, h1 * scale, h2 * scale, h3 * scale, h4 * scale, bound * scale, reach
    )


def gap_rounding(m, tau):
    if m[at.SERIES] != 0.0:
        return 2.0 * EPS * m[at.SERIES_GAP + 1] * m[at.END]
    p = at.POINT
    size = abs(m[at.EVENT_HARMONIC]) + abs(m[at.EVENT_HARMONIC + 1]) + abs(m[at.EVENT_OFFSET])
    size += envelope_bound(m, at.OSCILLATOR_1, m[p], m[p + 1]) + envelope_bound(
        m, at.OSCILLATOR_2, m[p + 2], m[p + 3]
    )
    if m[at.CUBIC_PRESENT] != 0.0:  # rarely
        power = 1.0
        for i in range(4):
            size += abs(m[at.EVENT_CUBIC + i]) * power
            power *= tau
    return 2.0 * EPS * size


def evaluate_signal(m, slot, sign, tau):
    """Return value, four derivatives, a bound of the fifth, and the value's rounding error."""
    if slot == at.X_REL_MAX:
        h0, h1, h2, h3, h4, bound = evaluate_event_function(m, tau)
        rounding = gap_rounding(m, tau)
        return sign * h0, sign * h1, sign * h2, sign * h3, sign * h4, bound, rounding
    h0, h1, h2, h3, h4, bound = evaluate_motion_signal(m, slot, sign, tau)
    return h0, h1, h2, h3, h4, bound, 4.0 * EPS * abs(h0)


def largest_signal_value(m, slot, sign, start, stop, highest):
    """Return the larger of ``highest`` and a signal's largest value in ``start <= tau <= stop``."""
    tau = start
    reach = AHEAD * m[at.SPACING]
    least = SMALLEST * m[at.SPACING]
    summit = False
    while m[at.WORK] < m[at.WORK_LIMIT]:
        h0, h1, h2, h3, h4, bound, rounding = evaluate_signal(m, slot, sign, tau)
        if h0 > highest:
            highest = h0
        if tau >= stop:
            break
        step, reached = 0.0, False
        if h1 > 0.0 and not summit:
            step, reached = step_to_summit(h1, h2, h3, h4, bound, reach)
        summit = reached
        if not summit:
            room = (highest - h0) + rounding
            step = max(step, scaled_clear_step(room, -h1, -h2, -h3, -h4, bound, reach))
        step = max(step, least)
        least *= GROWTH
        tau = tau + step if tau + step < stop else stop
    return highest
