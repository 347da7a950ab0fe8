"""Accelerations of both masses from their states by the equations of motion (6).

Springs, dampers and the other mass make a mass's absolute acceleration. That relative to the box is
the same minus the box's acceleration, which adds ``a Omega^2 sin(phase)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import gap_between, library, traits
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
    rows, flags = np.ascontiguousarray(states, dtype=float), np.ascontiguousarray(together)
    felt, numbers = np.empty((len(rows), 2)), traits(structure)
    places = (part.ctypes.data for part in (flags, felt))
    library().find_accelerations(rows.ctypes.data, len(rows), numbers, *places)
    return felt
