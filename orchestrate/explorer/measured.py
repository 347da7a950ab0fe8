"""Convert a measured record to the page's JSON: orders of a swept sine, or a spectrum."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import InputError
from ..laboratory.analysis.channels import BOX, Channels, Floats
from ..laboratory.analysis.order_tracking import track_orders
from ..lazy import xr
from ..response.spectra import amplitude_spectrum

FACE = "acceleration1"  # whose spectrum the page shows
ORDERS = 5
SWEPT = 0.01  # over the mean frequency: a sine whose frequency changes by more is swept
MOST = 4000  # points of a line


def record_json(record: xr.Dataset | None) -> dict[str, Any]:
    """Return what the page draws of half 1 over the model's spectrum.

    - The box moves as a sine whose frequency changes by more than ``SWEPT``: orders 1 to 5 as
      :func:`orchestrate.track_orders` has them. A spectrum would be smeared.
    - All else: the amplitude spectrum.
    """
    if record is None:
        return {"record": None}
    channels = Channels.from_record(record, (BOX, FACE))
    if orders := swept_sine_orders(record):
        return {"record": {"title": channels.title, "orders": orders}}
    face: Floats = channels.values[channels.names.index(FACE)]
    frequency, amplitude = amplitude_spectrum(face - face.mean(), 1.0 / channels.sample_rate)
    wide = -(-len(amplitude) // MOST)  # of lines that share a point, the largest
    padded = np.pad(amplitude, (0, -len(amplitude) % wide)).reshape(-1, wide)
    largest = padded.argmax(axis=1) + wide * np.arange(len(padded))
    hertz = frequency[largest] / (2.0 * np.pi)
    lines = {"frequency": hertz.tolist(), "amplitude": amplitude[largest].tolist()}
    return {"record": {"title": channels.title, "lines": lines}}


def swept_sine_orders(record: xr.Dataset) -> dict[str, Any] | None:
    """Return the frequencies of a swept sine, Hz, and a row of amplitudes for each order; None if
    the record is of another kind.
    """
    try:
        tracked = track_orders(record, orders=ORDERS)
    except InputError:  # the box does not move as a sine
        return None
    frequency = tracked.frequency.values
    if np.ptp(frequency) <= SWEPT * frequency.mean():
        return None
    rows = tracked.amplitude.sel(channel=FACE).transpose("order", "time").values
    rows = np.where(np.isfinite(rows), rows, 0.0)  # above half the sampling rate
    kept = np.argsort(frequency)[:: -(-len(frequency) // MOST)]
    return {"frequency": frequency[kept].tolist(), "amplitude": rows[:, kept].tolist()}
