"""Find prominent maxima and jumps in a sampled curve, such as a resonance curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rows = NDArray[np.intp]
WINDOW = 3  # values: the least that can show a maximum of their own
NEIGHBOURS, JUMP_FACTOR = 2, 3.0  # of the curve's own slope, which a jump must stand out from


def prominent_maximum_indices(curve: ArrayLike, prominence: float) -> Rows:
    """Return the indices of a curve's inner maxima whose relative prominence is enough."""
    from scipy.signal import find_peaks

    values = np.asarray(curve, dtype=float)
    ratios = np.log(np.maximum(values, np.finfo(float).tiny))
    indices: Rows = find_peaks(ratios, prominence=np.log1p(prominence))[0]
    return indices


def in_irregular_range(irregular: ArrayLike) -> NDArray[np.bool_]:
    """Return, for each value of a curve, whether it lies in a range of irregular responses."""
    from scipy.ndimage import binary_closing

    padded = np.pad(np.asarray(irregular, dtype=bool), WINDOW)
    inside: NDArray[np.bool_] = binary_closing(padded, np.ones(WINDOW))[WINDOW:-WINDOW]
    return inside


def jump_indices(curve: ArrayLike, minimum: float) -> Rows:
    """Return the indices after which a curve jumps: steps far larger than their neighbours."""
    values = np.asarray(curve, dtype=float)
    steps = np.abs(np.diff(values))
    large = steps > minimum * np.maximum(np.abs(values[1:]), np.abs(values[:-1]))
    padded = np.pad(steps, NEIGHBOURS)
    shifts = [shift for shift in range(-NEIGHBOURS, NEIGHBOURS + 1) if shift]
    around = [np.roll(padded, shift)[NEIGHBOURS:-NEIGHBOURS] for shift in shifts]
    steeper = steps > JUMP_FACTOR * np.max(around, axis=0, initial=0.0)
    indices: Rows = np.flatnonzero(large & steeper)
    return indices
