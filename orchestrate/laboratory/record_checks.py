"""Checks of a record's channels: what makes one doubtful, and what to do about it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
BAND = 1e-3  # of the peak-to-peak value: readings so close to an extreme are at it
PLATEAU = 3  # samples in a row at an extreme that no sine has


def clipped_share(values: Floats) -> float:
    """Return the share of samples at repeated extreme values, as a saturated channel has them.

    - A sample is at an extreme within 0.1 % of the peak-to-peak value, or one step of the digits.
    - It counts in a row of three or more such samples.
    - An extreme counts where these outnumber the samples in the ten times wider band next to it: of
      a sine, coarsely digitized or not, there are fewer than half as many.
    - It counts where it is a quarter of the peak-to-peak value or more from the median: a signal at
      rest is not saturated.

    Examples
    --------
    >>> sine = np.sin(np.linspace(0.0, 300.0, 9000))
    >>> clipped_share(sine), round(clipped_share(np.clip(sine, -0.5, 0.5)), 2)
    (0.0, 0.67)
    """
    ordered = np.sort(values)
    spread = float(ordered[-1] - ordered[0])
    steps = np.diff(ordered)
    if not spread > 0.0:
        return 0.0
    band = max(BAND * spread, 0.999 * float(steps[steps > 1e-9 * spread].min()))
    median, share = float(ordered[len(ordered) // 2]), 0.0
    for extreme in (ordered[0], ordered[-1]):
        distance = np.abs(values - extreme)
        at = distance < band
        row = np.convolve(at, np.ones(PLATEAU), "valid") > PLATEAU - 0.5
        repeated = int(np.convolve(row, np.ones(PLATEAU)).astype(bool).sum())
        near = int(((distance >= band) & (distance < 11.0 * band)).sum())
        if repeated > near and abs(extreme - median) >= 0.25 * spread:
            share += repeated / len(values)
    return share
