"""Base accelerations of the virtual bench: swept and stepped sines, random noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from orchestrate.constants import TURN

from .system import Floats


class Excitation(Protocol):
    """Protocol of a base excitation: its duration, and its acceleration at any times."""

    @property
    def duration(self) -> float:
        """Duration, s."""
        ...

    def __call__(self, time: Floats) -> Floats:
        """Return the acceleration at times, m/s2."""
        ...


def ramp_window(time: Floats, ramp: float, duration: float) -> Floats:
    """Return a window that rises from 0 to 1 in ``ramp`` seconds and falls at the end."""
    values = np.ones(time.shape)
    ends = (time < ramp) | (time > duration - ramp)
    inside = np.clip(np.minimum(time[ends], duration - time[ends]) / ramp, 0.0, 1.0)
    values[ends] = np.sin(0.5 * np.pi * inside) ** 2
    return values


@dataclass(frozen=True)
class Swept:
    """Sine swept from ``first`` to ``last`` Hz, with amplitude ``level`` in m/s2."""

    first: float
    last: float
    duration: float
    level: float
    log: bool = False
    ramp: float = 0.25

    def phase(self, time: Floats) -> Floats:
        """Return the phase at times, rad."""
        rate = (self.last - self.first) / self.duration
        if not self.log:
            return np.asarray(TURN * (self.first + 0.5 * rate * time) * time)
        growth = math.log(self.last / self.first) / self.duration
        return np.asarray(TURN * self.first / growth * np.expm1(growth * time))

    def __call__(self, time: Floats) -> Floats:
        """Return the acceleration at times, m/s2."""
        return self.level * ramp_window(time, self.ramp, self.duration) * np.sin(self.phase(time))


@dataclass(frozen=True)
class Stepped:
    """Sine in ``steps`` equal steps of frequency, with continuous phase."""

    first: float
    last: float
    duration: float
    level: float
    steps: int = 40
    ramp: float = 0.25

    def __call__(self, time: Floats) -> Floats:
        """Return the acceleration at times, m/s2."""
        held = self.duration / self.steps
        frequency = np.linspace(self.first, self.last, self.steps)
        number = np.minimum((time / held).astype(int), self.steps - 1)
        before = np.concatenate([[0.0], np.cumsum(frequency) * held])[number]
        turns = before + frequency[number] * (time - number * held)
        return self.level * ramp_window(time, self.ramp, self.duration) * np.sin(TURN * turns)


@dataclass(frozen=True)
class Random:
    """Gaussian noise of equal density between ``first`` and ``last`` Hz; ``level`` is its rms."""

    first: float
    last: float
    duration: float
    level: float
    seed: int = 0
    ramp: float = 0.25

    @cached_property
    def spline(self) -> CubicSpline:
        """Cubic spline through noise samples at twenty times the highest frequency."""
        rate = 20.0 * self.last
        count = int(rate * (self.duration + 2.0 * self.ramp)) + 8
        rng = np.random.default_rng(self.seed)
        lines = np.fft.rfftfreq(count, 1.0 / rate)
        inside = (lines >= self.first) & (lines <= self.last)
        parts = rng.normal(size=(2, *lines.shape)) * inside
        values = np.fft.irfft(parts[0] + 1j * parts[1], count)
        return CubicSpline(np.arange(count) / rate, values / values.std())

    def __call__(self, time: Floats) -> Floats:
        """Return the acceleration at times, m/s2."""
        ramp = ramp_window(time, self.ramp, self.duration)
        return np.asarray(self.level * ramp * self.spline(time))
