"""What every excitation is: an acceleration of the box, or a force, over time, and sums of them.

Each can be passed to the FMU as cubic pieces with a bound of their error (see :mod:`.pieces`).
The box's displacement is not needed: the structure feels only the acceleration.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import partial, reduce
from itertools import pairwise
from operator import add
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..constants import TURN
from ..errors import NOT_NUMBERS, InputError
from ..model.ranges import Quantity, as_scalar
from .pieces import Floats, Pieces

Profile = tuple[tuple[float, float], ...]  # frequency in Hz and what holds there, ascending
MOST_PIECES = 50_000_000
HERTZ = Quantity("frequency", "Hz", "", 1e-9, 1e9)
SECONDS = Quantity("duration", "s", "", 1e-9, 1e7)
LEVEL = Quantity("acceleration", "m/s2", "", 0.0, 1e12)
DENSITY = Quantity("psd", "m2/s4/Hz", "", 0.0, 1e24)


def checked_quantity(quantity: Quantity, name: str, value: object) -> float:
    """Return a number; raise, by the user's name for it, if it is outside its quantity's range."""
    own = Quantity(name, quantity.unit, "", quantity.minimum, quantity.maximum)
    return own.check(value)


def is_stated(value: object) -> bool:
    """Return whether an argument is given: neither None nor the number 0, NumPy's included."""
    number = value if np.ma.is_masked(value) else as_scalar(value)
    return number is not None and not (isinstance(number, (int, float)) and number == 0)


def checked_duration(value: object, usual: float, end: float, what: str) -> float:
    """Return a duration, by default the usual one, s; raise if it is below ``end``, named so."""
    duration = checked_quantity(SECONDS, "duration", value if is_stated(value) else usual)
    if duration < end:
        raise InputError(f"duration = {duration!r} s: expected at least {what} = {end:g} s")
    return duration


# types of fields that carry their checks
Hertz = Annotated[float, partial(checked_quantity, HERTZ)]
Seconds = Annotated[float, partial(checked_quantity, SECONDS)]
Moment = Annotated[float, partial(checked_quantity, Quantity("time", "s", "", 0.0, 1e7))]
Level = Annotated[float, partial(checked_quantity, LEVEL)]


def checked_profile(name: str, points: object, quantity: Quantity) -> Profile:
    """Return break points (Hz, value); raise unless their frequencies ascend."""
    expected = "expected pairs (Hz, value) with ascending frequencies, at least two"
    try:
        pairs = [(float(f), float(value)) for f, value in points]  # type: ignore[attr-defined]
    except NOT_NUMBERS:
        raise InputError(f"{name} = {points!r}: {expected}") from None
    for f, value in pairs:
        checked_quantity(HERTZ, f"{name}'s frequency", f)
        checked_quantity(quantity, f"{name} at {f:g} Hz", value)
        if value == 0.0:
            raise InputError(f"{name} at {f:g} Hz = 0.0: expected a number > 0 at break points")
    ascending = all(one[0] < other[0] for one, other in pairwise(pairs))
    if len(pairs) < 2 or not ascending:
        raise InputError(f"{name} = {tuple(pairs)!r}: {expected}")
    return tuple(pairs)


def checked_level(name: str, value: object, low: float, high: float) -> float | Profile:
    """Return a peak acceleration, m/s2, or its profile, which must cover ``low`` to ``high``."""
    if not isinstance(value, (tuple, list, np.ndarray)):
        return checked_quantity(LEVEL, name, value)
    profile = checked_profile(name, value, LEVEL)
    if not profile[0][0] <= low <= high <= profile[-1][0]:
        ends = f"{profile[0][0]:g} to {profile[-1][0]:g} Hz"
        raise InputError(f"{name}: its profile is of {ends}; expected {low:g} to {high:g}")
    return profile


def format_level(level: float | Profile) -> str:
    """Format a peak acceleration; of a profile its lowest and its highest one."""
    values = [level] if isinstance(level, float) else [value for _, value in level]
    return " to ".join(f"{end:.4g} m/s2" for end in dict.fromkeys((min(values), max(values))))


def interpolate_profile(profile: Profile, frequency: Floats) -> Floats:
    """Interpolate a profile between break points in log-log scales; 0 outside."""
    corners, values = np.log(np.array(profile)).T
    inside = (frequency >= profile[0][0]) & (frequency <= profile[-1][0])
    with np.errstate(divide="ignore"):
        interpolated = np.exp(np.interp(np.log(frequency), corners, values))
    return np.where(inside, interpolated, 0.0)


class ExcitationSignal(ABC):
    """An acceleration of the box, or a force on a half, over a time that begins at 0.

    ``one + other`` is both together; ``duration`` is in s.
    """

    duration: float

    @property
    def drives(self) -> str:
        """Input of the FMU that it is, and channel of records."""
        return "box_acceleration"

    @property
    @abstractmethod
    def label(self) -> str:
        """Short description for names of files."""

    @property
    def description(self) -> str:
        """Description with the level, for titles; by default the label."""
        return self.label

    @property
    @abstractmethod
    def usual_rate(self) -> float:
        """Default sampling rate, Hz, at which all of the signal is seen."""

    @abstractmethod
    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        """Return it as cubic pieces."""

    def __add__(self, other: ExcitationSignal) -> SumOfSignals:
        if not isinstance(other, ExcitationSignal):
            return NotImplemented
        return SumOfSignals((*parts_of(self), *parts_of(other)))


class Sine(ExcitationSignal):
    """A sine whose frequency and level change over the time."""

    acceleration: float | Profile

    @property
    def description(self) -> str:
        """Frequencies, duration and peak acceleration, for titles."""
        return f"{self.label} at {format_level(self.acceleration)}"

    @abstractmethod
    def frequency(self, time: ArrayLike) -> Floats:
        """Return the frequency at a time, Hz."""

    @abstractmethod
    def phase(self, time: ArrayLike) -> Floats:
        """Return the phase at a time, rad."""

    def level(self, time: ArrayLike) -> Floats:
        if isinstance(self.acceleration, float):
            return np.full(np.shape(time), self.acceleration)
        low, high = self.acceleration[0][0], self.acceleration[-1][0]
        return interpolate_profile(self.acceleration, np.clip(self.frequency(time), low, high))

    def __call__(self, time: ArrayLike) -> Floats:
        return np.asarray(self.level(time) * np.sin(self.phase(time)))

    def check_piece_count(self, phase: float, max_step: float, name: str) -> None:
        """Raise if a sine up to this phase, rad, has more pieces of a length than are allowed."""
        if phase > MOST_PIECES * max_step:
            text = f"expected less than {MOST_PIECES * max_step / TURN:.3g}"
            raise InputError(f"the {name} has {phase / TURN:.3g} oscillations: {text}")


def parts_of(signal: ExcitationSignal) -> tuple[ExcitationSignal, ...]:
    return signal.parts if isinstance(signal, SumOfSignals) else (signal,)


@dataclass(frozen=True)
class SumOfSignals(ExcitationSignal):
    """A sum of signals, over the longest of them; made by ``+``."""

    parts: tuple[ExcitationSignal, ...]
    duration: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", max(part.duration for part in self.parts))
        if len(driven := dict.fromkeys(part.drives for part in self.parts)) > 1:
            text = "expected only signals of the box's acceleration, or only knocks on one half"
            raise InputError(f"a sum of {' and '.join(driven)}: {text}")

    @property
    def drives(self) -> str:
        return self.parts[0].drives

    @property
    def label(self) -> str:
        return " + ".join(part.label for part in self.parts)

    @property
    def description(self) -> str:
        return " + ".join(part.description for part in self.parts)

    @property
    def usual_rate(self) -> float:
        """Default sampling rate, Hz: the highest that one of the parts needs."""
        return max(part.usual_rate for part in self.parts)

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        return reduce(add, (part.pieces(accuracy) for part in self.parts))
