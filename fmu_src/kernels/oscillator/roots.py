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
from .event_function import evaluate, rounding

INFINITE = float("inf")
EPS = 1.1102230246251565e-16  # 2**-53
TRIALS = 3


def parabola_root(h0, h1, h2):
    """First positive root of ``h0 + h1 s + h2 s^2/2`` for ``h0 >= 0``; infinity if none."""
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
    """The parabola ``h0 + h1 t + c t^2/2`` with this c is below the quintic for ``0 <= t <= s``."""
    bent = h4 * (1.0 / 12.0) - bound * s * (1.0 / 60.0)
    lowered = h3 * (1.0 / 3.0) + (s * bent if bent < 0.0 else 0.0)
    return h2 + s * lowered if lowered < 0.0 else h2


def clear_step(h0, h1, h2, h3, h4, bound, reach):
    """A step over which a quintic, the lower bound of the event function, stays positive.

    It is ``h0 + h1 s + h2 s^2/2 + h3 s^3/6 + h4 s^4/24 - bound s^5/120``.

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
    """Walk on until the state's end is found or no root lies before ``target``.

    Ends early when the step's work is used up.
    """
    while m[at.END_KIND] == at.END_OPEN and m[at.CLEAR] <= target and m[at.WORK] < m[at.WORK_LIMIT]:
        tau = m[at.CLEAR]
        renewal = renewal_age(m)
        if tau >= renewal:
            m[at.END] = renewal
            m[at.END_KIND] = at.END_RENEWAL
            return
        h0, h1, h2, h3, h4, bound = evaluate(m, tau)
        if h0 <= 0.0:
            h0 = lifted(m, tau, h0, h1)
        step, found = next_step(h0, h1, h2, h3, h4, bound, tau, longest_step(m))
        if found:
            m[at.END] = tau + step
            m[at.END_KIND] = at.END_EVENT
        m[at.CLEAR] = tau + step


def lifted(m, tau, h0, h1):
    """A value of the event function at a point where it is not clearly positive.

    It may not be positive, or be zero but for rounding with no crossing in sight.

    Near a start on the boundary the event function may be smaller than the rounding of its terms
    for a while; the side was decided when the state began, and holds until the event function is
    seen to cross.
    """
    floor = rounding(m, tau)
    if h0 < -floor or floor < -1e-6 * h1:
        return h0
    return 2.0 * floor


def renewal_age(m):
    """The age at which a state is written anew.

    The angles of (10) stay small, and with them their rounding.
    """
    return 1024.0 / max(m[at.FASTEST], m[at.ETA])


def longest_step(m):
    """Beyond a radian or so of the fastest oscillation the quintic says nothing."""
    return 6.0 / max(m[at.FASTEST], m[at.ETA])


def next_step(h0, h1, h2, h3, h4, bound, tau, reach):
    """One step of the walk, and whether it ends on the root.

    Parameters
    ----------
    h0, h1, h2, h3, h4, bound : float
        As in :func:`clear_step`; any sign of h0.
    tau : float
        Where the walk stands. The accuracy wanted is the rounding of a time of the size of ``tau +
        reach``.
    reach : float
        Longest step wanted, > 0.

    Returns
    -------
    step : float
    found : bool
    """
    if h0 <= 0.0:
        return 0.0, True
    return step_from(h0, h1, h2, h3, h4, bound, tau, reach)


def step_from(h0, h1, h2, h3, h4, bound, tau, reach):
    """As :func:`next_step`, also from ``h0 = 0 < h1`` and ``h0 = h1 = 0 < h2``."""
    # powers of time only: scaled amplitudes take the same steps
    scale = 1.0 / bound if bound > 0.0 else 1.0
    h0, h1, h2 = h0 * scale, h1 * scale, h2 * scale
    h3, h4, bound = h3 * scale, h4 * scale, bound * scale
    step = clear_step(h0, h1, h2, h3, h4, bound, reach)
    root = taylor_root(h0, h1, h2, h3, h4, bound, step, EPS * (tau + reach))
    if root > 0.0:
        return root, True
    return step, step <= EPS * tau


def taylor_root(h0, h1, h2, h3, h4, bound, step, accuracy):
    """The root by the quartic without the bound, where that is certain; else 0.

    It is within ``accuracy`` then, and certainly the first.

    The step before it is clear; from there on the slope is certainly negative, so there is no other
    root.
    """
    root = step
    slope = -1.0
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
        root -= value / slope
    square = root * root
    if (
        bound * square * square * root > -120.0 * slope * accuracy
        or root < step
        or root > 1.5 * step
    ):
        return 0.0
    rise = (
        h2
        + (h3 if h3 > 0.0 else 0.0) * root * 0.5
        + (h4 if h4 > 0.0 else 0.0) * square * (1.0 / 6.0)
        + bound * square * root * (1.0 / 24.0)
    )
    return root if h1 + rise * (step if rise < 0.0 else root) < 0.0 else 0.0
