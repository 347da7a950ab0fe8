"""Fit and integrate the polynomials that the FMUs exchange over a communication step.

A cubic is kept as the FMUs take it: value and three time derivatives at the step's beginning. All
of it may be arrays, of many steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

Cubic = tuple[Any, ...]  # four: value and first to third time derivative at a step's beginning


def matched_cubic(first: Any, last: Any, mean: Any, moment: Any, h: Any) -> Cubic:
    """Return the cubic with given end values, mean and first moment over a step."""
    a1, a2, a3 = last - first, mean - first, moment - 0.5 * first
    b = 3.0 * a1 + 36.0 * a2 - 60.0 * a3
    c = -12.0 * a1 - 96.0 * a2 + 180.0 * a3
    d = 10.0 * a1 + 60.0 * a2 - 120.0 * a3
    return first, b / h, 2.0 * c / (h * h), 6.0 * d / (h * h * h)


def end_value(cubic: Cubic, h: Any) -> Any:
    """Return the value of a cubic at the end of a step."""
    f0, f1, f2, f3 = cubic
    return f0 + h * (f1 + 0.5 * h * (f2 + h * f3 / 3.0))


def mean_value(cubic: Cubic, h: Any) -> Any:
    """Return the mean of a cubic over a step."""
    f0, f1, f2, f3 = cubic
    return f0 + 0.5 * h * (f1 + h / 3.0 * (f2 + 0.25 * h * f3))


def end_derivatives(cubic: Cubic, h: Any) -> Cubic:
    """Return the value and the derivatives of a cubic at the end of a step."""
    _, f1, f2, f3 = cubic
    return end_value(cubic, h), f1 + h * (f2 + 0.5 * h * f3), f2 + h * f3, f3


def normalized_coefficients(cubic: Cubic, h: Any) -> Cubic:
    """Convert a cubic's time derivatives to coefficients in s = t/h."""
    f0, f1, f2, f3 = cubic
    return f0, f1 * h, f2 * h * h / 2.0, f3 * h * h * h / 6.0


def integrate_work(force: Cubic, velocity: Any, acceleration: Cubic, h: Any) -> Any:
    """Integrate a cubic force times a velocity over a step; return the work, J."""
    a0, a1, a2, a3 = acceleration
    speeds = (velocity, a0 * h, a1 * h * h / 2.0, a2 * h * h * h / 6.0, a3 * h * h * h * h / 24.0)
    return h * integrate_product(normalized_coefficients(force, h), speeds)


def integrate_product(f: Sequence[Any], g: Sequence[Any]) -> Any:
    """Integrate the product of two polynomials in s from 0 to 1."""
    total = 0.0
    for i, a in enumerate(f):
        for k, b in enumerate(g):
            total = total + a * b / (i + k + 1.0)
    return total


def matched_quartic(ends: tuple[Any, Any], slopes: tuple[Any, Any], mean: Any) -> tuple[Any, ...]:
    """Return the quartic in s with given end values, end slopes and mean."""
    p0, p1 = ends
    d0, d1 = slopes
    rise = p1 - p0
    q = 30.0 * (mean - 0.5 * (p0 + p1) - (d0 - d1) / 12.0)
    return p0, d0, 3.0 * rise - 2.0 * d0 - d1 + q, d0 + d1 - 2.0 * rise - 2.0 * q, q
