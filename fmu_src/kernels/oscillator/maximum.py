"""The largest gap over a piece of flight.

From summit to summit, with the certified steps of the root finder.
"""

from . import memory as at
from .event_function import evaluate
from .roots import clear_step, longest_step, next_step, parabola_root

SMALLEST = 1e-9  # least progress, in tau: a summit is flat, nothing is lost


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
    reach = longest_step(m)
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
            step, _ = next_step(highest - h0, -h1, -h2, -h3, -h4, bound, tau, reach)
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
