"""Accelerations of both masses from their states by the equations of motion (6).

Springs, dampers and the other mass make a mass's absolute acceleration. That relative to the box is
the same minus the box's acceleration, which adds ``a Omega^2 sin(phase)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import gap_between
from ..model import Structure

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def in_touch(states: Floats, gap_offset: ArrayLike = 0.0) -> Flags:
    """Return, for each state, whether it is permanent contact: no gap and equal velocities."""
    together = gap_between(states, gap_offset) == 0.0
    touching: Flags = together & (states[..., 2] == states[..., 3])
    return touching


def absolute_accelerations(
    states: Floats, structure: Structure, touching: Flags | None = None
) -> Floats:
    """Return both masses' absolute accelerations, as accelerometers read between impacts."""
    together = in_touch(states, structure.gap_offset) if touching is None else touching
    s, x, v = structure, states[:, :2], states[:, 2:]
    both = s.m1 + s.m2
    apart = -(x * (s.k1 / s.m1, s.k2 / s.m2) + v * (s.d1 / s.m1, s.d2 / s.m2))
    joined = -(x * ((s.k1 + s.k2) / both) + v * ((s.d1 + s.d2) / both))
    if s.gap_offset:  # each is loaded by the other one's spring where it is at 0 itself
        joined = joined + np.array([s.k2 / both, -s.k1 / both]) * s.gap_offset
    return np.where(together[:, None], joined, apart)
