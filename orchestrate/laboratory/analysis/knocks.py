"""The knocks of an impulse hammer in a record of force, and the spectra of what follows them."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from ..pieces import Floats
from .channels import Channels, samples_per_segment


@dataclass(frozen=True)
class KnockSettings:
    """Thresholds of the rule of :class:`Knocks`."""

    beyond: float = 0.05  # of the largest force: a knock's part
    sparse: float = 0.1  # of a record: knocks take less of it, forces of other kinds more
    bounce: float = 0.1  # of the longest time between knocks: a second one before is a double hit
    left: float = 0.01  # what the exponential window leaves at a segment's end


KNOCKS = KnockSettings()


@dataclass(frozen=True)
class Knocks:
    """Knocks with the same time after each, by one rule.

    - A knock is a part in which the force is beyond `beyond` of its largest value; parts closer
      than the longest of them are one. Together they take less than `sparse` of the record.
    - Another within `bounce` of the longest time between two (or to the end) is a double hit,
      which is left out and named.
    - A segment begins a knock's length before it, or with the record, which does not begin within a
      knock, and ends before the next one, or by the resolution.
    - The force window is 0 further than a knock's length from it.
    - The exponential window, on force and responses alike, falls to `left` at the segment's end.
    """

    starts: tuple[int, ...]  # first samples of the segments
    length: int  # samples of a segment
    width: int  # samples of the longest knock
    rate: float  # Hz
    settings: KnockSettings = KNOCKS

    @classmethod
    def find_in_force(
        cls,
        force: Floats,
        channels: Channels,
        resolution: float | None,
        settings: KnockSettings = KNOCKS,
    ) -> Knocks | None:
        """Find the knocks in a force; None if it is of another kind."""
        beyond = np.flatnonzero(np.abs(force) > settings.beyond * np.abs(force).max())
        if not 0 < len(beyond) < settings.sparse * len(force):
            return None
        parts = np.split(beyond, np.flatnonzero(np.diff(beyond) > 1) + 1)
        width = max(part[-1] - part[0] + 1 for part in parts)
        parts = np.split(beyond, np.flatnonzero(np.diff(beyond) > width) + 1)
        width = int(max(part[-1] - part[0] + 1 for part in parts))
        knocks = np.array([part[0] for part in parts])
        begins = np.maximum(knocks - width, 0)
        gaps = np.diff([*begins, len(force)])
        bounce = settings.bounce * gaps.max()
        first = np.diff(begins, prepend=-len(force)) > bounce
        single = first & (gaps > bounce) & (knocks > 0)
        if (double := first & ~single).any():
            listed = ", ".join(f"{time:.6g}" for time in channels.time[begins[double]])
            text = f"double hits, or knocks in which the record begins, at {listed} s"
            if not single.any():
                text += "; expected a knock after which the hammer stays away"
                raise InputError(f"record: {text}")
            text = f"{double.sum()} of {first.sum()} knocks left out: {text}"
            warnings.warn(text, UserWarning, stacklevel=3)
        length = samples_per_segment(channels, resolution, int(gaps[single].min()))
        starts = tuple(int(begin) for begin in begins[single])
        return cls(starts, length, width, channels.sample_rate, settings)

    @property
    def window_decay(self) -> float:
        """Rate of the exponential window, 1/s, which is added to that of every vibration."""
        return -math.log(self.settings.left) * self.rate / self.length

    def compute_spectra(
        self, force: Floats, responses: Floats
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Return lines, Hz, and mean spectra of the force, the responses and between them."""
        from scipy.fft import rfft, rfftfreq

        time = np.arange(self.length) / self.rate
        fading, struck = np.exp(-self.window_decay * time), np.arange(self.length) < 3 * self.width
        rows = np.vstack([force, responses])
        rows = rows - np.median(rows, axis=1, keepdims=True)
        segments = np.stack([rows[:, n : n + self.length] for n in self.starts])
        segments[:, 0] *= struck
        lines = rfft(segments * fading, axis=2)
        one, others = lines[:, :1], lines[:, 1:]
        scale = 2.0 / (self.rate * self.length)
        powers = [np.mean(np.abs(part) ** 2, axis=0) * scale for part in (one, others)]
        cross = np.mean(np.conj(one) * others, axis=0) * scale
        return rfftfreq(self.length, 1.0 / self.rate), powers[0][0], powers[1], cross
