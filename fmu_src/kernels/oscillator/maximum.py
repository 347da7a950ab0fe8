"""The largest gap over a piece of flight.

From summit to summit, with the certified steps of the root finder.
"""

from . import memory as at
from .event_function import evaluate
from .hermite import has_summit, interval_is_below
from .roots import accuracy, clear_from_node, clear_step, creep, glide, next_step, parabola_root
from .series import taylor

SMALLEST = 1e-9  # least progress, in tau: a summit is flat, nothing is lost


def watch(m, start, target):
    """Walk to ``target`` and enter the largest gap from ``start`` on; the gap at ``start`` and at
    ``target`` is entered by who looks at these points.
    """
    if m[at.SERIES] != 0.0:
        stop = target if target < m[at.END] else m[at.END]
        # a concave gap stays below its tangents at both ends
        rise, fall = m[at.SERIES_GAP + 1], -taylor(m, at.SERIES_GAP + 1, m[at.END])
        if rise * fall * m[at.END] > (rise + fall) * m[at.X_REL_MAX]:
            m[at.X_REL_MAX] = largest_gap(m, start, stop, m[at.X_REL_MAX])
        return
    tau = start
    while m[at.END_KIND] == at.END_OPEN and m[at.CLEAR] <= target and m[at.WORK] < m[at.WORK_LIMIT]:
        if m[at.CLEAR] >= m[at.RIGHT_AGE]:
            enter(m, tau, m[at.RIGHT_AGE])
            glide(m, target, m[at.X_REL_MAX])
            tau = m[at.LEFT_AGE]
        elif m[at.CLEAR] != m[at.LEFT_AGE] or not clear_from_node(m):
            creep(m)
    enter(m, tau, target if target < m[at.END] else m[at.END])


def enter(m, start, stop):
    """Enter the largest gap of a part of the present interval."""
    highest = m[at.X_REL_MAX]
    if interval_is_below(m, highest) or stop <= start:
        return
    if m[at.CLEAR] <= m[at.RIGHT_AGE] and not has_summit(m, start, stop):
        if start == m[at.LEFT_AGE] and m[at.LEFT_VALUES] > highest:
            highest = m[at.LEFT_VALUES]
        if stop == m[at.RIGHT_AGE] and m[at.RIGHT_VALUES] > highest:
            highest = m[at.RIGHT_VALUES]
        m[at.X_REL_MAX] = highest
        return
    m[at.X_REL_MAX] = largest_gap(m, start, stop, highest)


def climb(h1, h2, h3, h4, bound, reach):
    """A step towards the next summit, and whether it ends there.

    Height is of second order in the summit's place: 1e-9 of it will do.
    """
    root = parabola_root(h1, h2, h3)
    if root < reach and (abs(h4) + bound * root) * root * root * root <= -6e-9 * reach * (
        h2 + h3 * root
    ):
        return root, True
    scale = 1.0 / bound if bound > 0.0 else 1.0
    step = clear_step(h1 * scale, h2 * scale, h3 * scale, h4 * scale, -bound * scale, 0.0, reach)
    return step, step <= 1e-9 * reach


def largest_gap(m, start, stop, highest):
    """The larger of ``highest`` and the present flight's largest gap in ``start <= tau <= stop``.

    Climbing, the walk goes to the first root of the gap's slope; elsewhere to the first point that
    rises above what is known.
    """
    tau = start
    reach = 5.0 * m[at.SPACING]
    summit = False
    while m[at.WORK] < m[at.WORK_LIMIT]:
        h0, h1, h2, h3, h4, bound = evaluate(m, tau)
        if h0 > highest:
            highest = h0
        if tau >= stop:
            break
        if h1 > 0.0 and not summit:
            step, summit = climb(h1, h2, h3, h4, bound, reach)
        elif highest > h0:
            step, _ = next_step(
                highest - h0, -h1, -h2, -h3, -h4, bound, tau, reach, accuracy(m, tau)
            )
            summit = False
        else:
            scale = 1.0 / bound if bound > 0.0 else 1.0
            step = clear_step(
                0.0,
                -h1 * scale if h1 < 0.0 else 0.0,
                -h2 * scale,
                -h3 * scale,
                -h4 * scale,
                bound * scale,
                reach,
            )
            summit = False
            if step < SMALLEST:
                step = SMALLEST
        tau = tau + step if tau + step < stop else stop
    return highest
