"""Whether faces open: order 2 above its floor, or two faces whose order 1 differs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from .evidence import Evidence
from .orders import Complexes, moving_average

Floats = NDArray[np.float64]
AVERAGED_WINDOWS = 5  # neighbouring windows that are taken together
MIN_RESPONSE = 0.1  # of the largest order 1: windows where less moves are not taken
# Threshold over the noise, and over the floor between the orders, which impacts raise too
NOISE_FACTOR, FLOOR_FACTOR = 5.0, 2.0
MIN_RATIO = 0.005  # of order 1: sensors and bases that are not linear make less
MIN_DIFFERENCE = 0.03  # of order 1: what two sensors on one body may differ by


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
        size = self.apart / np.maximum(self.threshold, MIN_DIFFERENCE)
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
    floor = evidence.orders.floor[rows][:, evidence.used_windows]
    power = np.abs(evidence.measured[:, 1] - bonded[:, 1]) ** 2
    size = averaged(np.abs(evidence.measured[:, 0]) ** 2)
    excess = np.sqrt(np.maximum(averaged(np.nan_to_num(power)) - averaged(floor**2), 0.0) / size)
    quiet = size < (MIN_RESPONSE * evidence.size.max(axis=1, keepdims=True)) ** 2
    excess[quiet] = np.nan
    noise = NOISE_FACTOR * evidence.noise[:, np.newaxis] / np.sqrt(size)
    threshold = np.maximum(
        np.maximum(noise, FLOOR_FACTOR * np.sqrt(averaged(floor**2) / size)), MIN_RATIO
    )
    threshold[quiet] = np.nan
    chosen = np.argmax(np.nan_to_num(excess / threshold), axis=0)
    take = (chosen, np.arange(len(chosen)))
    return EvenOrders(excess[take], threshold[take], sensor_difference(evidence, quiet.all(axis=0)))


def averaged(values: Floats) -> Floats:
    """Return each sensor's values averaged over neighbouring windows."""
    return np.stack([moving_average(row, AVERAGED_WINDOWS) for row in values])


def sensor_difference(evidence: Evidence, quiet: NDArray[np.bool_]) -> Floats:
    """Return the relative difference of two sensors' order 1, best gain and delay taken out."""
    first = evidence.measured[:, 0]
    if len(first) < 2:
        return np.full(first.shape[1], np.nan)
    one, other = first
    slope = -1j * TURN * evidence.frequency * other
    basis = np.stack([other, slope], axis=1)
    real = np.concatenate([basis.real, basis.imag])
    solution = np.linalg.lstsq(real, np.concatenate([one.real, one.imag]), rcond=None)[0]
    rest = moving_average(np.abs(one - basis @ solution) ** 2, AVERAGED_WINDOWS)
    size = moving_average(np.abs(one) ** 2, AVERAGED_WINDOWS)
    return np.where(quiet, np.nan, np.sqrt(rest / size))
