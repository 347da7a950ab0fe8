"""Certified first root of a function of which value, four derivatives and a bound are known.

From a point where h and four derivatives are known and the fifth is bounded by B from there on, the
quintic ``h + h' s + h'' s^2/2 + h''' s^3/6 + h'''' s^4/24 - B s^5/120`` lies below the function: up
to its first root the function has none. A walk steps from one such quintic to the next; nothing is
sampled, so no root can be skipped, and it converges with fifth order at a simple root.
"""

import math

INFINITE = float("inf")
NO_NUMBER = INFINITE - INFINITE
EPS = 1.1102230246251565e-16  # 2**-53
LEAST_BOUND = 1e-290  # smaller ones have no finite inverse
TRIALS = 3
CLOSE = (
    0.00390625  # relative change of the slope up to a root that two steps of Newton's method find
)
CONVERGED = 1e-8  # relative: the next step of Newton's method would be its square


def parabola_root(h0, h1, h2):
    """Return the first positive root of ``h0 + h1 s + h2 s^2/2``, ``h0 >= 0``, or infinity."""
    square = h1 * h1 - 2.0 * h0 * h2
    if square < 0.0:
        return INFINITE
    root = math.sqrt(square)
    if h1 < 0.0:
        return 2.0 * h0 / (root - h1)
    if h2 < 0.0:
        return (h1 + root) / -h2
    return INFINITE


def lowest_parabola_curvature(h2, h3, h4, bound, s):
    """Return c such that ``h0 + h1 t + c t^2/2`` is below the quintic for ``0 <= t <= s``."""
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
    clear = parabola_root(h0, h1, lowest_parabola_curvature(h2, h3, h4, bound, far))
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
        root = parabola_root(h0, h1, lowest_parabola_curvature(h2, h3, h4, bound, s))
        if root >= s:
            clear = s
        else:
            far = s
            if root > clear:
                clear = root
    return clear


def next_step_or_root(h0, h1, h2, h3, h4, bound, tau, reach, accuracy):
    """Return a step of the walk from ``tau``, h0 of any sign; and whether it ends on the root."""
    if h0 <= 0.0:
        return 0.0, True
    if h1 < 0.0:
        root = close_root(h0, h1, h2, h3, h4, bound, accuracy)
        if 0.0 < root < reach:  # usually
            return root, True
    return clear_step_or_root(h0, h1, h2, h3, h4, bound, tau, reach, accuracy)


def clear_step_or_root(h0, h1, h2, h3, h4, bound, tau, reach, accuracy):
    """Do as :func:`next_step_or_root`, also from ``h0 = 0 < h1`` and ``h0 = h1 = 0 < h2``."""
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
