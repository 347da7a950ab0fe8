"""Restitution coefficients of contact laws in closed form, and their inverses."""

from __future__ import annotations

import math

from scipy.optimize import brentq


def linear_restitution(ratio: float) -> float:
    """Return the restitution of a spring-dashpot contact without pull, by damping ratio.

    It ends where the force is zero, before the depth is: at the phase 2 b with cos(b) = ratio.
    """
    return math.exp(-2.0 * math.acos(ratio) * ratio / math.sqrt(1.0 - ratio * ratio))


def linear_damping_ratio(e: float) -> float:
    """Return the damping ratio that gives :func:`linear_restitution` a value above exp(-2)."""
    return float(brentq(lambda ratio: linear_restitution(ratio) - e, 0.0, 1.0 - 1e-9))


def hunt_crossley_restitution(damping: float, speed: float) -> float:
    """Return the restitution of ``k d**n (1 + damping d')`` at a closing speed, any k and n.

    By the power balance over the depth, with y = damping speed: y (1 + e) = ln((1 + y)/(1 - e y)).
    """
    y = damping * speed
    if y < 1e-9:
        return 1.0 - 2.0 * y / 3.0
    high = min(1.0, (1.0 - 1e-15) / y)

    def balance(e: float) -> float:
        return y * (1.0 + e) - math.log1p(y) + math.log1p(-e * y)

    return float(brentq(balance, 0.0, high)) if balance(high) < 0.0 else high


def hunt_crossley_damping(e: float, speed: float) -> float:
    """Return the damping, s/m, that gives a restitution below 1 at a closing speed."""
    return float(
        brentq(lambda c: hunt_crossley_restitution(c, speed) - e, 1e-6 / speed, 100.0 / speed)
    )
