"""Certified first root of an event function, (13) and (19).

By the certified steps of :mod:`..numerics.first_root`. The walk depends only on the state, not on
where the importer's communication points lie: it resumes where it was left.
"""

import math

from ..numerics.first_root import EPS, INFINITE, NO_NUMBER, next_step_or_root
from . import memory as at
from .event_function import evaluate_event_function, event_rounding, event_values, set_remainder
from .hermite import (
    clear_part,
    excludes_root,
    interval_coefficients,
    lowest_left_coefficient,
    lowest_right_coefficient,
)
from .nodes import (
    BLOCK,
    is_plain_flight,
    max_nodes,
    phasors_at_next_node,
    phasors_from_closed_form,
    set_phasors_at_near_end,
    write_phasors,
)


def walk_to_event(m, target):
    """Walk until the end is found, ``target`` is clear, or the step's work is used up."""
    while m[at.END_KIND] == at.END_OPEN and m[at.CLEAR] <= target and m[at.WORK] < m[at.WORK_LIMIT]:
        if m[at.CLEAR] >= m[at.RIGHT_AGE]:
            cross_clear_intervals(m, target, gap_limit(m))
        elif m[at.CLEAR] != m[at.LEFT_AGE] or not move_clear_from_node(m):
            step_inside_interval(m)


def gap_limit(m):
    return m[at.LIMIT] if m[at.MODE] == at.FLIGHT else INFINITE


def cross_clear_intervals(m, target, ceiling):
    """Go from node to node, to ``target``, without root and below ``ceiling``."""
    if not is_plain_flight(m):  # rarely
        cross_intervals_loop(m, target, ceiling, False, True)
    elif ceiling < INFINITE:
        cross_intervals_loop(m, target, ceiling, True, True)
    else:
        cross_intervals_loop(m, target, ceiling, True, False)


def cross_intervals_loop(m, target, ceiling, is_plain, has_ceiling):  # inline
    """Do so; ``is_plain``, ``has_ceiling`` (a ceiling) are constants: a loop compiled for each."""
    x, v, x_b, v_b = m[at.RIGHT], m[at.RIGHT + 1], m[at.RIGHT + 2], m[at.RIGHT + 3]
    cosine, sine = m[at.RIGHT + 4], m[at.RIGHT + 5]
    r0, r1, r2 = m[at.RIGHT_VALUES], m[at.RIGHT_VALUES + 1], m[at.RIGHT_VALUES + 2]
    node, age, low, h = m[at.NODE], m[at.RIGHT_AGE], m[at.REMAINDER], m[at.SPACING]
    begun = node
    last = min(node + (m[at.WORK_LIMIT] - m[at.WORK]), max_nodes(m) - 1.0)
    renewal = (math.floor((node + 1.0) * (1.0 / BLOCK)) + 1.0) * BLOCK
    floor, top = lowest_left_coefficient(m, r0, r1, r2, low), 0.0
    if has_ceiling:
        top = lowest_left_coefficient(m, -r0, -r1, -r2, low)
    limit, clear, below = gap_limit(m), True, True
    while clear and below and age <= target and node < last:
        node += 1.0
        old_x, old_v, old_x_b, old_v_b, old_cosine, old_sine = x, v, x_b, v_b, cosine, sine
        l0, l1, l2 = r0, r1, r2
        left = age
        age = (node + 1.0) * h
        if node + 1.0 == renewal:  # rarely
            x, v, x_b, v_b, cosine, sine = phasors_from_closed_form(m, age)
            renewal += BLOCK
        else:
            x, v, x_b, v_b, cosine, sine = phasors_at_next_node(
                m, is_plain, x, v, x_b, v_b, cosine, sine
            )
        r0, r1, r2 = event_values(m, is_plain, x, v, x_b, v_b, cosine, sine, age)
        clear = min(floor, lowest_right_coefficient(m, r0, r1, r2, low)) >= 0.0 and r0 > 0.0
        floor = lowest_left_coefficient(m, r0, r1, r2, low)
        if has_ceiling and ceiling < INFINITE:
            highest = -min(top, lowest_right_coefficient(m, -r0, -r1, -r2, low), -r0)
            below = highest <= ceiling
            clear = clear and highest < limit
            top = lowest_left_coefficient(m, -r0, -r1, -r2, low)
    m[at.WORK] += node - begun
    if node == begun:  # rarely
        m[at.END] = age
        m[at.END_KIND] = at.END_RENEWAL
        return
    m[at.NODE] = node
    m[at.LEFT_AGE] = left
    m[at.RIGHT_AGE] = age
    m[at.CLEAR] = age if clear else left
    write_phasors(m, at.LEFT, old_x, old_v, old_x_b, old_v_b, old_cosine, old_sine)
    write_phasors(m, at.RIGHT, x, v, x_b, v_b, cosine, sine)
    write_values(m, at.LEFT_VALUES, l0, l1, l2)
    write_values(m, at.RIGHT_VALUES, r0, r1, r2)


def write_values(m, slot, h0, h1, h2):  # inline
    m[slot] = h0
    m[slot + 1] = h1
    m[slot + 2] = h2


def move_clear_from_node(m):
    """Move CLEAR past the part of the present interval without root at either end, if any."""
    part = part_without_root(m, False)
    if m[at.LIMIT] < INFINITE and m[at.MODE] == at.FLIGHT:  # rarely
        part = min(part, part_without_limit_root(m))
    m[at.CLEAR] = m[at.RIGHT_AGE] if part == 1.0 else m[at.LEFT_AGE] + part * m[at.SPACING]
    return m[at.CLEAR] > m[at.LEFT_AGE]


def part_without_limit_root(m):
    return part_without_root(m, True)


def part_without_root(m, of_limit):  # inline
    """Return the part, from its start, of the interval without root of function or limit."""
    b0, b1, b2, b3, b4, b5 = lower_coefficients(m, of_limit)
    clear = excludes_root(b0, b1, b2, b3, b4, b5)
    if not clear and b5 > 0.0:  # rarely
        set_remainder(m)
        b0, b1, b2, b3, b4, b5 = lower_coefficients(m, of_limit)
        clear = excludes_root(b0, b1, b2, b3, b4, b5)
    if clear:
        return 1.0
    return clear_part(b0, b1, b2, b3, b4, b5)


def lower_coefficients(m, of_limit):  # inline
    """Return Bernstein coefficients below the event function, or what the limit leaves."""
    if not of_limit:  # usually
        return interval_coefficients(m, m[at.REMAINDER])
    b0, b1, b2, b3, b4, b5 = interval_coefficients(m, -m[at.REMAINDER])
    limit = m[at.LIMIT]
    return limit - b0, limit - b1, limit - b2, limit - b3, limit - b4, limit - b5


def step_inside_interval(m):
    """Take one certified step, or find the root; without a bound CLEAR is no number: it fails."""
    tau = m[at.CLEAR]
    h0, h1, h2, h3, h4, bound = evaluate_event_function(m, tau)
    if not bound < INFINITE:  # rarely
        m[at.CLEAR] = NO_NUMBER
        return
    if h0 <= 0.0:  # rarely
        h0 = value_on_decided_side(m, tau, h0, h1)
    reach, accuracy = m[at.RIGHT_AGE] - tau, root_accuracy(m, tau)
    step, found = next_step_or_root(h0, h1, h2, h3, h4, bound, tau, reach, accuracy)
    take_step(m, tau, reach, step, found, (h0, h1, h2, h3, h4, bound))


def take_step(m, tau, reach, step, found, values):  # inline
    """Take a step that event function (six ``values`` at ``tau``) and gap's limit allow."""
    kind = at.END_EVENT
    if m[at.LIMIT] < INFINITE and m[at.MODE] == at.FLIGHT:  # rarely
        h0, h1, h2, h3, h4, bound = values
        other, ends = next_step_to_limit(m, tau, reach, h0, h1, h2, h3, h4, bound)
        if other < step:
            step, found, kind = other, ends, at.END_OTHER
    if found:
        m[at.END] = tau + step
        m[at.END_KIND] = kind
        if m[at.SERIES] == 0.0:
            set_phasors_at_near_end(m, m[at.END] - tau)
    m[at.CLEAR] = m[at.RIGHT_AGE] if step >= reach else tau + step


def next_step_to_limit(m, tau, reach, h0, h1, h2, h3, h4, bound):
    left, accuracy = m[at.LIMIT] - h0, root_accuracy(m, tau)
    return next_step_or_root(left, -h1, -h2, -h3, -h4, bound, tau, reach, accuracy)


def root_accuracy(m, tau):
    """Return the error that a root's age may have: its rounding."""
    return EPS * (tau + 4.0 * m[at.SPACING])


def value_on_decided_side(m, tau, h0, h1):
    """Return a value of the event function that is not positive, or a positive one where it is zero
    but for rounding and no crossing is in sight.

    Near a start on the boundary the event function may be smaller than the rounding of its terms
    for a while; the side was decided when the state began, and holds until the event function is
    seen to cross.
    """
    floor = event_rounding(m, tau)
    if h0 < -floor or floor < -1e-6 * h1:
        return h0
    return 2.0 * floor
