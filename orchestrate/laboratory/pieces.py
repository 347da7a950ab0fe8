"""A box acceleration as cubic pieces: the FMU's input is one cubic after the other, exactly.

A smooth signal is interpolated on each piece at the four Chebyshev points. The error is at most
``h^4/3072`` times the largest fourth derivative on a piece of length h (Davis, Interpolation and
Approximation, theorem 3.3.1); the pieces need not join, a jump of that size does not matter.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
CHEBYSHEV = np.cos(np.pi * (2.0 * np.arange(4) + 1.0) / 8.0)  # in [-1, 1]
POINTS = 0.5 * (1.0 + CHEBYSHEV)  # the same in [0, 1], parts of a piece
MONOMIALS = np.linalg.inv(np.vander(POINTS, 4, increasing=True))  # values -> coefficients
FACTORIALS = np.array([1.0, 1.0, 2.0, 6.0])
ERROR = 3072.0  # 4! 2^7: over it, h^4 max|a''''|


def max_phase_step(accuracy: float) -> float:
    """Return the longest piece of a sine, rad, whose cubic has a relative error of ``accuracy``."""
    return float((ERROR * accuracy) ** 0.25)


@dataclass(frozen=True)
class Pieces:
    """Cubics for consecutive intervals of time, as the FMU takes the box's acceleration."""

    nodes: Floats  # where they begin, and where the last one ends, s
    # of each at its beginning: acceleration, jerk, snap and crackle, m/s2 to m/s5
    derivatives: Floats
    error: float  # bound of the distance to the signal that they stand for, m/s2

    @classmethod
    def from_chebyshev_values(cls, nodes: Floats, values: Floats, error: float) -> Pieces:
        """Make the cubics through values at the four `POINTS` of each piece."""
        powers = np.diff(nodes)[:, None] ** np.arange(4)
        return cls(nodes, values @ MONOMIALS.T * FACTORIALS / powers, error)

    @classmethod
    def interpolate(cls, nodes: Floats, signal: Callable[[Floats], Floats], error: float) -> Pieces:
        """Interpolate a function of time by cubics."""
        lengths = np.diff(nodes)[:, None]
        return cls.from_chebyshev_values(nodes, signal(nodes[:-1, None] + POINTS * lengths), error)

    @property
    def duration(self) -> float:
        """Time at which the last piece ends, s."""
        return float(self.nodes[-1])

    def __call__(self, times: Floats) -> Floats:
        """Return the acceleration at times, m/s2; zero after the end, at it the last piece's."""
        values = self.derivatives_at(times)[:, 0]
        length = self.nodes[-1] - self.nodes[-2]
        last = self.derivatives[-1] * length ** np.arange(4) / FACTORIALS
        return np.where(times == self.nodes[-1], last.sum(), values)

    def derivatives_at(self, times: Floats) -> Floats:
        """Return value and three derivatives at times, shape (n, 4); zero from the end on."""
        last = len(self.derivatives) - 1
        index = np.clip(np.searchsorted(self.nodes, times, side="right") - 1, 0, last)
        t = times - self.nodes[index]
        a, b, c, d = self.derivatives[index].T
        shifted = [
            a + t * (b + t * (0.5 * c + t * d / 6.0)),
            b + t * (c + 0.5 * t * d),
            c + t * d,
            d,
        ]
        over = times >= self.nodes[-1]
        return np.where(over, 0.0, np.array(shifted)).T

    def __add__(self, other: Pieces) -> Pieces:
        nodes = np.union1d(self.nodes, other.nodes)
        starts = nodes[:-1]
        total = self.derivatives_at(starts) + other.derivatives_at(starts)
        return Pieces(nodes, total, self.error + other.error)


def equal_nodes(first: float, last: float, max_step: float) -> Floats:
    """Divide an interval into equal pieces not longer than ``max_step``; return their ends."""
    count = max(1, math.ceil((last - first) / max_step))
    return first + (last - first) * np.arange(count + 1) / count


def subdivide(nodes: Floats, parts: NDArray[np.int_]) -> Floats:
    """Cut each piece between two nodes into equal parts; return all nodes."""
    piece = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    inner = nodes[piece] + np.diff(nodes)[piece] * (part / parts[piece])
    return np.append(inner, nodes[-1])
