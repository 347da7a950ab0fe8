"""A sine whose frequency moves from one end of a range to the other, and its error bound."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..constants import TURN
from ..errors import InputError
from ..model.arguments import check_and_convert_fields
from ..model.ranges import Quantity
from . import signals
from .pieces import ERROR, Floats, Pieces, equal_nodes, max_phase_step, subdivide


@dataclass(frozen=True, kw_only=True)
class SweptSine(signals.Sine):
    """A sine whose frequency moves slowly from one end of a range to the other.

    Linear: ``A sin(2 pi (f0 t + (f1 - f0) t^2/(2 T)))``. Logarithmic, with L = ln(f1/f0):
    ``A sin(2 pi f0 T/L (exp(L t/T) - 1))``.

    Parameters
    ----------
    first, last : float
        Frequencies at the beginning and at the end, Hz; ``last < first`` sweeps down.
    acceleration : float or sequence of (float, float)
        Peak acceleration A, m/s2; or its profile as break points (Hz, m/s2), straight between them
        in log-log scales, which has to reach over all frequencies.
    duration : float, optional
        s.
    rate : float, optional
        In place of the duration: Hz/s where linear, octaves/min where logarithmic.
    spacing : str
        ``"linear"`` or ``"log"``.

    Examples
    --------
    >>> sweep = SweptSine(first=20.0, last=90.0, rate=1.0, spacing="log", acceleration=4.9)
    >>> round(sweep.duration, 1)
    130.2
    """

    first: signals.Hertz
    last: signals.Hertz
    acceleration: float | signals.Profile
    duration: float = 0.0
    rate: float | None = None
    spacing: Literal["linear", "log"] = "linear"

    def __post_init__(self) -> None:
        put = object.__setattr__
        check_and_convert_fields(self)
        if self.first == self.last:
            raise InputError(f"last = {self.last!r} Hz: expected another frequency than first")
        ends = sorted((self.first, self.last))
        level = signals.checked_level("acceleration", self.acceleration, *ends)
        put(self, "acceleration", level)
        values = {"duration": self.duration, "rate": self.rate}
        given = [f"{name} = {one!r}" for name, one in values.items() if signals.is_stated(one)]
        if len(given) != 1:
            said = " and ".join(given) or "nothing"
            raise InputError(f"{said} given: expected one of duration= and rate=")
        if signals.is_stated(self.rate):
            rate = signals.checked_quantity(Quantity("rate", "", "", 1e-9, 1e9), "rate", self.rate)
            octaves = math.log2(self.last / self.first)
            swept = self.last - self.first if self.spacing == "linear" else 60.0 * octaves
            put(self, "duration", abs(swept) / rate)
            put(self, "rate", None)
        duration = signals.checked_quantity(signals.SECONDS, "duration", self.duration)
        put(self, "duration", duration)

    @property
    def label(self) -> str:
        return f"swept sine {self.first:g} to {self.last:g} Hz in {self.duration:.4g} s"

    @property
    def usual_rate(self) -> float:
        return 20.0 * max(self.first, self.last)

    @property
    def _growth_rate(self) -> float:
        """Rate of the frequency: Hz/s if linear, ln(f1/f0)/T in 1/s if logarithmic."""
        if self.spacing == "linear":
            return (self.last - self.first) / self.duration
        return math.log(self.last / self.first) / self.duration

    def frequency(self, time: ArrayLike) -> Floats:
        t = np.asarray(time, dtype=float)
        if self.spacing == "linear":
            return np.asarray(self.first + self._growth_rate * t)
        return np.asarray(self.first * np.exp(self._growth_rate * t))

    def phase(self, time: ArrayLike) -> Floats:
        t = np.asarray(time, dtype=float)
        if self.spacing == "linear":
            return np.asarray(TURN * t * (self.first + 0.5 * self._growth_rate * t))
        return np.asarray(TURN * self.first / self._growth_rate * np.expm1(self._growth_rate * t))

    def time_of(self, frequency: float) -> float:
        if self.spacing == "linear":
            return (frequency - self.first) / self._growth_rate
        return math.log(frequency / self.first) / self._growth_rate

    def _times_of_phases(self, phase: Floats) -> Floats:
        growth, turns = self._growth_rate, phase / TURN
        if self.spacing == "linear":
            root = np.sqrt(np.maximum(self.first**2 + 2.0 * growth * turns, 0.0))
            return np.asarray(2.0 * turns / (self.first + root))
        return np.asarray(np.log1p(growth * turns / self.first) / growth)

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        end = float(self.phase(self.duration))
        self.check_piece_count(end, max_phase_step(accuracy), "sweep")
        phases = equal_nodes(0.0, end, max_phase_step(accuracy))
        nodes = self._times_of_phases(phases)
        corners = [0.0, *self._corner_times(), self.duration]
        nodes[0], nodes[-1] = 0.0, self.duration
        nodes = np.union1d(nodes, corners)
        wanted = accuracy * (float(self.level(corners).max()) or 1.0)
        while (parts := np.ceil((self._error_bounds(nodes) / wanted) ** 0.25 - 1e-3)).max() > 1.0:
            nodes = subdivide(nodes, np.maximum(parts, 1.0).astype(int))
        return Pieces.interpolate(nodes, self, float(self._error_bounds(nodes).max()))

    def _corner_times(self) -> list[float]:
        if isinstance(self.acceleration, float):
            return []
        times = [self.time_of(f) for f, _ in self.acceleration]
        return [time for time in times if 0.0 < time < self.duration]

    def _error_bounds(self, nodes: Floats) -> Floats:
        """Return each piece's error bound (:mod:`.pieces`) from the largest fourth derivative."""
        # of A sin(phase) by Leibniz's and Faa di Bruno's rules, each term at its largest
        ends = np.stack([nodes[:-1], nodes[1:]])
        f = self.frequency(ends)
        w = TURN * f.max(axis=0)
        linear, growth = self.spacing == "linear", abs(self._growth_rate)
        w2 = TURN * growth if linear else w * growth  # the phase's second derivative
        w3, w4 = (0.0, 0.0) if linear else (w * growth**2, w * growth**3)
        sine = [1.0, w, w**2 + w2, w**3 + 3.0 * w * w2 + w3]
        sine.append(w**4 + 6.0 * w**2 * w2 + 3.0 * w2**2 + 4.0 * w * w3 + w4)
        level = self._level_derivative_bounds(ends, f.min(axis=0))
        terms = [math.comb(4, k) * level[k] * np.asarray(sine[4 - k]) for k in range(5)]
        return np.asarray(np.diff(nodes) ** 4 * np.sum(terms, axis=0) / ERROR)

    def _level_derivative_bounds(self, ends: Floats, lowest: Floats) -> list[Floats]:
        """Return the largest derivatives (orders 0 to 4) of the level A ~ f^p on each piece."""
        top = self.level(ends).max(axis=0)
        if isinstance(self.acceleration, float):
            return [top, *(np.zeros_like(top) for _ in range(4))]
        corners, values = np.log(np.array(self.acceleration)).T
        slopes = np.diff(values) / np.diff(corners)
        middle = np.log(self.frequency(ends.mean(axis=0)))
        last = len(slopes) - 1
        p = slopes[np.clip(np.searchsorted(corners, middle) - 1, 0, last)]
        bounds, factor = [top], np.ones_like(top)
        for order in range(1, 5):
            if self.spacing == "linear":
                factor = factor * np.abs(p - order + 1) * abs(self._growth_rate) / lowest
            else:
                factor = factor * np.abs(p) * abs(self._growth_rate)
            bounds.append(top * factor)
        return bounds
