"""Find prominent maxima and jumps in a sampled curve, such as a resonance curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Rows = NDArray[np.intp]
WINDOW = 3  # values: the least that can show a maximum of their own
NEIGHBOURS, JUMP_FACTOR = 2, 3.0  # of the curve's own slope, which a jump must stand out from


def prominent_maxima(curve: ArrayLike, prominence: float) -> Rows:
    """Return the indices of a curve's inner maxima whose relative prominence is enough.

    Examples
    --------
    >>> prominent_maxima([1.0, 2.0, 1.9, 2.0, 5.0, 2.0], 0.1)
    array([4])
    """
    from scipy.signal import find_peaks

    values = np.asarray(curve, dtype=float)
    ratios = np.log(np.maximum(values, np.finfo(float).tiny))
    indices: Rows = find_peaks(ratios, prominence=np.log1p(prominence))[0]
    return indices


def inside_irregular(irregular: ArrayLike) -> NDArray[np.bool_]:
    """Return, for each value of a curve, whether it lies in a range of irregular responses.

    Examples
    --------
    >>> inside_irregular([False, True, False, False, True, False, False]).astype(int)
    array([0, 1, 1, 1, 1, 0, 0])
    """
    from scipy.ndimage import binary_closing

    padded = np.pad(np.asarray(irregular, dtype=bool), WINDOW)
    inside: NDArray[np.bool_] = binary_closing(padded, np.ones(WINDOW))[WINDOW:-WINDOW]
    return inside


def jump_indices(curve: ArrayLike, minimum: float) -> Rows:
    """Return the indices after which a curve jumps: steps far larger than their neighbours.

    Examples
    --------
    >>> jump_indices([1.0, 1.1, 1.2, 2.0, 2.1, 2.2], 0.15)
    array([2])
    >>> jump_indices([1.0, 1.3, 1.7, 2.2, 2.9, 3.8], 0.15)
    array([], dtype=int64)
    """
    values = np.asarray(curve, dtype=float)
    steps = np.abs(np.diff(values))
    large = steps > minimum * np.maximum(np.abs(values[1:]), np.abs(values[:-1]))
    padded = np.pad(steps, NEIGHBOURS)
    shifts = [shift for shift in range(-NEIGHBOURS, NEIGHBOURS + 1) if shift]
    around = [np.roll(padded, shift)[NEIGHBOURS:-NEIGHBOURS] for shift in shifts]
    indices: Rows = np.flatnonzero(
        large & (steps > JUMP_FACTOR * np.max(around, axis=0, initial=0.0))
    )
    return indices
