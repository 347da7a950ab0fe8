"""Simulate accelerometers and the digitiser behind them, by SciPy's filters."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, firwin, resample_poly, sosfilt

from .system import Floats

PASSED = 0.84  # of half the sampling rate: corner of the filter against aliasing
TAPS = 46  # of it, for each sample left out: 80 dB from 0.95 of half the sampling rate on


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """One accelerometer: bandwidth, gain, delay and noise."""

    bandwidth: float = 2000.0  # Hz, 3 dB down
    order: int = 2  # of its low-pass filter (Butterworth)
    gain: float = 1.0  # 1.03 reads 3 % too much
    delay: float = 0.0  # s, beside that of the filter
    noise: float = 0.01  # standard deviation over the root mean square of the signal

    def read(self, signal: Floats, rate: float, factor: int, rng: np.random.Generator) -> Floats:
        """Return samples of a signal at `rate`, Hz, one of `factor`: filtered, late, with noise."""
        sections = butter(self.order, self.bandwidth, fs=rate, output="sos")
        taps = self.gain * delay_filter(antialiasing_filter(factor), self.delay * rate)
        sampled = resample_poly(sosfilt(sections, signal), 1, factor, window=taps)
        rms = float(np.sqrt(np.mean(sampled**2)))
        return np.asarray(sampled + self.noise * rms * rng.normal(size=sampled.shape))


def delay_filter(taps: Floats, steps: float) -> Floats:
    """Return a symmetric filter delayed by some steps, linear between whole numbers."""
    whole, part = int(steps), steps % 1.0
    long = np.pad(taps, whole + 1)
    return np.asarray((1.0 - part) * np.roll(long, whole) + part * np.roll(long, whole + 1))


@functools.lru_cache(maxsize=1)  # of one bench
def antialiasing_filter(factor: int) -> Floats:
    """Return a digitiser's symmetric anti-aliasing filter, whose delay is compensated."""
    count = 2 * (TAPS * factor // 2) + 1
    return np.asarray(firwin(count, PASSED / factor, window=("kaiser", 7.9)))
