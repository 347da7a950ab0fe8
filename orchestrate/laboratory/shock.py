"""A classical shock pulse."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..model.arguments import check_and_convert_fields
from .pieces import ERROR, Floats, Pieces, equal_nodes, max_phase_step
from .signals import ExcitationSignal, Level, Moment, Seconds, checked_duration


@dataclass(frozen=True, kw_only=True)
class Shock(ExcitationSignal):
    """A classical pulse (IEC 60068-2-27), with quiet before and after it.

    Parameters
    ----------
    peak : float
        m/s2.
    length : float
        Of the pulse, s.
    shape : str
        ``"half-sine"``, ``"sawtooth"`` (final peak) or ``"trapezoid"`` (rise and decay of a tenth
        each).
    delay : float
        Quiet before it, s.
    duration : float, optional
        Of all, s; by default twenty lengths after the pulse's beginning.

    Notes
    -----
    The box keeps the pulse's change of velocity: a shaker adds pulses before and after.
    """

    peak: Level
    length: Seconds
    shape: Literal["half-sine", "sawtooth", "trapezoid"] = "half-sine"
    delay: Moment = 0.0
    duration: float = 0.0

    def __post_init__(self) -> None:
        check_and_convert_fields(self)
        end = self.delay + self.length
        usual = end + 19.0 * self.length
        duration = checked_duration(self.duration, usual, end, "delay + length")
        object.__setattr__(self, "duration", duration)

    @property
    def label(self) -> str:
        return f"{self.shape} shock, {self.peak:.4g} m/s2 for {1e3 * self.length:.4g} ms"

    @property
    def usual_rate(self) -> float:
        return 100.0 / self.length

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        edges, error = self._piece_starts_and_error(accuracy)
        begin, end = self.delay, self.delay + self.length
        nodes = np.unique([0.0, *(begin + edges), end, self.duration])
        inside = (nodes[:-1] >= begin) & (nodes[1:] <= end)
        pulse = Pieces.interpolate(nodes, self._pulse_acceleration, error)
        return Pieces(nodes, np.where(inside[:, None], pulse.derivatives, 0.0), error)

    def _piece_starts_and_error(self, accuracy: float) -> tuple[Floats, float]:
        """Return where the pulse's pieces begin, s after its beginning, and their error bound."""
        if self.shape == "trapezoid":
            return self.length * np.array([0.0, 0.1, 0.9]), 0.0
        if self.shape == "sawtooth":
            return np.zeros(1), 0.0
        angles = equal_nodes(0.0, math.pi, max_phase_step(accuracy))
        error = self.peak * float(np.diff(angles).max()) ** 4 / ERROR
        return self.length * angles[:-1] / math.pi, error

    def _pulse_acceleration(self, time: Floats) -> Floats:
        """Return the acceleration at times within the pulse, m/s2; it does not hold outside."""
        part = (time - self.delay) / self.length
        if self.shape == "half-sine":
            return self.peak * np.sin(np.pi * part)
        if self.shape == "sawtooth":
            return self.peak * part
        return self.peak * np.minimum(np.minimum(10.0 * part, 10.0 * (1.0 - part)), 1.0)
