"""Power spectral densities of all channels."""

from __future__ import annotations

import numpy as np

from ...lazy import xr
from ...response.labels import variable
from .channels import Channels, divide_into_segments


def psd(
    record: xr.Dataset,
    *,
    resolution: float | None = None,
    window: str = "hann",
    overlap: float = 0.5,
) -> xr.Dataset:
    """Estimate the one-sided power spectral densities of a record's channels.

    Parameters
    ----------
    record : xarray.Dataset
        As for :func:`orchestrate.frf`.
    resolution : float, optional
        Distance of the lines, Hz; by default 16 segments fit into the record.
    window : str
        As for :func:`orchestrate.frf`.
    overlap : float
        Part of a segment that the next one shares.

    Returns
    -------
    xarray.Dataset
        ``psd`` in m2/s4/Hz over ``channel`` and ``frequency`` in Hz; ``rms`` in m/s2, the root of
        its integral, over ``channel``; scalars ``random_error`` (standard deviation of a line
        relative to it), ``averages`` and ``resolution``.

    Notes
    -----
    Welch's method; mean values are removed from each segment.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> noise = orchestrate.Random(psd=[(2.0, 0.01), (30.0, 0.01)], duration=60.0, seed=1)
    >>> answer = orchestrate.psd(orchestrate.shake(beam, noise), resolution=0.5)
    >>> round(float(answer.rms.sel(channel="box_acceleration")), 2), round(noise.rms, 2)
    (0.53, 0.53)
    """
    from scipy.signal import welch

    channels = Channels.from_record(record)
    segments = divide_into_segments(channels, resolution, window, overlap)
    frequency, density = welch(channels.values, channels.sample_rate, **segments.scipy_options)
    rms = np.sqrt(density.sum(axis=-1) * segments.resolution)
    independent, text = segments.independent_count, "standard deviation of a line over the line"
    return channels.result(
        "psd",
        "Power density",
        {
            "psd": variable(("channel", "frequency"), density, "m2/s4/Hz", "power density"),
            "rms": variable("channel", rms, "m/s2", "root mean square about the mean value"),
            "random_error": variable((), independent**-0.5, "1", text),
            "averages": variable((), independent, "1", "independent averages"),
            "resolution": variable((), segments.resolution, "Hz", "distance of the lines"),
        },
        {"frequency": variable("frequency", frequency, "Hz", "frequency")},
        window=window,
        overlap=overlap,
    )
