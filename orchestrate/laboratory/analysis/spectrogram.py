"""Amplitude spectra over the time: the waterfall of an analyser."""

from __future__ import annotations

import numpy as np

from ...lazy import xr
from ...model.arguments import checked_word
from ...model.ranges import checked_range
from ...response.labels import variable
from .channels import FEWEST_LINES, WINDOWS, Channels, samples_per_segment


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
            "frequency": variable("frequency", transform.f, "Hz", "frequency"),
        },
        window=window,
    )
