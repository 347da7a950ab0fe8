"""Shock response spectra: the largest acceleration of oscillators that a record shakes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ...errors import InputError
from ...lazy import xr
from ...model.arguments import checked_list
from ...model.ranges import checked_range
from ...response.labels import variable
from .channels import Channels, Floats, frequency_coordinate


def shock_spectrum(
    record: xr.Dataset, *, frequencies: ArrayLike | None = None, damping: float = 0.05
) -> xr.Dataset:
    """Compute the shock response spectra of a record's channels.

    Parameters
    ----------
    record : xarray.Dataset
        As for :func:`orchestrate.frf`; at rest before it begins.
    frequencies : array_like, optional
        Natural frequencies of the oscillators, Hz; by default 12 in an octave from one oscillation
        in the record to a tenth of the sampling rate.
    damping : float
        Damping ratio of the oscillators, 0 <= damping < 1; 0.05 is Q = 10.

    Returns
    -------
    xarray.Dataset
        Over ``channel`` and ``frequency`` in Hz, in m/s2: ``primary``, the largest absolute
        acceleration in space of the oscillator during the record; ``residual``, the largest one
        after it; ``maximax``, the larger of both. Scalar ``damping``.

    Notes
    -----
    The recursion is exact for a base acceleration that is straight between samples (ramp-invariant,
    ISO 18431-4; Smallwood, Shock and Vibration Bulletin 51, 1981). Where there are fewer than 40
    samples in the oscillator's period it runs at intermediate points of the same straight lines.
    Before and after the record the base's acceleration goes from and to zero within a sample.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> shock = orchestrate.Shock(peak=100.0, length=0.011, duration=0.1)
    >>> history = orchestrate.shake(beam, shock, sample_rate=20000.0)
    >>> answer = orchestrate.shock_spectrum(history, frequencies=[10.0, 70.0, 1000.0])
    >>> answer.maximax.sel(channel="box_acceleration").values.round(1)
    array([ 40.5, 164.8, 100.8])
    """
    channels = Channels.from_record(record)
    ratio = checked_range("damping", damping, low=0.0, high=1.0, open_high=True)
    natural = requested_or_default_frequencies(channels, frequencies)
    peaks = [primary_and_residual_peaks(channels, f, ratio) for f in natural.tolist()]
    primary, residual = np.transpose(peaks, (1, 2, 0))
    over = ("channel", "frequency")
    text = "largest absolute acceleration of the oscillator"
    return channels.result(
        "shock_spectrum",
        "Shock response spectrum",
        {
            "maximax": variable(over, np.maximum(primary, residual), "m/s2", text),
            "primary": variable(over, primary, "m/s2", f"{text} during the record"),
            "residual": variable(over, residual, "m/s2", f"{text} after the record"),
            "damping": variable((), ratio, "1", "damping ratio of the oscillators"),
        },
        {"frequency": frequency_coordinate(natural)},
    )


def requested_or_default_frequencies(channels: Channels, requested: ArrayLike | None) -> Floats:
    """Return the natural frequencies of the oscillators, Hz: as requested, or a default range."""
    highest = 0.1 * channels.sample_rate  # as ISO 18431-4 advises
    if requested is None:
        octaves = math.log2(highest * channels.duration)
        count = max(1, math.floor(octaves * 12))  # twelve in an octave
        return np.asarray(highest * 2.0 ** (np.arange(-count, 1) / 12))
    limit = 0.5 * channels.sample_rate
    range_of_all = f"> 0 and <= {limit:g} Hz, half the sampling rate"
    try:
        natural = np.array(checked_list("frequencies", requested))
    except InputError as error:
        raise InputError(f"{error}, {range_of_all}") from None
    if not ((natural > 0.0) & (natural <= limit)).all():
        raise InputError(f"frequencies = {requested!r}: expected numbers {range_of_all}")
    return natural


def primary_and_residual_peaks(
    channels: Channels, frequency: float, damping: float
) -> tuple[Floats, Floats]:
    """Compute an oscillator's largest absolute response; return it during and after the record."""
    from scipy.signal import lfilter

    rate = channels.sample_rate
    # a peak between samples is at most 0.3 % higher
    parts = max(1, math.ceil(40 * frequency / rate))
    # at rest a sample before the record and a sample after it, straight as elsewhere
    base = insert_interpolated_points(np.pad(channels.values, ((0, 0), (1, 1))), parts)
    end = base.shape[1] - 1
    # one period of the free vibration after the record has its largest value
    padded = np.pad(base, ((0, 0), (0, math.ceil(parts * rate / frequency))))
    filters = ramp_invariant_filter(frequency, damping, parts * rate)
    response = np.abs(lfilter(*filters, padded, axis=1))
    return response[:, : end + 1].max(axis=1), response[:, end:].max(axis=1)


def insert_interpolated_points(values: Floats, parts: int) -> Floats:
    """Insert points on the straight lines between samples."""
    if parts == 1:
        return values
    shares = np.arange(parts) / parts
    inner = values[:, :-1, None] + np.diff(values)[:, :, None] * shares
    return np.concatenate([inner.reshape(len(values), -1), values[:, -1:]], axis=1)


def ramp_invariant_filter(
    frequency: float, damping: float, rate: float
) -> tuple[list[float], list[float]]:
    """Return numerator and denominator of the ramp-invariant filter from base to response."""
    angle = 2.0 * math.pi * frequency / rate
    damped = angle * math.sqrt(1.0 - damping**2)
    decay = math.exp(-damping * angle)
    cosine, slope = decay * math.cos(damped), decay * math.sin(damped) / damped
    numerator = [1.0 - slope, 2.0 * (slope - cosine), decay**2 - slope]
    return numerator, [1.0, -2.0 * cosine, decay**2]
