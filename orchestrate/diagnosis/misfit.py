"""How far a motion is from a record: one number of all residuals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

SOFT = 3.0  # residuals above count by their size, not its square: a jump may be a window off


def misfit(residuals: NDArray[np.float64]) -> float:
    """Return the root mean square of residuals, large ones by their size."""
    squares = 2.0 * SOFT**2 * (np.sqrt(1.0 + (residuals / SOFT) ** 2) - 1.0)
    return math.sqrt(float(np.mean(squares)))
