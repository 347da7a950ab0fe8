"""Decide whether the speed at a constant voltage has settled, and at which mean speed.

- The record is cut into means over `block` revolutions; the first one is left out.
- The speed has settled where its last `seen` changes are below `still` of `tolerance`, or, if they
  go to and fro, the means between them lie within `to_and_fro` of it.
- If they go one way, it has converged where the limits extrapolated from them as an exponential
  approach (Aitken's process) agree within `agreement` of the tolerance; an approach slower than
  `slowest` a block, as by a fold, has not converged.
- What has not settled by these, as an irregular motion, has where three long means, each a sixth of
  the record and a third of `blocks` or more, differ by less than the tolerance, or `scatter` of the
  standard deviation of the blocks' means there; its speed has an error then: the larger of both.
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
    blocks: int = 48  # of the three long means of an irregular motion, together, at least
    tolerance: float = 1e-4  # of the settled speed, over omega
    piece: float = 50.0  # simulated between two tests, in 1/omega
    seen: int = 4  # changes between blocks
    still: float = 0.01  # of the tolerance
    to_and_fro: float = 0.3  # of the tolerance
    slowest: float = 0.95  # of a change, what the next one is at most
    agreement: float = 0.5  # of the tolerance
    scatter: float = 0.5  # of the standard deviation of the blocks' means


def settled_speed(speeds: np.ndarray, settings: SettledSettings) -> tuple[float, float]:
    """Return the mean speed at which a record settles and its error; NaN where it has not."""
    count = len(speeds) // settings.block
    means = speeds[: count * settings.block].reshape(count, settings.block).mean(axis=1)[1:]
    changes = np.diff(means)
    if len(changes) < settings.seen:
        return math.nan, 0.0
    last = changes[-settings.seen :]
    if np.abs(last).max() < settings.still * settings.tolerance:
        return float(means[-1]), 0.0
    if not (last > 0.0).all() and not (last < 0.0).all():
        between = means[-settings.seen - 1 :]
        if np.ptp(between) < settings.to_and_fro * settings.tolerance:
            return float(between.mean()), 0.0
    else:
        ratios = last[1:] / last[:-1]
        if ratios.max() < settings.slowest:
            limits = means[1 - settings.seen :] + last[1:] * ratios / (1.0 - ratios)
            if np.ptp(limits) < settings.agreement * settings.tolerance:
                return float(limits[-1]), 0.0
    if len(means) < settings.blocks:
        return math.nan, 0.0
    late = means[-max(settings.blocks, len(means) // 2) :]
    late = late[len(late) % 3 :]
    thirds, scatter = late.reshape(3, -1).mean(axis=1), float(np.std(late))
    if np.ptp(thirds) < max(settings.tolerance, settings.scatter * scatter):
        return float(thirds.mean()), max(settings.tolerance, scatter)
    return math.nan, 0.0
