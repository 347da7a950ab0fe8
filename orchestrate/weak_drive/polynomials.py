"""Fit and integrate the polynomials that the FMUs exchange over a communication step.

A cubic is kept as the FMUs take it: value and three time derivatives at the step's beginning.
"""

from __future__ import annotations

from collections.abc import Sequence

from .exchange import Cubic

POWERS = [[i + k + 1.0 for k in range(5)] for i in range(5)]  # of s in the integral of s^i s^k


def matched_cubic(first: float, last: float, mean: float, moment: float, h: float) -> Cubic:
    """Return the cubic with given end values, mean and first moment over a step."""
    a1, a2, a3 = last - first, mean - first, moment - 0.5 * first
    b = 3.0 * a1 + 36.0 * a2 - 60.0 * a3
    c = -12.0 * a1 - 96.0 * a2 + 180.0 * a3
    d = 10.0 * a1 + 60.0 * a2 - 120.0 * a3
    return first, b / h, 2.0 * c / (h * h), 6.0 * d / (h * h * h)


def parabola_through_points(
    before: float, first: float, last: float, h_before: float, h: float
) -> Cubic:
    """Return the parabola through three communication points; a line without the first."""
    rise = (last - first) / h
    if h_before == 0.0:
        return first, rise, 0.0, 0.0
    curve = (rise - (first - before) / h_before) / (h + h_before)
    return first, rise - curve * h, 2.0 * curve, 0.0


def end_value(cubic: Cubic, h: float) -> float:
    """Return the value of a cubic at the end of a step."""
    f0, f1, f2, f3 = cubic
    return f0 + h * (f1 + 0.5 * h * (f2 + h * f3 / 3.0))


def end_slope(cubic: Cubic, h: float) -> float:
    """Return the first derivative of a cubic at the end of a step."""
    _, f1, f2, f3 = cubic
    return f1 + h * (f2 + 0.5 * h * f3)


def normalized_coefficients(cubic: Cubic, h: float) -> Cubic:
    """Convert a cubic's time derivatives to coefficients in s = t/h."""
    f0, f1, f2, f3 = cubic
    return f0, f1 * h, f2 * h * h / 2.0, f3 * h * h * h / 6.0


def integrate_work(force: Cubic, velocity: float, acceleration: Cubic, h: float) -> float:
    """Integrate a cubic force times a velocity over a step; return the work, J."""
    a0, a1, a2, a3 = acceleration
    speeds = (velocity, a0 * h, a1 * h * h / 2.0, a2 * h * h * h / 6.0, a3 * h * h * h * h / 24.0)
    return h * integrate_product(normalized_coefficients(force, h), speeds)


def integrate_product(f: Sequence[float], g: Sequence[float]) -> float:
    """Integrate the product of two polynomials in s from 0 to 1."""
    total = 0.0
    for a, powers in zip(f, POWERS):  # noqa: B905 the table is as long as needed
        for b, power in zip(g, powers):  # noqa: B905
            total += a * b / power
    return total


def matched_quartic(
    ends: tuple[float, float], slopes: tuple[float, float], mean: float
) -> tuple[float, ...]:
    """Return the quartic in s with given end values, end slopes and mean."""
    p0, p1 = ends
    d0, d1 = slopes
    rise = p1 - p0
    q = 30.0 * (mean - 0.5 * (p0 + p1) - (d0 - d1) / 12.0)
    return p0, d0, 3.0 * rise - 2.0 * d0 - d1 + q, d0 + d1 - 2.0 * rise - 2.0 * q, q
