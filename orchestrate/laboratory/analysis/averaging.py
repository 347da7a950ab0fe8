"""Overlapping windowed segments (Welch), and how many independent averages they are worth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...errors import InputError
from ...model.arguments import checked_word
from .channels import Channels, checked_number

WINDOWS = ("hann", "hamming", "blackman", "blackmanharris", "flattop", "boxcar")
FEWEST_LINES = 8  # samples in a segment


@dataclass(frozen=True)
class Averaging:
    """How a record is divided into segments for Welch's method."""

    # samples of a segment, and those it shares with the next
    length: int
    overlap: int
    window: str  # of scipy.signal.get_window
    segments: int  # how many there are
    resolution: float  # distance of the lines, Hz

    @property
    def options(self) -> dict[str, Any]:
        """Keywords of :func:`scipy.signal.csd` and :func:`scipy.signal.welch`."""
        return {
            "window": self.window,
            "nperseg": self.length,
            "noverlap": self.overlap,
            "detrend": "constant",
        }

    @property
    def independent(self) -> float:
        """Number of independent segments that would have the same random error."""
        # overlapping segments are correlated by the squared correlation of the window with itself
        # (Welch, IEEE Trans. Audio Electroacoust. 15, 1967, 70-73)
        from scipy.signal import get_window

        w = get_window(self.window, self.length)
        hop, count = self.length - self.overlap, self.segments
        shifts = range(1, min(count, -(-self.length // hop)))
        shared = (float(w[: -s * hop] @ w[s * hop :]) / float(w @ w) for s in shifts)
        total = sum((1.0 - s / count) * c**2 for s, c in zip(shifts, shared, strict=True))
        return count / (1.0 + 2.0 * total)


def segment_length(channels: Channels, resolution: float | None) -> int:
    """Return the samples of a segment whose lines have a distance in Hz; 0 if none is given."""
    if resolution is None:
        return 0
    finest, coarsest = (channels.sample_rate / n for n in (len(channels.time), FEWEST_LINES))
    checked = checked_number("resolution", resolution, finest, coarsest, "Hz")
    return round(channels.sample_rate / checked)


def averaging(
    channels: Channels, resolution: float | None, window: str, overlap: float, fewest: int = 1
) -> Averaging:
    """Divide a record into overlapping windowed segments."""
    checked_word("window", window, WINDOWS)
    part = checked_number("overlap", overlap, 0.0, 0.95)
    count, rate = len(channels.time), channels.sample_rate
    length = segment_length(channels, resolution) or max(count // 16, FEWEST_LINES)
    shared = min(int(part * length), length - 1)
    segments = (count - shared) // (length - shared)
    if segments < fewest:
        text = f"{segments} segments in {channels.duration:.4g} s; expected at least {fewest}"
        raise InputError(f"resolution = {rate / length:.4g} Hz: {text}")
    return Averaging(length, shared, window, segments, rate / length)
