"""Several sweeps in one record, as a test at several levels leaves them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..laboratory.pieces import Floats
from ..lazy import xr
from .order_windows import sensor_channels, sine_windows


def split_sweeps(record: xr.Dataset) -> list[xr.Dataset]:
    """Return the sweeps of a record as records; the record itself where it has one.

    - A sweep ends where the base has no sine for a second, or its frequency jumps by a fifth.
    - What lasts less than 2 s or covers less than a tenth of its frequency is no sweep.
    """
    windows = sine_windows(sensor_channels(record))[0]
    frequency, time = windows.frequency, windows.time
    jumps = np.abs(np.diff(frequency)) > 0.2 * frequency[:-1]
    ends = np.flatnonzero(jumps | (np.diff(time) > 1.0)) + 1  # s without a sine
    groups = [one for one in np.split(np.arange(len(time)), ends) if is_sweep(one, time, frequency)]
    if len(groups) < 2:
        return [record]
    parts = [slice(windows.parts[one[0]].start, windows.parts[one[-1]].stop) for one in groups]
    title = str(record.attrs.get("title", "record"))
    return [
        record.isel(time=part).assign_attrs(title=f"{title}, sweep {number}")
        for number, part in enumerate(parts, 1)
    ]


def is_sweep(group: NDArray[np.intp], time: Floats, frequency: Floats) -> bool:
    """Return whether a group of windows lasts long enough and covers enough frequencies."""
    if len(group) < 2:
        return False
    own = frequency[group]
    return bool(np.ptp(time[group]) >= 2.0 and np.ptp(own) >= 0.1 * own.mean())
