"""Harmonics over the first order, and total harmonic distortion, over the frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...lazy import xr
from ...model.ranges import checked_range
from ...response.labels import variable
from ..stepped_sine import SteppedSine
from ..swept_sine import SweptSine
from .channels import analysis_attributes
from .order_tracking import MOST_ORDERS, track_orders


def harmonics(
    record: xr.Dataset,
    *,
    highest: int = 5,
    phase: SweptSine | SteppedSine | ArrayLike | None = None,
    periods: float = 16.0,
    overlap: float = 0.5,
) -> xr.Dataset:
    """Compute harmonics and total harmonic distortion of a record of a swept sine.

    Parameters
    ----------
    record : xarray.Dataset
        As for :func:`orchestrate.frf`.
    highest : int
        Order up to which harmonics count, 2 to 50.
    phase : SweptSine, SteppedSine or array_like, optional
        As for :func:`orchestrate.track_orders`.
    periods, overlap : float
        As for :func:`orchestrate.track_orders`.

    Returns
    -------
    xarray.Dataset
        Over ``channel`` and ``time`` in s with the coordinate ``frequency`` in Hz: ``distortion``
        (THD), the root of the summed squares of the orders from 2 on over the amplitude of order 1;
        ``distortion_and_noise`` (THD+N), the same with all that is in no order; ``ratio``, over
        ``order`` too, each order over the first. ``sweep_rate`` in Hz/s.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> sweep = orchestrate.SweptSine(first=10.0, last=14.0, duration=60.0, acceleration=0.2)
    >>> answer = orchestrate.harmonics(orchestrate.shake(beam, sweep), phase=sweep)
    >>> bool(answer.distortion.sel(channel="acceleration1").max() > 0.01)
    True
    """
    number = round(checked_range("highest", highest, low=2, high=MOST_ORDERS))
    tracked = track_orders(record, orders=number, phase=phase, periods=periods, overlap=overlap)
    first = tracked.amplitude.sel(order=1.0, drop=True)
    higher = tracked.amplitude.sel(order=slice(2.0, None))
    squares = (higher**2).sum("order")  # what is above the sampling rate's reach counts as none
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = higher / first
        distortion = np.sqrt(squares) / first
        noise = np.sqrt(squares + 2.0 * tracked.residual**2) / first
    over, at_each = ("channel", "time"), ("channel", "order", "time")
    text = "total harmonic distortion"
    heading, _, title = tracked.attrs["title"].partition(": ")
    return xr.Dataset(
        {
            "ratio": variable(at_each, ratio.transpose(*at_each).values, "1", "order over order 1"),
            "distortion": variable(over, distortion.transpose(*over).values, "1", text),
            "distortion_and_noise": variable(
                over, noise.transpose(*over).values, "1", f"{text} and noise"
            ),
            "sweep_rate": tracked.sweep_rate,
        },
        higher.coords,
        analysis_attributes("harmonics", "Harmonics", title, periods=periods, overlap=overlap),
    )
