"""Base accelerations of the virtual bench: swept and stepped sines, random noise."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from orchestrate.constants import TURN

from .system import Floats

RAMP = 0.25  # s, in which an excitation rises, and falls at its end


@dataclass(frozen=True)
class Excitation(ABC):
    """A base acceleration between two frequencies; ``level``: its amplitude without ramps."""

    first: float  # Hz
    last: float
    duration: float  # s
    level: float  # m/s2

    @abstractmethod
    def wave(self, time: Floats) -> Floats:
        """Return the acceleration over the level at times, without ramps."""

    def __call__(self, time: Floats) -> Floats:
        """Return the acceleration at times, m/s2."""
        window, left = np.ones(time.shape), np.minimum(time, self.duration - time)
        ends = left < RAMP
        window[ends] = np.sin(0.5 * np.pi * np.clip(left[ends] / RAMP, 0.0, 1.0)) ** 2
        return np.asarray(self.level * window * self.wave(time))


@dataclass(frozen=True)
class Swept(Excitation):
    """Sine swept from ``first`` to ``last`` Hz."""

    log: bool = False

    def phase(self, time: Floats) -> Floats:
        """Return the phase at times, rad."""
        rate = (self.last - self.first) / self.duration
        if not self.log:
            return np.asarray(TURN * (self.first + 0.5 * rate * time) * time)
        growth = math.log(self.last / self.first) / self.duration
        return np.asarray(TURN * self.first / growth * np.expm1(growth * time))

    def wave(self, time: Floats) -> Floats:
        return np.sin(self.phase(time))


@dataclass(frozen=True)
class Stepped(Excitation):
    """Sine in ``steps`` equal steps of frequency, with continuous phase."""

    steps: int = 40

    def wave(self, time: Floats) -> Floats:
        held = self.duration / self.steps
        frequency = np.linspace(self.first, self.last, self.steps)
        number = np.minimum((time / held).astype(int), self.steps - 1)
        before = np.concatenate([[0.0], np.cumsum(frequency) * held])[number]
        turns = before + frequency[number] * (time - number * held)
        return np.sin(TURN * turns)


@dataclass(frozen=True)
class Random(Excitation):
    """Gaussian noise of equal density between ``first`` and ``last`` Hz; ``level`` is its rms."""

    seed: int = 0

    @cached_property
    def spline(self) -> CubicSpline:
        """Cubic spline through noise samples at twenty times the highest frequency."""
        rate = 20.0 * self.last
        count = int(rate * (self.duration + 2.0 * RAMP)) + 8
        rng = np.random.default_rng(self.seed)
        lines = np.fft.rfftfreq(count, 1.0 / rate)
        inside = (lines >= self.first) & (lines <= self.last)
        parts = rng.normal(size=(2, *lines.shape)) * inside
        values = np.fft.irfft(parts[0] + 1j * parts[1], count)
        return CubicSpline(np.arange(count) / rate, values / values.std())

    def wave(self, time: Floats) -> Floats:
        return np.asarray(self.spline(time))
