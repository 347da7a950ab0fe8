"""Define how the motor's voltage changes over time: constant, ramp or given course."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from os import PathLike

import numpy as np

from ..errors import InputError
from ..files import format_read_error, read_text
from ..model.arguments import checked_numbers
from ..model.ranges import checked_range


@dataclass(frozen=True)
class Schedule(ABC):
    """Define the interface of a voltage schedule over time: a course, and where it rises."""

    @property
    @abstractmethod
    def course(self) -> Course:
        """Return the voltage over time, piecewise linear."""

    @property
    def duration(self) -> float:
        return self.course.times[-1]

    def voltage(self, time: float) -> float:
        return self.course.voltage(time)

    def trend(self, times: np.ndarray) -> np.ndarray:
        """Return at each time 1 if the voltage rises, -1 if it falls, 0 if constant."""
        known, voltages = self.course.times, self.course.voltages
        places = np.clip(np.searchsorted(known, times) - 1, 0, len(known) - 2)
        return np.sign(np.diff(voltages))[places].astype(int)


@dataclass(frozen=True)
class Constant(Schedule):
    """Keep the voltage constant for a duration."""

    value: float  # V
    time: float  # s

    def __post_init__(self) -> None:
        checked_range("voltage", self.value, "V")
        checked_range("duration", self.time, "s", low=0.0)

    @property
    def duration(self) -> float:
        return self.time

    @cached_property
    def course(self) -> Course:
        return Course((0.0, self.time), (self.value, self.value))


@dataclass(frozen=True)
class Ramp(Schedule):
    """Ramp the voltage from the first to the last one, and back."""

    # V
    first: float
    last: float
    rate: float  # change of the voltage per time, V/s, > 0; on average, where `increment` is not 0
    settle: float = 0.0  # time at `first` before, s
    increment: float = 0.0  # height of steps, V; 0 for a ramp
    back: bool = True  # whether it goes back to `first` again
    # time in which the voltage rises from `low` to `first` at the very beginning, s
    spin_up: float = 0.0
    low: float = 0.0  # voltage at which it spins up from, V

    def __post_init__(self) -> None:
        checked_range("voltage", self.first, "V")
        checked_range("voltage", self.last, "V")
        checked_range("spin_up", self.spin_up, "s", low=0.0)
        checked_range("low", self.low, "V")
        if self.first == self.last:
            raise InputError(
                f"voltage = ({self.first}, {self.last}) V: expected two different ones, or a "
                "number and a duration"
            )
        checked_range("rate", self.rate, "V/s", low=0.0, open_low=True)
        checked_range("settle", self.settle, "s", low=0.0)
        checked_range("increment", self.increment, "V", low=0.0, high=abs(self.last - self.first))

    @property
    def ramp_start(self) -> float:
        return self.spin_up + self.settle

    @property
    def turn_time(self) -> float:
        """Return the time at which the ramp reaches the last voltage, s."""
        return self.ramp_start + abs(self.last - self.first) / self.rate

    @cached_property
    def course(self) -> Course:
        height = abs(self.last - self.first)
        count = math.floor(height / self.increment + 1e-9) if self.increment else 0
        levels = np.minimum(self.increment * np.arange(count + 1), height) if count else [0.0]
        nodes = [(self.ramp_start, 0.0)]
        for below, level in pairwise(levels):
            nodes += [(self.ramp_start + level / self.rate, each) for each in (below, level)]
        nodes += [(self.turn_time, levels[-1] if self.increment else height)]
        back = [height, *levels[::-1]] if self.back else []
        nodes += [(self.turn_time, level) for level in back[:1]]
        for level, below in pairwise(back):
            time = self.turn_time + (height - below) / self.rate
            nodes += [(time, level if self.increment else below), (time, below)]
        sign = math.copysign(1.0, self.last - self.first)
        times, changes = zip(*nodes, strict=True)
        voltages = [self.first + sign * change for change in changes]
        start = self.low if self.spin_up else self.first
        return Course((0.0, self.spin_up, *times), (start, self.first, *voltages))

    def trend(self, times: np.ndarray) -> np.ndarray:
        times, there = np.asarray(times), 1 if self.last > self.first else -1
        return np.where(times > self.turn_time, -there, np.where(times > self.ramp_start, there, 0))


@dataclass(frozen=True)
class Course(Schedule):
    """Interpolate the voltage linearly between given times: ramps, holds and steps.

    Attributes
    ----------
    times : tuple of float
        s, from 0, never falling; two equal ones are a step.
    voltages : tuple of float
        V.

    Raises
    ------
    InputError

    Examples
    --------
    >>> course = Course(times=(0.0, 100.0, 150.0, 150.0, 200.0), voltages=(1.0, 1.5, 1.5, 1.6, 1.6))
    >>> [course.voltage(time) for time in (50.0, 120.0, 151.0, 999.0)]
    [1.25, 1.5, 1.6, 1.6]
    """

    times: tuple[float, ...]
    voltages: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("times", "voltages"):
            values = np.asarray(checked_numbers(name, getattr(self, name)), dtype=float)
            object.__setattr__(self, name, tuple(values.ravel().tolist()))
        if len(self.times) != len(self.voltages) or len(self.times) < 2:
            count = f"{len(self.times)} times and {len(self.voltages)} voltages"
            raise InputError(f"{count}: expected as many of both, two or more")
        for time, value in zip(self.times, self.voltages, strict=True):
            checked_range("time", time, "s", low=0.0)
            checked_range("voltage", value, "V")
        falls = any(after < before for before, after in pairwise(self.times))
        if self.times[0] != 0.0 or falls or self.times[-1] == 0.0:
            raise InputError(f"times = {self.times}: expected rising ones from 0, in s")

    @classmethod
    def from_csv(cls, path: str | PathLike[str]) -> Course:
        """Read the course from a CSV file with columns time, s, and voltage, V."""
        try:
            lines = read_text(path, 1 << 22).splitlines()  # bytes: some hundred thousand rows
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: {format_read_error(error)}; expected a CSV file") from None
        rows: list[list[float]] = []
        for number, line in enumerate(lines, start=1):
            if not line.strip() or line.lstrip().startswith("#"):
                continue
            try:
                if not line.isascii() or "_" in line:  # Python takes digits of any script
                    raise ValueError(line)
                time, voltage = (float(part) for part in line.split(","))
            except ValueError:
                if rows or line.lstrip()[0].isdigit():
                    expected = "expected time in s and voltage in V, separated by a comma"
                    raise InputError(f"{path}, line {number}: {line!r}; {expected}") from None
                continue  # names of the columns
            rows.append([time, voltage])
        times, voltages = zip(*rows, strict=True) if rows else ((), ())
        try:
            return cls(times, voltages)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None

    @property
    def course(self) -> Course:
        """Return the course itself, as other schedules return theirs."""
        return self

    def voltage(self, time: float) -> float:
        last = bisect_right(self.times, time)
        if last == len(self.times):
            return self.voltages[-1]
        begin, end = self.times[last - 1], self.times[last]
        low, high = self.voltages[last - 1], self.voltages[last]
        return low + (high - low) * (time - begin) / (end - begin)

    def ends_means_and_moments(self, edges: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return end values, means, moments of steps; a jump at an edge is of the one after."""
        known, values = np.array(self.times), np.array(self.voltages)
        inner = known[(known > edges[0]) & (known < edges[-1])]
        nodes = np.unique(np.concatenate([edges, inner]))
        middles, spans = 0.5 * (nodes[1:] + nodes[:-1]), np.diff(nodes)
        piece = known.searchsorted(middles).clip(1, len(known) - 1)
        held = middles >= known[-1]
        rise = np.where(held, 0.0, (values[piece] - values[piece - 1]))
        slope = rise / np.where(held, 1.0, known[piece] - known[piece - 1])
        level = np.where(held, values[-1], values[piece - 1])
        level = level + slope * (middles - known[piece - 1])
        starts, counts = nodes.searchsorted(edges[:-1]), np.diff(nodes.searchsorted(edges))
        arms = middles - np.repeat(0.5 * (edges[1:] + edges[:-1]), counts)
        above = level - np.repeat(level[starts], counts)  # of a constant exactly 0
        means = level[starts] + np.add.reduceat(above * spans, starts) / np.diff(edges)
        moments = np.add.reduceat((above * arms + slope * spans**2 / 12.0) * spans, starts)
        half, ends = 0.5 * slope * spans, starts + counts - 1
        return (level - half)[starts], (level + half)[ends], means, moments
