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
    s, both = structure, structure.m1 + structure.m2
    x1, x2, v1, v2 = np.moveaxis(states, -1, 0)
    felt = np.empty((len(states), 2))
    felt[:, 0] = -(s.k1 / s.m1 * x1 + s.d1 / s.m1 * v1)
    felt[:, 1] = -(s.k2 / s.m2 * x2 + s.d2 / s.m2 * v2)
    if len(rows := np.flatnonzero(together)):
        joined = -(
            (s.k1 + s.k2) / both * states[rows, :2] + (s.d1 + s.d2) / both * states[rows, 2:]
        )
        if s.gap_offset:  # each is loaded by the other one's spring where it is at 0 itself
            joined += np.array([s.k2 / both, -s.k1 / both]) * s.gap_offset
        felt[rows] = joined
    return felt
