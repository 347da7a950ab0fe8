"""Whether faces part: even orders above their floor, and faces that do not move as one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from .evidence import Evidence
from .orders import Complexes, smoothed

Floats = NDArray[np.float64]
GROUP = 5  # neighbouring windows that are taken together
QUIET = 0.1  # of the largest order 1: windows where less moves are not taken
ABOVE, BESIDE = 5.0, 2.0  # times the noise; times what is between the orders, impacts' own too
LEAST = 0.005  # of order 1: sensors and bases that are not linear make less
LEAST_APART = 0.03  # of order 1: what two sensors on one body may differ by


@dataclass(frozen=True)
class EvenOrders:
    """Order 2 beyond what a linear structure makes of the base's, with the threshold for detection.

    Attributes
    ----------
    ratio, threshold : ndarray, shape (windows,)
        Over order 1, root mean squares of neighbouring windows, of the sensor that is furthest
        above the threshold from which an order counts as seen; NaN where little moves.
    apart : ndarray, shape (windows,)
        Difference of two sensors' order 1 over its size; NaN with one sensor.
    """

    ratio: Floats
    threshold: Floats
    apart: Floats

    @property
    def excess(self) -> float:
        """Largest ratio of order 2 over order 1, as a multiple of its threshold."""
        return float(np.nanmax(self.ratio / self.threshold))

    @property
    def largest(self) -> float:
        """Ratio of order 2 over order 1 in the window where it exceeds its threshold most."""
        return float(self.ratio[np.nanargmax(self.ratio / self.threshold)])

    @property
    def seen(self) -> bool:
        """Whether order 2 exceeds its threshold in any window."""
        return self.excess > 1.0

    @property
    def moved_apart(self) -> float:
        """Largest difference of two sensors over its threshold; 0 with one sensor."""
        size = self.apart / np.maximum(self.threshold, LEAST_APART)
        return float(np.nanmax(size)) if np.isfinite(size).any() else 0.0


def even_orders(evidence: Evidence, bonded: Complexes) -> EvenOrders:
    """Compute order 2 of a record beyond that of a bonded structure, and its threshold.

    Parameters
    ----------
    evidence : Evidence
    bonded : ndarray, shape (sensors, 3, windows)
        Orders that the best linear structure would show under the same base.
    """
    rows = [evidence.orders.channels.names.index(name) for name in evidence.orders.sensors]
    floor = evidence.orders.floor[rows][:, evidence.used]
    power = np.abs(evidence.measured[:, 1] - bonded[:, 1]) ** 2
    size = mean(np.abs(evidence.measured[:, 0]) ** 2)
    excess = np.sqrt(np.maximum(mean(np.nan_to_num(power)) - mean(floor**2), 0.0) / size)
    quiet = size < (QUIET * evidence.size.max(axis=1, keepdims=True)) ** 2
    excess[quiet] = np.nan
    noise = ABOVE * evidence.noise[:, np.newaxis] / np.sqrt(size)
    threshold = np.maximum(np.maximum(noise, BESIDE * np.sqrt(mean(floor**2) / size)), LEAST)
    threshold[quiet] = np.nan
    chosen = np.argmax(np.nan_to_num(excess / threshold), axis=0)
    take = (chosen, np.arange(len(chosen)))
    return EvenOrders(excess[take], threshold[take], difference(evidence, quiet.all(axis=0)))


def mean(values: Floats) -> Floats:
    """Return each sensor's values averaged over neighbouring windows."""
    return np.stack([smoothed(row, GROUP) for row in values])


def difference(evidence: Evidence, quiet: NDArray[np.bool_]) -> Floats:
    """Return the relative difference of two sensors' order 1, best gain and delay taken out."""
    first = evidence.measured[:, 0]
    if len(first) < 2:
        return np.full(first.shape[1], np.nan)
    one, other = first
    slope = -1j * TURN * evidence.frequency * other
    basis = np.stack([other, slope], axis=1)
    real = np.concatenate([basis.real, basis.imag])
    solution = np.linalg.lstsq(real, np.concatenate([one.real, one.imag]), rcond=None)[0]
    rest = smoothed(np.abs(one - basis @ solution) ** 2, GROUP)
    size = smoothed(np.abs(one) ** 2, GROUP)
    return np.where(quiet, np.nan, np.sqrt(rest / size))
