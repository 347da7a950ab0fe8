"""Decide whether the speed at a constant voltage has settled, and at which mean speed.

- The record is cut into means over `block` revolutions; the first one is left out.
- The speed has *converged* where three limits in turn, extrapolated from successive means as an
  exponential approach (Aitken's process), agree within half of `tolerance`; by a fold the approach
  is slower than any exponential, and they do not.
- So where the last four changes are below a hundredth of `tolerance`, or the last five means go to
  and fro within 0.3 of it.
- An irregular motion has settled where three long means, each a third of `blocks`, differ by less
  than half of what the blocks scatter; its speed has an error then.
- All else has not settled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class SettledSettings:
    """Set block, tolerance and pace of the test for a settled speed."""

    block: int = 12  # revolutions of a mean; a multiple of the periods of most motions
    blocks: int = 48  # of the three long means of an irregular motion, together
    tolerance: float = 1e-4  # of the settled speed, over omega
    piece: float = 50.0  # simulated between two tests, in 1/omega


def settled_speed(speeds: np.ndarray, settings: SettledSettings) -> tuple[float, float]:
    """Return the mean speed at which a record settles and its error; NaN where it has not."""
    count = len(speeds) // settings.block
    means = speeds[: count * settings.block].reshape(count, settings.block).mean(axis=1)[1:]
    changes = np.diff(means)
    if len(changes) < 4:
        return math.nan, 0.0
    last = changes[-4:]
    if np.abs(last).max() < 0.01 * settings.tolerance:
        return float(means[-1]), 0.0
    if not (last > 0.0).all() and not (last < 0.0).all():
        if np.ptp(means[-5:]) < 0.3 * settings.tolerance:
            return float(means[-5:].mean()), 0.0
    else:
        ratios = last[1:] / last[:-1]
        if ratios.max() < 0.95:
            limits = means[-3:] + last[1:] * ratios / (1.0 - ratios)
            if np.ptp(limits) < 0.5 * settings.tolerance:
                return float(limits[-1]), 0.0
    if len(means) < settings.blocks:
        return math.nan, 0.0
    late = means[-settings.blocks :]
    thirds = late.reshape(3, -1).mean(axis=1)
    if np.ptp(thirds) < max(settings.tolerance, 0.5 * float(np.std(np.diff(late)))):
        error = max(float(np.ptp(thirds)), 0.35 * float(np.std(late)))
        return float(thirds.mean()), error
    return math.nan, 0.0
