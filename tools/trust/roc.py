"""Receiver operating characteristics and Wilson's intervals of rates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


class RocCurve(NamedTuple):
    """Rates of true and false positives over falling thresholds."""

    # parts of the negative and of the positive cases above the threshold, from (0, 0) to (1, 1)
    false: Floats
    true: Floats
    threshold: Floats

    @property
    def area(self) -> float:
        """Area under the curve: chance that a positive case has the larger number, ties half."""
        return float(np.trapezoid(self.true, self.false))

    def true_rate_at(self, false: float) -> float:
        """Return the largest rate of true positives at no more than a rate of false ones."""
        return float(self.true[self.false <= false].max())


def compute_curve(numbers: ArrayLike, is_positive: ArrayLike) -> RocCurve:
    """Compute the ROC curve of numbers whose large values shall mean a positive case."""
    values = np.nan_to_num(np.asarray(numbers, dtype=float), nan=-np.inf)
    positive = np.asarray(is_positive, dtype=bool)
    if positive.all() or not positive.any():
        raise ValueError("a curve needs positive and negative cases")
    thresholds = np.unique(values)[::-1]
    above = values[np.newaxis, :] >= thresholds[:, np.newaxis]
    true = above[:, positive].mean(axis=1)
    false = above[:, ~positive].mean(axis=1)
    return RocCurve(np.append(0.0, false), np.append(0.0, true), np.append(np.inf, thresholds))


def area_error(area: float, positive: int, negative: int) -> float:
    """Return the standard error of an area (Hanley and McNeil 1982)."""
    both = area / (2.0 - area), 2.0 * area**2 / (1.0 + area)
    square = area * (1.0 - area)
    square += (positive - 1) * (both[0] - area**2) + (negative - 1) * (both[1] - area**2)
    return float(np.sqrt(max(square, 0.0) / (positive * negative)))


def wilson_interval(count: int, of: int) -> tuple[float, float]:
    """Return lower and upper end of Wilson's 95 % interval of a share."""
    if not of:
        return 0.0, 1.0
    z, part = 1.96, count / of
    middle = (part + z * z / (2.0 * of)) / (1.0 + z * z / of)
    half = z / (1.0 + z * z / of) * np.sqrt(part * (1.0 - part) / of + z * z / (4.0 * of * of))
    return float(max(middle - half, 0.0)), float(min(middle + half, 1.0))


def format_share(count: int, of: int) -> str:
    """Format a share with its 95 % interval, in per cent."""
    low, high = wilson_interval(count, of)
    if not of:
        return "none"
    return f"{100.0 * count / of:.1f} % of {of} ({100.0 * low:.1f} to {100.0 * high:.1f})"
