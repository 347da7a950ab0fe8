"""The voltage of the motor over time."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from ..errors import InputError


def check(
    name: str, value: float, unit: str, low: float = -math.inf, high: float = math.inf
) -> None:
    """Check that a number is finite and in a range, both ends included.

    Raises
    ------
    InputError
    """
    if not (math.isfinite(value) and low <= value <= high):
        ends = f"{low:g} <= {name}" if high == math.inf else f"{low:g} <= {name} <= {high:g}"
        expected = "a finite number" if low == -math.inf else ends
        raise InputError(f"{name} = {value} {unit}: expected {expected}")


@dataclass(frozen=True)
class Schedule(ABC):
    """A voltage over time; subclasses say which."""

    @property
    @abstractmethod
    def duration(self) -> float:
        """Time of the whole run, s."""

    @abstractmethod
    def voltage(self, time: float) -> float:
        """Voltage at a time, V."""

    @abstractmethod
    def trend(self, times: np.ndarray) -> np.ndarray:
        """Whether the voltage rises: 1 where it does, -1 where it falls, 0 where it holds."""


@dataclass(frozen=True)
class Constant(Schedule):
    """The same voltage all the time.

    Attributes
    ----------
    value : float
        V.
    time : float
        s.

    Raises
    ------
    InputError
    """

    value: float
    time: float

    def __post_init__(self) -> None:
        check("voltage", self.value, "V")
        check("duration", self.time, "s", low=0.0)

    @property
    def duration(self) -> float:
        """Time of the whole run, s."""
        return self.time

    def voltage(self, time: float) -> float:
        """Voltage at a time, V."""
        return self.value

    def trend(self, times: np.ndarray) -> np.ndarray:
        """Nowhere up, nowhere down."""
        return np.zeros(np.shape(times), dtype=int)


@dataclass(frozen=True)
class Ramp(Schedule):
    """Spin up, settle at the first voltage, go to the last one, and back.

    Attributes
    ----------
    first, last : float
        V.
    rate : float
        Change of the voltage per time, V/s, > 0; on average, where ``increment`` is not 0.
    settle : float
        Time at ``first`` before, s.
    increment : float
        Height of steps, V; 0 for a ramp.
    back : bool
        Whether it goes back to ``first`` again.
    spin_up : float
        Time in which the voltage rises from ``low`` to ``first`` at the very beginning, s.
    low : float
        Voltage at which it spins up from, V.

    Raises
    ------
    InputError

    Examples
    --------
    >>> ramp = Ramp(first=1.0, last=1.2, rate=0.001, settle=50.0)
    >>> [round(ramp.voltage(time), 6) for time in (0.0, 50.0, 150.0, 250.0, 350.0, 450.0)]
    [1.0, 1.0, 1.1, 1.2, 1.1, 1.0]
    """

    first: float
    last: float
    rate: float
    settle: float = 0.0
    increment: float = 0.0
    back: bool = True
    spin_up: float = 0.0
    low: float = 0.0

    def __post_init__(self) -> None:
        check("voltage", self.first, "V")
        check("voltage", self.last, "V")
        check("spin_up", self.spin_up, "s", low=0.0)
        check("low", self.low, "V")
        if self.first == self.last:
            raise InputError(
                f"voltage = ({self.first}, {self.last}) V: expected two different ones, or a "
                "number and a duration"
            )
        if not (math.isfinite(self.rate) and self.rate > 0.0):
            raise InputError(f"rate = {self.rate} V/s: expected a number > 0")
        check("settle", self.settle, "s", low=0.0)
        check("increment", self.increment, "V", low=0.0, high=abs(self.last - self.first))

    @property
    def begin(self) -> float:
        """Time at which it leaves the first voltage, s."""
        return self.spin_up + self.settle

    @property
    def rise(self) -> float:
        """Time the voltage takes from one end to the other, s."""
        return abs(self.last - self.first) / self.rate

    @property
    def turn(self) -> float:
        """Time at which it is at the last voltage, s."""
        return self.begin + self.rise

    @property
    def duration(self) -> float:
        """Time of the whole run, s."""
        return self.begin + self.rise * (2 if self.back else 1)

    def voltage(self, time: float) -> float:
        """Voltage at a time, V."""
        if time < self.spin_up:
            return self.low + (self.first - self.low) * time / self.spin_up
        ramp = min(max(time - self.begin, 0.0), self.duration - self.begin)
        there = ramp <= self.rise
        change = self.rate * (ramp if there else 2.0 * self.rise - ramp)
        if self.increment:
            count = change / self.increment
            change = self.increment * (
                math.floor(count + 1e-9) if there else math.ceil(count - 1e-9)
            )
        change = min(change, abs(self.last - self.first))
        return self.first + math.copysign(change, self.last - self.first)

    def trend(self, times: np.ndarray) -> np.ndarray:
        """Up or down on the way there, the other way round on the way back."""
        times, there = np.asarray(times), 1 if self.last > self.first else -1
        return np.where(times > self.turn, -there, np.where(times > self.begin, there, 0))
