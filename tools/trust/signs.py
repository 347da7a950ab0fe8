"""Two model-free signs of a record, as a baseline beside the detector."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from scipy.signal import butter, sosfiltfilt
from scipy.stats import kurtosis

from orchestrate import track_orders
from orchestrate.errors import InputError

ABOVE = 300.0  # Hz
BEGIN = 0.5  # s that are left out at both ends
CHANNEL = "acceleration1"


def order_ratio(record: xr.Dataset) -> float:
    """Return order 2 over order 1 of mass 1, as roots of sums of squares over the sweep.

    NaN where there is no sweep.
    """
    try:
        tracked = track_orders(record, orders=2).amplitude.sel(channel=CHANNEL)
    except InputError:
        return math.nan
    first, second = (np.nansum(tracked.sel(order=order).values ** 2) for order in (1, 2))
    return float(np.sqrt(second / first))


def kurtosis_above(record: xr.Dataset) -> float:
    """Return the kurtosis of mass 1's acceleration above 300 Hz: 3 for Gaussian noise."""
    rate = float(record.attrs["sample_rate"])
    sections = butter(6, ABOVE, "highpass", fs=rate, output="sos")
    edge = int(BEGIN * rate)
    high = sosfiltfilt(sections, record[CHANNEL].values)[edge:-edge]
    return float(kurtosis(high, fisher=False))
