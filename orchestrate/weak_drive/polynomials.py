"""Fit and integrate the polynomials that the FMUs exchange over a communication step.

A cubic is kept as the FMUs take it: value and three time derivatives at the step's beginning. All
of it may be arrays, of many steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import c_void_p
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmu.c_library import load_loop

Cubic = tuple[Any, ...]  # four: value and first to third time derivative at a step's beginning


def matched_cubics(first: Any, last: Any, mean: Any, moment: Any, h: Any) -> NDArray[np.float64]:
    """Return the cubics, a row each, of end values, means, first moments and lengths of steps."""
    return call_cubic_function("matched_cubics", (first, last, mean, moment, h))


def end_derivatives(cubic: Cubic, h: Any) -> Cubic:
    """Return value and derivatives of a cubic at the end of its step."""
    return tuple(np.moveaxis(call_cubic_function("continued_cubics", (*cubic, h)), -1, 0))


def call_cubic_function(name: str, numbers: Sequence[Any]) -> NDArray[np.float64]:
    """Return the cubics that a function of the compiled loop makes of five numbers each."""
    rows = np.ascontiguousarray(np.stack(np.broadcast_arrays(*numbers), axis=-1), dtype=float)
    cubics = np.empty((*rows.shape[:-1], 4))
    tables = (c_void_p(rows.ctypes.data), rows.size // 5, c_void_p(cubics.ctypes.data))
    getattr(load_loop("couple"), name)(*tables)
    return cubics


def mean_value(cubic: Cubic, h: Any) -> Any:
    f0, f1, f2, f3 = cubic
    return f0 + 0.5 * h * (f1 + h / 3.0 * (f2 + 0.25 * h * f3))


def normalized_coefficients(cubic: Cubic, h: Any) -> Cubic:
    """Convert a cubic's time derivatives to coefficients in s = t/h."""
    f0, f1, f2, f3 = cubic
    return f0, f1 * h, f2 * h * h / 2.0, f3 * h * h * h / 6.0


def integrate_product(f: Sequence[Any], g: Sequence[Any]) -> Any:
    """Integrate the product of two polynomials in s from 0 to 1."""
    total = 0.0
    for i, a in enumerate(f):
        for k, b in enumerate(g):
            total = total + a * b / (i + k + 1.0)
    return total


def matched_quartic(ends: tuple[Any, Any], slopes: tuple[Any, Any], mean: Any) -> tuple[Any, ...]:
    p0, p1 = ends
    d0, d1 = slopes
    rise = p1 - p0
    q = 30.0 * (mean - 0.5 * (p0 + p1) - (d0 - d1) / 12.0)
    return p0, d0, 3.0 * rise - 2.0 * d0 - d1 + q, d0 + d1 - 2.0 * rise - 2.0 * q, q
