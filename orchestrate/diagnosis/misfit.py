"""The distance of a motion from a record: the soft root mean square of its residuals."""

from __future__ import annotations

import math

import numpy as np

from ..laboratory.pieces import Floats

SOFT_LIMIT = 3.0  # residuals above count by their size, not its square: a jump may be a window off


def soft_squares(residuals: Floats) -> Floats:
    """Return the soft l1 loss: squares of small residuals, sizes of large ones."""
    return np.asarray(2.0 * SOFT_LIMIT**2 * (np.sqrt(1.0 + (residuals / SOFT_LIMIT) ** 2) - 1.0))


def soft_weights(residuals: Floats) -> Floats:
    """Return the derivative of the soft l1 loss over that of the plain squares."""
    return np.asarray(1.0 / np.sqrt(1.0 + (residuals / SOFT_LIMIT) ** 2))


def misfit(residuals: Floats) -> float:
    """Return the square root of the mean soft l1 loss of the residuals."""
    return math.sqrt(float(np.mean(soft_squares(residuals))))
