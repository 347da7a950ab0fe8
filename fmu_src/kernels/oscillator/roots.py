"""Certified first root of an event function, (13) and (19).

From a point where h and four derivatives are known and the fifth is bounded by B from there on, the
quintic ``h + h' s + h'' s^2/2 + h''' s^3/6 + h'''' s^4/24 - B s^5/120`` lies below the event
function: up to its first root the event function has none. The walk steps from one such quintic to
the next; nothing is sampled, so no root can be skipped, and it converges with fifth order at a
simple root. The walk depends on the state alone, not on where the importer's communication points
lie: it goes on where it was left.
"""

import math

from . import memory as at
from .event_function import evaluate, event_rounding, event_values, set_remainder
from .hermite import (
    clear_part,
    has_no_root,
    lowest_after,
    lowest_before,
    present_coefficients,
)
from .nodes import (
    BLOCK,
    is_plain_flight,
    max_nodes,
    next_phasors,
    phasors_from_closed_form,
    put_phasors,
    set_phasors_at_end,
)

INFINITE = float("inf")
EPS = 1.1102230246251565e-16  # 2**-53
LEAST_BOUND = 1e-290  # smaller ones have no finite inverse
TRIALS = 3
CLOSE = (
    0.00390625  # relative change of the slope up to a root that two steps of Newton's method find
)
CONVERGED = 1e-8  # relative: the next step of Newton's method would be its square


def parabola_root(h0, h1, h2):
    """Return the first positive root of ``h0 + h1 s + h2 s^2/2`` for ``h0 >= 0``; infinity if there
    is none.
    """
    square = h1 * h1 - 2.0 * h0 * h2
    if square < 0.0:
        return INFINITE
    root = math.sqrt(square)
    if h1 < 0.0:
        return 2.0 * h0 / (root - h1)
    if h2 < 0.0:
        return (h1 + root) / -h2
    return INFINITE


def lowest_curvature(h2, h3, h4, bound, s):
    """Return c so that the parabola ``h0 + h1 t + c t^2/2`` is below the quintic for ``0 <= t <=
    s``.
    """
    bent = h4 * (1.0 / 12.0) - bound * s * (1.0 / 60.0)
    lowered = h3 * (1.0 / 3.0) + (s * bent if bent < 0.0 else 0.0)
    return h2 + s * lowered if lowered < 0.0 else h2


def clear_step(h0, h1, h2, h3, h4, bound, reach):
    """Return a step over which ``h0 + h1 s + h2 s^2/2 + h3 s^3/6 + h4 s^4/24 - bound s^5/120``
    stays positive.

    For every trial s, ``min(s, first root of the parabola below the quintic up to s)`` is safe;
    trials close in on the s where both agree.

    Parameters
    ----------
    h0, h1, h2, h3, h4 : float
        Value and four derivatives, ``h0 > 0``, or ``h0 = 0 < h1``, or ``h0 = h1 = 0 < h2``. A lower
        bound will do for h4.
    bound : float
        Of the fifth derivative, >= 0.
    reach : float
        Longest step wanted, > 0.

    Returns
    -------
    float
        > 0.
    """
    far = parabola_root(h0, h1, h2)
    if far > reach:
        far = reach
    clear = parabola_root(h0, h1, lowest_curvature(h2, h3, h4, bound, far))
    # rising, and no parabola below turns down before the lowest curvature vanishes
    if h1 >= 0.0 and h2 > 0.0:
        bent = (h4 if h4 < 0.0 else 0.0) * (1.0 / 6.0) - bound * far * (1.0 / 30.0)
        rising = parabola_root(h2, (h3 if h3 < 0.0 else 0.0) * (1.0 / 3.0), bent)
        if rising > clear:
            clear = rising
    if clear >= far:
        return far
    for _ in range(TRIALS):
        if clear > 0.7 * far:
            break
        s = math.sqrt(clear * far)
        root = parabola_root(h0, h1, lowest_curvature(h2, h3, h4, bound, s))
        if root >= s:
            clear = s
        else:
            far = s
            if root > clear:
                clear = root
    return clear


def walk(m, target):
    """Walk on until the state's end is found or no root lies before ``target``; stop early when the
    step's work is used up.
    """
    while m[at.END_KIND] == at.END_OPEN and m[at.CLEAR] <= target and m[at.WORK] < m[at.WORK_LIMIT]:
        if m[at.CLEAR] >= m[at.RIGHT_AGE]:
            cross_clear_intervals(m, target, INFINITE)
        elif m[at.CLEAR] != m[at.LEFT_AGE] or not clear_from_node(m):
            step_inside_interval(m)


def cross_clear_intervals(m, target, ceiling):
    """Go on from node to node, not beyond ``target``, while the intervals between have no root and
    the event function stays below ``ceiling`` in them; after many nodes the state is written anew.
    """
    if not is_plain_flight(m):  # rarely
        cross_intervals_loop(m, target, ceiling, False, True)
    elif ceiling < INFINITE:
        cross_intervals_loop(m, target, ceiling, True, True)
    else:
        cross_intervals_loop(m, target, ceiling, True, False)


def cross_intervals_loop(m, target, ceiling, plain, watched):  # inline
    """Do what :func:`cross_clear_intervals` does: ``plain`` in a plain flight, ``watched`` if there
    may be a ceiling. Both are constants where this is called: a compiler makes a loop of its own
    for each.
    """
    x, v, x_b, v_b = m[at.RIGHT], m[at.RIGHT + 1], m[at.RIGHT + 2], m[at.RIGHT + 3]
    cosine, sine = m[at.RIGHT + 4], m[at.RIGHT + 5]
    r0, r1, r2 = m[at.RIGHT_VALUES], m[at.RIGHT_VALUES + 1], m[at.RIGHT_VALUES + 2]
    node, age, low, h = m[at.NODE], m[at.RIGHT_AGE], m[at.REMAINDER], m[at.SPACING]
    begun = node
    last = min(node + (m[at.WORK_LIMIT] - m[at.WORK]), max_nodes(m) - 1.0)
    renewal = (math.floor((node + 1.0) * (1.0 / BLOCK)) + 1.0) * BLOCK
    floor, top = lowest_after(m, r0, r1, r2, low), 0.0
    if watched:
        top = lowest_after(m, -r0, -r1, -r2, low)
    clear, below = True, True
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
            x, v, x_b, v_b, cosine, sine = next_phasors(m, plain, x, v, x_b, v_b, cosine, sine)
        r0, r1, r2 = event_values(m, plain, x, v, x_b, v_b, cosine, sine, age)
        clear = min(floor, lowest_before(m, r0, r1, r2, low)) >= 0.0 and r0 > 0.0
        floor = lowest_after(m, r0, r1, r2, low)
        if watched and ceiling < INFINITE:
            below = min(top, lowest_before(m, -r0, -r1, -r2, low)) >= -ceiling and r0 <= ceiling
            top = lowest_after(m, -r0, -r1, -r2, low)
    m[at.WORK] += node - begun
    if node == begun:  # rarely
        m[at.END] = age
        m[at.END_KIND] = at.END_RENEWAL
        return
    m[at.NODE] = node
    m[at.LEFT_AGE] = left
    m[at.RIGHT_AGE] = age
    m[at.CLEAR] = age if clear else left
    put_phasors(m, at.LEFT, old_x, old_v, old_x_b, old_v_b, old_cosine, old_sine)
    put_phasors(m, at.RIGHT, x, v, x_b, v_b, cosine, sine)
    m[at.LEFT_VALUES] = l0
    m[at.LEFT_VALUES + 1] = l1
    m[at.LEFT_VALUES + 2] = l2
    m[at.RIGHT_VALUES] = r0
    m[at.RIGHT_VALUES + 1] = r1
    m[at.RIGHT_VALUES + 2] = r2


def clear_from_node(m):
    """Move CLEAR to the end of that part of the present interval which certainly has no root, and
    return whether there is one.
    """
    b0, b1, b2, b3, b4, b5 = present_coefficients(m, m[at.REMAINDER])
    clear = has_no_root(b0, b1, b2, b3, b4, b5)
    if not clear and b5 > 0.0:  # rarely
        set_remainder(m)
        b0, b1, b2, b3, b4, b5 = present_coefficients(m, m[at.REMAINDER])
        clear = has_no_root(b0, b1, b2, b3, b4, b5)
    if clear:
        m[at.CLEAR] = m[at.RIGHT_AGE]
        return True
    part = clear_part(b0, b1, b2, b3, b4, b5)
    m[at.CLEAR] = m[at.LEFT_AGE] + part * m[at.SPACING]
    return m[at.CLEAR] > m[at.LEFT_AGE]


def step_inside_interval(m):
    """Take one certified step inside the present interval, or find the root."""
    tau = m[at.CLEAR]
    reach = m[at.RIGHT_AGE] - tau
    h0, h1, h2, h3, h4, bound = evaluate(m, tau)
    if h0 <= 0.0:  # rarely
        h0 = value_on_decided_side(m, tau, h0, h1)
    step, found = next_step(h0, h1, h2, h3, h4, bound, tau, reach, root_accuracy(m, tau))
    if found:
        m[at.END] = tau + step
        m[at.END_KIND] = at.END_EVENT
        if m[at.SERIES] == 0.0:
            set_phasors_at_end(m, m[at.END] - tau)
    m[at.CLEAR] = m[at.RIGHT_AGE] if step >= reach else tau + step


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


def next_step(h0, h1, h2, h3, h4, bound, tau, reach, accuracy):
    """Return one step of the walk, and whether it ends on the root.

    Parameters
    ----------
    h0, h1, h2, h3, h4, bound : float
        As in :func:`clear_step`; any sign of h0.
    tau : float
        Where the walk stands.
    reach : float
        Longest step wanted, > 0.
    accuracy : float
        Wanted of the root's place.

    Returns
    -------
    step : float
    found : bool
    """
    if h0 <= 0.0:
        return 0.0, True
    if h1 < 0.0:
        root = close_root(h0, h1, h2, h3, h4, bound, accuracy)
        if 0.0 < root < reach:  # usually
            return root, True
    return clear_step_or_root(h0, h1, h2, h3, h4, bound, tau, reach, accuracy)


def clear_step_or_root(h0, h1, h2, h3, h4, bound, tau, reach, accuracy):
    """Return what :func:`next_step` does, also from ``h0 = 0 < h1`` and ``h0 = h1 = 0 < h2``."""
    # powers of time only: scaled amplitudes take the same steps
    scale = 1.0 / bound if bound > LEAST_BOUND else 1.0
    h0, h1, h2 = h0 * scale, h1 * scale, h2 * scale
    h3, h4, bound = h3 * scale, h4 * scale, bound * scale
    step = clear_step(h0, h1, h2, h3, h4, bound, reach)
    root = taylor_root(h0, h1, h2, h3, h4, bound, step, accuracy)
    if 0.0 < root < reach:
        return root, True
    return step, step <= EPS * tau


def close_root(h0, h1, h2, h3, h4, bound, accuracy):
    """Return the root a short way ahead, where the quartic gives it to within ``accuracy``; else 0.

    So short that the slope, negative here, cannot turn before it: there is no other root.
    """
    root = -h0 / h1
    near = 1.125 * root
    square = near * near
    fifth = bound * square * square * (1.0 / 24.0)
    turn = near * (abs(h2) + near * (abs(h3) * 0.5 + near * abs(h4) * (1.0 / 6.0))) + fifth
    if turn > CLOSE * -h1 or fifth * near > -5.0 * accuracy * h1:
        return 0.0
    for _ in range(2):
        value = h0 + root * (
            h1 + root * (h2 * 0.5 + root * (h3 * (1.0 / 6.0) + root * h4 * (1.0 / 24.0)))
        )
        slope = h1 + root * (h2 + root * (h3 * 0.5 + root * h4 * (1.0 / 6.0)))
        root -= value / slope
    return root


def taylor_root(h0, h1, h2, h3, h4, bound, step, accuracy):
    """Return the root, where the quartic without the bound gives it to within ``accuracy`` and it
    is certainly the first; else 0.

    The step before it is clear; from there on the slope is certainly negative, so there is no other
    root.
    """
    root = step
    slope, change = -1.0, 0.0
    square = step * step
    if bound * square * square * step > 240.0 * (abs(h1) + abs(h2) * step) * accuracy:
        return 0.0
    for _ in range(3):  # Newton's method, from the safe side
        value = h0 + root * (
            h1 + root * (h2 * 0.5 + root * (h3 * (1.0 / 6.0) + root * h4 * (1.0 / 24.0)))
        )
        slope = h1 + root * (h2 + root * (h3 * 0.5 + root * h4 * (1.0 / 6.0)))
        if slope >= 0.0:
            return 0.0
        change = value / slope
        root -= change
    square = root * root
    if (
        bound * square * square * root > -120.0 * slope * accuracy
        or root < step
        or root > 1.5 * step
        or abs(change) > CONVERGED * root
    ):
        return 0.0
    rise = (
        h2
        + (h3 if h3 > 0.0 else 0.0) * root * 0.5
        + (h4 if h4 > 0.0 else 0.0) * square * (1.0 / 6.0)
        + bound * square * root * (1.0 / 24.0)
    )
    return root if h1 + rise * (step if rise < 0.0 else root) < 0.0 else 0.0
