"""Bursts at high frequencies once a period, as faces make them that strike each other.

Each impact shakes the structure up to high frequencies, where a sweep through its resonance leaves
nothing but noise. A sensor that hardly moves with the opening (it sits beyond the end of a short
delamination) hears the impacts still, while its order 2 stays below any threshold.

Dry friction shakes it too, at both ends of the stroke, half a period apart and with opposite signs:
half the sum of the signal and of itself half a period later, which holds the even orders, does not
show it. Of one impact a period half the power is in this even part, and half in the odd one.

Samples that are missing make single bursts: what comes in less than a third of the periods of an
interval does not count, so that motions with an impact every third period are heard still.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from ..laboratory.analysis.channels import BOX, Channels
from ..laboratory.analysis.orders import EDGE, measured_phase
from ..laboratory.pieces import Floats
from .response_signs import default_band_edge
from .settings import SETTINGS, Settings

MIN_INTERVALS = 16  # means of the power at least
FINER = 4  # samples of the finer grid on which a signal half a period later is read


def burst_excess(channels: Channels, highest: float, settings: Settings = SETTINGS) -> float:
    """Return the power of bursts once a period, over the threshold above which they count."""
    edge = default_band_edge(channels, highest)
    phase = np.maximum.accumulate(measured_phase(channels))
    ends = phase[0] + 2.0 * math.pi * EDGE, phase[-1] - 2.0 * math.pi * EDGE
    first, last = np.searchsorted(phase, ends)
    width = min(
        round(settings.burst_time * channels.sample_rate), int(last - first) // MIN_INTERVALS
    )
    if math.isnan(edge) or width < MIN_INTERVALS:
        return math.nan
    share = 1.0 - 2.0 * edge / channels.sample_rate
    deviation = math.sqrt(2.0 / (0.5 * share * width))  # neighbours hang together by half a period
    threshold = max(settings.burst_rise, 1.0 + settings.burst_deviations * deviation)
    rows = [row for row, name in enumerate(channels.names) if name != BOX]
    part = slice(int(first), int(last))
    rises = [
        one_sided_rise(high_band(channels, row, edge), phase, part, width, settings) for row in rows
    ]
    return max(rises) / threshold


def high_band(channels: Channels, row: int, edge: float) -> Floats:
    """High-pass a channel above a frequency in Hz, without delaying it."""
    from scipy.signal import butter, sosfiltfilt

    sections = butter(4, edge, "highpass", fs=channels.sample_rate, output="sos")
    return np.asarray(sosfiltfilt(sections, channels.values[row]))


def one_sided_rise(
    signal: Floats, phase: Floats, part: slice, width: int, settings: Settings
) -> float:
    """Return how far bursts on one side of the stroke rise over noise, as a ratio of powers."""
    from scipy.signal import resample_poly

    later = np.interp(phase[part] + math.pi, phase, np.arange(len(phase)))
    finer = np.asarray(resample_poly(signal, FINER, 1))
    opposite = np.interp(later, np.arange(len(finer)) / FINER, finer)
    turns = ((phase[part] - phase[part.start]) / TURN).astype(int)
    most = 1.0 - settings.burst_periods
    even, odd = (
        mean_power(0.5 * (signal[part] + s * opposite), turns, width, most) for s in (1.0, -1.0)
    )
    noise = [float(np.quantile(power, settings.quiet)) for power in (even, odd)]
    if not min(noise) > 0.0:
        return 0.0
    one_sided = even - noise[0] >= settings.one_sided * (odd - noise[1])
    return float(np.max(np.where(one_sided, even / noise[0], 0.0)))


def mean_power(signal: Floats, turns: NDArray[np.intp], width: int, most: float) -> Floats:
    """Return mean squares over half overlapping intervals; single loud periods are clipped."""
    count = np.maximum(np.bincount(turns), 1)
    power = np.bincount(turns, signal**2) / count
    begins = turns[np.arange(0, len(signal) - width + 1, max(width // 2, 1))]
    ends = turns[np.arange(width - 1, len(signal), max(width // 2, 1))] + 1
    means = []
    for begin, end in zip(begins, ends, strict=True):
        limit = np.quantile(power[begin:end], most, method="lower")
        means.append(np.average(np.minimum(power[begin:end], limit), weights=count[begin:end]))
    return np.array(means)
