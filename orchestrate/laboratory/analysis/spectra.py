"""Power spectral densities of all channels, and amplitude spectra over the time: a waterfall."""

from __future__ import annotations

import numpy as np

from ...lazy import xr
from ...model.arguments import checked_word
from ...model.ranges import checked_range
from ...response.labels import variable
from .channels import (
    FEWEST_LINES,
    WINDOWS,
    Channels,
    divide_into_segments,
    frequency_coordinate,
    samples_per_segment,
)


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
        {"frequency": frequency_coordinate(frequency)},
        window=window,
        overlap=overlap,
    )


def spectrogram(
    record: xr.Dataset, *, resolution: float | None = None, spectra: int = 200, window: str = "hann"
) -> xr.Dataset:
    """Compute amplitude spectra of short parts of a record.

    Parameters
    ----------
    record : xarray.Dataset
        As for :func:`orchestrate.frf`.
    resolution : float, optional
        Distance of the lines, Hz; a part of the record takes 1/resolution.
    spectra : int
        How many at the most, at equal distances.
    window : str
        As for :func:`orchestrate.frf`.

    Returns
    -------
    xarray.Dataset
        ``amplitude`` in m/s2 over ``channel``, ``time`` in s (the middle of a part) and
        ``frequency`` in Hz: a steady sine on a line has its amplitude there, not its root mean
        square; scalar ``resolution``.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> sweep = orchestrate.SweptSine(first=10.0, last=14.0, duration=20.0, acceleration=0.2)
    >>> answer = orchestrate.spectrogram(orchestrate.shake(beam, sweep), resolution=1.0)
    >>> box = answer.amplitude.sel(channel="box_acceleration").sel(time=10.0, method="nearest")
    >>> float(box.idxmax())
    12.0
    """
    from scipy.signal import ShortTimeFFT

    channels = Channels.from_record(record)
    checked_word("window", window, WINDOWS)
    most = round(checked_range("spectra", spectra, low=1, high=100_000))
    count, rate = len(channels.time), channels.sample_rate
    # as many lines times spectra as 32 times the samples
    usual = min(max(int((32.0 * count) ** 0.5), FEWEST_LINES), count)
    length = samples_per_segment(channels, resolution) or usual
    hop = max(1, -(-(count - length) // most))
    as_amplitude = {"fft_mode": "onesided2X", "scale_to": "magnitude"}
    transform = ShortTimeFFT.from_window(window, rate, length, length - hop, **as_amplitude)
    first = -(-(length // 2) // hop)  # only whole parts: nothing is put before or after
    last = (count - (length - length // 2)) // hop
    amplitude = np.abs(transform.stft(channels.values, p0=first, p1=max(last, first) + 1))
    time = channels.time[0] + np.arange(first, max(last, first) + 1) * hop / rate
    over, text = ("channel", "time", "frequency"), "amplitude of a sine at the line"
    return channels.result(
        "spectrogram",
        "Spectra over the time",
        {
            "amplitude": variable(over, amplitude.transpose(0, 2, 1), "m/s2", text),
            "resolution": variable((), rate / length, "Hz", "distance of the lines"),
        },
        {
            "time": variable("time", time, "s", "time in the middle of the spectrum"),
            "frequency": frequency_coordinate(transform.f),
        },
        window=window,
    )
