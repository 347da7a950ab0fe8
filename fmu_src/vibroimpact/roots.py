"""Certified first root of a barrier, (13) and (19).

From a point where h, h', h'' are known and ``|h'''| <= B`` from there on, the cubic ``h + h' s + h'' s^2/2 - B s^3/6`` lies below
the barrier: up to its first root the barrier has none. The walk steps from one such cubic to the next; nothing is sampled, so no
root can be skipped, and it converges with third order at a simple root. The walk depends on the state alone, not on
where the importer's communication points lie: it goes on where it was left.
"""

import math

from . import memory as at
from .barrier import evaluate

INFINITE = float("inf")
EPS = 1.1102230246251565e-16  # 2**-53


def parabola_root(h0, h1, h2):
    """First positive root of ``h0 + h1 s + h2 s^2/2`` for ``h0 >= 0``; infinity if there is none."""
    square = h1 * h1 - 2.0 * h0 * h2
    if square < 0.0:
        return INFINITE
    root = math.sqrt(square)
    if h1 < 0.0:
        return 2.0 * h0 / (root - h1)
    if h2 < 0.0:
        return (h1 + root) / -h2
    return INFINITE


def clear_step(h0, h1, h2, bound):
    """A step over which ``h0 + h1 s + h2 s^2/2 - bound s^3/6`` stays positive.

    For ``s <= a`` that cubic lies above the parabola with ``h2 - bound a/3``, so ``min(a, root of that parabola)`` is safe for every a;
    the cubic's root is where both agree. Three such steps come close enough.

    Parameters
    ----------
    h0, h1, h2 : float
        Value and two derivatives, ``h0 > 0``, or ``h0 = 0 < h1``, or ``h0 = h1 = 0 < h2``.
    bound : float
        Of the third derivative, >= 0.

    Returns
    -------
    float
        > 0; infinity where the barrier never falls to zero.
    """
    guess = parabola_root(h0, h1, h2)
    if bound <= 0.0:
        return guess
    h0, h1, h2 = h0 / bound, h1 / bound, h2 / bound  # units of time only: scaled amplitudes take the same steps
    rise = h1 if h1 > 0.0 else 0.0
    reach = 1.5 * (h2 + math.sqrt(h2 * h2 + rise * (8.0 / 3.0)))  # root for h0 = 0
    if reach > 0.0 and reach < guess:
        guess = reach
    elif guess == INFINITE:
        guess = 1.0 + 6.0 * h0  # level ground: the cubic's root is (6 h0)^(1/3)
    low = parabola_root(h0, h1, h2 - guess * (1.0 / 3.0))
    if low >= guess:
        return guess
    high = parabola_root(h0, h1, h2 - low * (1.0 / 3.0))  # beyond the cubic's root: `low` lies before it
    better = parabola_root(h0, h1, h2 - min(high, guess) * (1.0 / 3.0))
    return better if better > low else low


def walk(m, target):
    """Walk on until the state's end is found or no root lies before ``target``; ends early when the step's work is used up."""
    while m[at.END_KIND] == at.END_OPEN and m[at.CLEAR] <= target and m[at.WORK] < m[at.WORK_LIMIT]:
        tau = m[at.CLEAR]
        renewal = renewal_age(m)
        if tau >= renewal:
            m[at.END] = renewal
            m[at.END_KIND] = at.END_RENEWAL
            return
        h0, h1, h2, _, bound, _ = evaluate(m, tau)
        step, found = next_step(h0, h1, h2, bound, tau)
        if found:
            m[at.END] = tau + step
            m[at.END_KIND] = at.END_EVENT
        m[at.CLEAR] = tau + step


def renewal_age(m):
    """The age at which a state is written anew: the angles of (10) stay small, and with them their rounding."""
    return 1024.0 / max(m[at.FASTEST], m[at.ETA])


def next_step(h0, h1, h2, bound, tau):
    """One step of the walk, and whether it ends on the root.

    Once the cubic's remainder displaces the parabola's root by less than the rounding of ``tau``, that root is the barrier's.
    """
    if h0 <= 0.0:
        return 0.0, True
    root = parabola_root(h0, h1, h2)
    if root < INFINITE:
        slope = -(h1 + h2 * root)
        if bound * root * root * root <= 6.0 * slope * EPS * (tau + root):
            return root, True
    step = clear_step(h0, h1, h2, bound)
    return step, step <= EPS * tau
