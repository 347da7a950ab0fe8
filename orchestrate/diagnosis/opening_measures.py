"""Whether faces open: order 2 above its threshold, or two faces whose orders differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..constants import TURN
from ..laboratory.pieces import Floats
from .evidence import Evidence
from .order_windows import Complexes, moving_average

# Order 2 of the distance between two faces over their largest distance: the least of 15 benches
# that opened for a part of each period; they had 0.14 to 0.31
ORDER_2_OF_OPENING = 0.14


@dataclass(frozen=True)
class OpeningMeasures:
    """Hold order 2 beyond what a linear structure makes of the base's, with its threshold."""

    # over order 1, root mean squares of neighbouring windows, of the sensor that is furthest above
    # the threshold from which an order counts as seen; NaN where little moves
    ratio: Floats
    threshold: Floats
    # difference of two sensors' order 1 or 2 over its threshold; NaN with one sensor
    difference: Floats

    @property
    def largest_excess(self) -> float:
        """Largest ratio of order 2 over order 1, as a multiple of its threshold."""
        return float(np.nanmax(self.ratio / self.threshold))

    @property
    def ratio_at_largest_excess(self) -> float:
        """Ratio of order 2 over order 1 in the window where it exceeds its threshold most."""
        return float(self.ratio[np.nanargmax(self.ratio / self.threshold)])

    @property
    def is_order_2_seen(self) -> bool:
        return self.largest_excess > 1.0

    @property
    def is_opening_seen(self) -> bool:
        """Whether order 2 or the difference of two faces exceeds its threshold."""
        return self.is_order_2_seen or self.largest_sensor_difference > 1.0

    @property
    def largest_sensor_difference(self) -> float:
        """Largest difference of two sensors over its threshold; 0 with one sensor."""
        return float(np.nanmax(self.difference)) if np.isfinite(self.difference).any() else 0.0


def measure_opening(evidence: Evidence, bonded: Complexes) -> OpeningMeasures:
    """Compute order 2 of a record beyond that of a bonded structure, and its threshold."""
    beyond = evidence.measured_orders[:, 1] - bonded[:, 1]
    power = average_neighbours(np.nan_to_num(np.abs(beyond) ** 2))
    size, threshold = rms_of_order_1(evidence), order_2_thresholds(evidence)
    excess = np.sqrt(np.maximum(power - average_neighbours(evidence.floor**2), 0.0)) / size
    quiet = np.isnan(threshold)
    excess[quiet] = np.nan
    chosen = np.argmax(np.nan_to_num(excess / threshold), axis=0)
    take = (chosen, np.arange(len(chosen)))
    difference = scaled_sensor_difference(evidence, threshold)
    return OpeningMeasures(excess[take], threshold[take], difference)


def order_2_thresholds(evidence: Evidence) -> Floats:
    """Return order 2 over order 1 from which it counts, (sensors, windows); NaN if little moves."""
    size, floor, least = rms_of_order_1(evidence), evidence.floor, evidence.settings
    noise = least.order2_noise * evidence.noise[:, np.newaxis] / size
    between = least.order2_floor * np.sqrt(average_neighbours(floor**2)) / size
    found = np.maximum(np.maximum(noise, between), least.order2_ratio)
    quiet = size < least.response * evidence.order_1_size.max(axis=1, keepdims=True)
    return np.asarray(np.where(quiet, np.nan, found))


def smallest_visible_opening_by_window(evidence: Evidence, m1: float, m2: float) -> Floats:
    """Return the smallest opening that would be seen in each window, m; NaN where little moves."""
    shares = np.array([(m2, m1)[mass] for mass in evidence.sensor_masses]) / (m1 + m2)
    order2 = order_2_thresholds(evidence) * rms_of_order_1(evidence)
    moved = order2 / (2.0 * TURN * evidence.frequency) ** 2
    return np.asarray(np.fmin.reduce(moved / (ORDER_2_OF_OPENING * shares[:, None]), axis=0))


def rms_of_order_1(evidence: Evidence) -> Floats:
    """Return the root mean square of order 1 over neighbouring windows, by sensor, m/s2."""
    return np.sqrt(average_neighbours(np.abs(evidence.measured_orders[:, 0]) ** 2))


def average_neighbours(values: Floats) -> Floats:
    return np.stack([moving_average(row) for row in values])


def scaled_sensor_difference(evidence: Evidence, threshold: Floats) -> Floats:
    """Return the difference of two sensors over its threshold, the larger of orders 1 and 2."""
    if len(evidence.measured_orders) < 2:
        return np.full(threshold.shape[1], np.nan)
    (one, other), least = evidence.measured_orders, evidence.settings
    slope = -1j * TURN * evidence.frequency
    base = evidence.base_orders[:2]
    basis = np.stack([other[0], slope * other[0], base[0]], axis=1)
    real = np.concatenate([basis.real, basis.imag])
    gain, delay, share = np.linalg.lstsq(
        real, np.concatenate([one[0].real, one[0].imag]), rcond=None
    )[0]
    size, seen = rms_of_order_1(evidence)[0], np.fmax.reduce(threshold, axis=0)
    alike = (gain + np.outer((1.0, 2.0), slope) * delay) * other[:2] + share * base
    both = np.nan_to_num(one[:2] - alike)
    first, second = np.sqrt(average_neighbours(np.abs(both) ** 2)) / size
    power = average_neighbours(np.nan_to_num(np.abs(evidence.measured_orders[:, 1])) ** 2)
    order2 = np.sqrt(power).max(axis=0)
    limit = np.maximum(2.0**0.5 * seen, least.difference_order2 * order2 / size)
    return np.asarray(np.maximum(first / np.maximum(seen, least.difference), second / limit))
