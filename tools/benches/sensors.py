"""Simulate accelerometers and the digitiser behind them, by SciPy's filters."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, firwin, resample_poly, sosfilt

from .system import Floats

PASSED = 0.84  # of half the sampling rate: corner of the filter against aliasing
TAPS = 46  # of it, for each sample left out: 80 dB from 0.95 of half the sampling rate on


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """One accelerometer: bandwidth, gain, delay, noise and range.

    Attributes
    ----------
    bandwidth : float
        Hz, 3 dB down.
    order : int
        Of its low-pass filter (Butterworth).
    gain : float
        1.03 reads 3 % too much.
    delay : float
        s, beside that of the filter.
    noise : float
        Standard deviation over the root mean square of the signal.
    range : float
        Largest reading over the largest value of the signal: below 1 the sensor saturates.
    """

    bandwidth: float = 2000.0
    order: int = 2
    gain: float = 1.0
    delay: float = 0.0
    noise: float = 0.01
    range: float = math.inf

    def read(self, signal: Floats, rate: float, factor: int, rng: np.random.Generator) -> Floats:
        """Return the samples that the sensor gives of a signal: filtered, delayed, with noise.

        Parameters
        ----------
        signal : ndarray
            At the integration's rate.
        rate : float
            That, Hz.
        factor : int
            Each how many of these are one sample.
        rng : numpy.random.Generator
        """
        sections = butter(self.order, self.bandwidth, fs=rate, output="sos")
        taps = self.gain * delay_filter(antialiasing_filter(factor), self.delay * rate)
        sampled = resample_poly(sosfilt(sections, signal), 1, factor, window=taps)
        rms = float(np.sqrt(np.mean(sampled**2)))
        noisy = np.asarray(sampled + self.noise * rms * rng.normal(size=sampled.shape))
        if math.isinf(self.range):
            return noisy
        largest = self.range * float(np.abs(sampled).max())
        return np.clip(noisy, -largest, largest)


def delay_filter(taps: Floats, steps: float) -> Floats:
    """Return a symmetric filter delayed by some steps, linear between whole numbers."""
    whole, part = int(steps), steps % 1.0
    long = np.pad(taps, whole + 1)
    return np.asarray((1.0 - part) * np.roll(long, whole) + part * np.roll(long, whole + 1))


@functools.cache
def antialiasing_filter(factor: int) -> Floats:
    """Return a digitiser's symmetric anti-aliasing filter, whose delay is compensated."""
    count = 2 * (TAPS * factor // 2) + 1
    return np.asarray(firwin(count, PASSED / factor, window=("kaiser", 7.9)))
