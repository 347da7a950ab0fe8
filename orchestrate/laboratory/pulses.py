"""Short pulses: a classical shock of the box, and the knock of a hammer on one of the halves."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Literal

import numpy as np

from ..model.arguments import check_and_convert_fields, whole
from ..model.ranges import Quantity
from .pieces import ERROR, Floats, Pieces, equal_nodes, max_phase_step
from .signals import ExcitationSignal, Level, Moment, Seconds, checked_duration, checked_quantity

LISTENED = 1000.0  # widths from a knock to the end of the record


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


@dataclass(frozen=True, kw_only=True)
class Hammer(ExcitationSignal):
    """A knock on a half: a force that is half a sine, with the box at rest.

    Knocks for averages, far enough from each other that the motion dies out, are added:
    ``one + other``. All of a sum are on the same half.

    Parameters
    ----------
    peak : float
        Largest force, N; negative against the direction of x.
    width : float
        Duration of the contact, s.
    at : float
        Beginning, s.
    half : int
        1 or 2.
    duration : float, optional
        Of all, s; by default a thousand widths after the knock's beginning.

    Examples
    --------
    >>> knock = Hammer(peak=20.0, width=0.004, at=0.1)
    >>> knock.duration, knock.drives
    (4.1, 'force1')
    """

    peak: Annotated[float, partial(checked_quantity, Quantity("peak", "N", "", -1e12, 1e12))]
    width: Seconds
    at: Moment = 0.0
    half: Annotated[int, whole(1, 2)] = 1
    duration: float = 0.0

    def __post_init__(self) -> None:
        check_and_convert_fields(self)
        usual, end = self.at + LISTENED * self.width, self.at + self.width
        duration = checked_duration(self.duration, usual, end, "at + width")
        object.__setattr__(self, "duration", duration)

    @property
    def drives(self) -> str:
        """Input of the FMU, and channel of records: force1 or force2."""
        return f"force{self.half}"

    @property
    def label(self) -> str:
        return f"hammer on half {self.half}, {self.peak:.4g} N for {1e3 * self.width:.4g} ms"

    @property
    def usual_rate(self) -> float:
        return 20.0 / self.width

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        pulse = Shock(
            peak=abs(self.peak), length=self.width, delay=self.at, duration=self.duration
        ).pieces(accuracy)
        return pulse if self.peak >= 0.0 else replace(pulse, derivatives=-pulse.derivatives)
