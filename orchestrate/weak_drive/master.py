"""Step the oscillator and its drive together: in an ordinary step the oscillator alone goes back.

The structure's ``box_force`` depends on its states only, the box's acceleration on the force: there
is no algebraic loop, but what each side assumes of the other over a step decides everything.

- The oscillator does the step under an extrapolated acceleration: the cubic of the last step goes
  on from the present value.
- The drive does it under the force that came of it: the cubic with its ends, mean and first moment,
  which are exact through impacts. A drive that takes the force alone is given its mean.
- The oscillator goes back and does it again, under the acceleration between both ends: the cubic
  with the changes of the box's velocity and position, or what is known of it.
- Where nothing is known to extrapolate, at the start, both do the step `first_passes` times, if the
  drive can go back.
- With a `tolerance` a step is halved, for both, where the energy defect is a larger part of the
  work exchanged in it; one with less than `easy` of that is followed by one twice as long.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..fmu.channel import Channel, SimulationEnded
from ..fmu.instance import Instance
from .connection import FORCE, MOTOR, Connection
from .polynomials import (
    Cubic,
    derivatives,
    end_derivatives,
    integrate_work,
    matched_cubic,
    matched_parabola,
)
from .record import BOX, LEADING, PLACE, OscillatorOutputs, Record

CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
TIME, H, LEVEL, THEN, IMPACTS = (
    PLACE[name] for name in ("time", "h", "level", "acceleration_then", "impacts")
)
MOTION, DRIVE = PLACE["x1"], PLACE[BOX[0]]
VELOCITY, ACCELERATION, END = DRIVE + 1, DRIVE + 2, DRIVE + 3
FORCE_PLACE = OscillatorOutputs._fields.index("box_force")
PAST = 3  # communication points that are remembered where no acceleration is connected


@dataclass(frozen=True)
class Scheme:
    """Set the communication step and its error control."""

    # communication interval, s: the longest step, and all of them without `tolerance`
    h: float = 0.1
    tolerance: float = 0.0  # of the step control; 0: all steps are `h`
    halvings: int = 6  # how often `h` is halved at most
    easy: float = 1.0 / 64.0  # part of the tolerance
    first_passes: int = 3  # of the first step, where the drive can go back

    def __post_init__(self) -> None:
        """Check step length and tolerance."""
        if not (math.isfinite(self.h) and self.h > 0.0):
            raise InputError(f"step {self.h}: expected a number > 0, in s")
        if not (math.isfinite(self.tolerance) and self.tolerance >= 0.0):
            raise InputError(
                f"tolerance {self.tolerance}: expected a number >= 0; 0 leaves steps as they are"
            )

    def most_rows(self, intervals: int) -> int:
        """Return how many steps a number of intervals may take."""
        return intervals << self.halvings if self.tolerance else intervals


class DriveSide:
    """The drive's FMU: what is set and read, by our names and in SI."""

    def __init__(self, instance: Instance, connection: Connection) -> None:
        links, self.instance = connection.links, instance
        self.forces = [(i, links[name]) for i, name in enumerate(FORCE) if name in links]
        self.motions = [(i, links[name]) for i, name in enumerate(BOX) if name in links]
        self.is_whole = len(self.forces) == len(FORCE)
        self.channel = Channel(
            instance,
            (*(link.theirs for _, link in self.forces), *connection.inputs),
            (*(link.theirs for _, link in self.motions), *connection.outputs),
        )

    def put(self, force: Sequence[float], inputs: Sequence[float]) -> None:
        """Set the force, with the derivatives that are connected, and the other inputs."""
        self.channel.put(*(force[i] / link.scale for i, link in self.forces), *inputs)

    def get(self) -> list[float]:
        """Return the box's motion, NaN for what is not connected, and the other outputs."""
        values = self.channel.get()
        box = [math.nan] * len(BOX)
        for (i, link), value in zip(self.motions, values, strict=False):
            box[i] = link.scale * value
        return [*box, *values[len(self.motions) :]]


class Master:
    """Step two initialised FMU instances together and exchange force and acceleration."""

    def __init__(
        self,
        oscillator: Instance,
        drive: Instance,
        scheme: Scheme,
        connection: Connection = MOTOR,
        start_time: float = 0.0,
    ) -> None:
        """Connect both instances and read their initial outputs."""
        self.oscillator = Channel(oscillator, CUBIC, OscillatorOutputs._fields)
        self.drive, self.scheme = DriveSide(drive, connection), scheme
        self.connection, self.goes_back = connection, drive.description.has_states
        self.names = (*LEADING, *connection.outputs, *connection.inputs)
        self.inputs = slice(END + len(connection.outputs), len(self.names))
        unknown = [math.nan] * len(connection.inputs)
        step, motion = [start_time, *[0.0] * (IMPACTS - TIME)], self.oscillator.get()
        self.drive.put((motion[FORCE_PLACE], 0.0, 0.0, 0.0), ())  # its acceleration follows it
        self.row = [*step, *motion, *self.drive.get(), *unknown]
        self.points: list[float] = []  # times and values, where no acceleration is connected
        self._remember()

    @property
    def time(self) -> float:
        """Return the time reached, s."""
        return self.row[TIME]

    @property
    def motion(self) -> OscillatorOutputs:
        """Return the oscillator's outputs at the present time."""
        return OscillatorOutputs._make(self.row[MOTION:DRIVE])

    def __getitem__(self, name: str) -> float:
        """Return a value at the present time, by the name of its column in a record."""
        return self.row[self.names.index(name)]

    def step(self, *inputs: float, h: float | None = None) -> Record:
        """Run one communication interval with constant inputs of the drive."""
        return self.run([inputs], h)

    def run(self, inputs: ArrayLike, h: float | None = None) -> Record:
        """Run an interval for each row of the drive's inputs, held constant; return the record."""
        values = np.asarray(inputs, dtype=float)
        rows = values.reshape(len(values), self.width)
        return self.run_controlled(rows.tolist(), len(values), h)

    def run_controlled(
        self, inputs: Iterable[Sequence[float]], count: int, h: float | None = None
    ) -> Record:
        """Run a number of intervals; its inputs are requested at its start.

        Fewer, if an FMU ends the simulation (:attr:`ended`): those that it reached the end of.
        """
        rows, ends, recorded = [list(self.row)], [], []
        own = len(self.connection.inputs)
        for values in inputs:
            try:
                rows += self._interval(list(values[:own]), h or self.scheme.h)
            except SimulationEnded:
                break
            ends.append(len(rows) - 1)
            recorded += [self.recorded(values[own:])] if self.connection.recorded else []
            if self.ended:
                break
        return Record.of_rows(self.names, rows, ends, recorded)

    @property
    def ended(self) -> str:
        """Return at what time, and why, an FMU ended the simulation; empty if none did."""
        return self.drive.channel.ended or self.oscillator.ended

    @property
    def width(self) -> int:
        """Return how many inputs of the drive a row of :meth:`run` has."""
        return len(self.connection.inputs) * (2 if self.connection.recorded else 1)

    def recorded(self, inputs: Sequence[float]) -> list[float]:
        """Return what is recorded of the drive, in its own units, under some inputs."""
        self.drive.put((self.row[MOTION + FORCE_PLACE], 0.0, 0.0, 0.0), inputs)
        return [float(value) for value in self.drive.instance.get(*self.connection.recorded)]

    def _interval(self, inputs: list[float], h: float) -> list[list[float]]:
        """Run one communication interval; return the rows of its steps."""
        end = self.time + h
        # the acceleration belongs to the inputs as set now
        if inputs != self.row[self.inputs] or self.connection.cubic >= 0:
            self.row[self.inputs] = inputs
            force = self.row[MOTION + FORCE_PLACE]
            self.row[DRIVE : self.inputs.start] = self._outputs_at(force, inputs)
        rows = self._steps(h, self.scheme.halvings if self.scheme.tolerance else 0)
        rows[-1][TIME] = self.row[TIME] = end
        return rows

    def _steps(self, h: float, halvings: int) -> list[list[float]]:
        """Run an interval in steps of its length halved, so that each defect is small."""
        # doubled only on their own grid: the end is met without a rest, lengths are exact
        level, rows, most, done = int(self.row[LEVEL]), [], 1 << halvings, 0
        while done < most:
            size = most >> level
            row, defect = self._attempt(h / (1 << level), level < halvings)
            if row:
                rows.append(row)
                done += size
                is_easy = defect < self.scheme.tolerance * self.scheme.easy
                level -= is_easy and done % (2 * size) == 0 and level > 0
            else:
                level += 1
            self.row[LEVEL] = float(level)
        return rows

    def _attempt(self, h: float, may_refuse: bool) -> tuple[list[float] | None, float]:
        """Try one step; return its row, None where it is refused, and its relative defect."""
        now, inputs, drive = self.row, self.row[self.inputs], self.drive
        passes = self.scheme.first_passes if self.goes_back and now[H] == 0.0 else 1
        self.oscillator.save()
        if may_refuse or passes > 1:
            drive.channel.save()
        acceleration = self._run_on()
        for i in range(passes):
            if i:
                self.oscillator.restore()
                drive.channel.restore()
            motion = self._oscillate(acceleration, h)
            drive.put(self._force_over(motion, h), inputs)
            drive.channel.step(now[TIME], h)
            outputs = self._outputs_at(motion[FORCE_PLACE], self._later(inputs, h))
            acceleration = self._acceleration_over(outputs, h)
        self.oscillator.restore()
        motion = self._oscillate(acceleration, h)
        outputs = self._outputs_at(motion[FORCE_PLACE], self._later(inputs, h))
        defect = 0.0
        if self.scheme.tolerance:
            defect = self._defect(self._force_over(motion, h), acceleration, outputs, h)
        if may_refuse and defect > self.scheme.tolerance:
            self.oscillator.restore()
            drive.channel.restore()
            return None, defect
        count = float(self.oscillator.instance.get("impact_count")[0])
        step = (now[TIME] + h, h, now[LEVEL], *acceleration, count)
        self.row = [*step, *motion, *outputs, *inputs]
        self._remember()
        return list(self.row), defect

    def _oscillate(self, acceleration: Cubic, h: float) -> list[float]:
        """Step the oscillator under an acceleration of the box; return its outputs."""
        self.oscillator.put(*acceleration)
        self.oscillator.step(self.time, h)
        return self.oscillator.get()

    def _outputs_at(self, force: float, inputs: Sequence[float]) -> list[float]:
        """Return the drive's outputs under the force at a communication point."""
        self.drive.put((force, 0.0, 0.0, 0.0), inputs)
        return self.drive.get()

    def _later(self, inputs: list[float], h: float) -> list[float]:
        """Return the drive's inputs at the end of a step: a cubic among them runs on."""
        first = self.connection.cubic
        if first < 0:
            return inputs
        cubic = end_derivatives(tuple(inputs[first : first + 4]), h)
        return [*inputs[:first], *cubic, *inputs[first + 4 :]]

    def _force_over(self, motion: Sequence[float], h: float) -> Cubic:
        """Return the force over a step, exact in its mean and first moment if these are taken."""
        _, _, _, _, force, impulse, moment, *_ = motion
        first = self.row[MOTION + FORCE_PLACE]
        if not self.drive.is_whole:
            return impulse / h, 0.0, 0.0, 0.0
        return matched_cubic(first, force, impulse / h, moment / (h * h), h)

    def _acceleration_over(self, after: Sequence[float], h: float) -> Cubic:
        """Return the box acceleration over a step, from what is known of the box at both ends."""
        position, velocity, first = self.row[DRIVE:END]
        if math.isnan(first):
            return self._slopes_of_points(after, h)
        knows_velocity = not math.isnan(velocity)
        mean = (after[1] - velocity) / h if knows_velocity else 0.5 * (first + after[2])
        if math.isnan(position) or not knows_velocity:
            return matched_parabola(first, after[2], mean, h)
        moment = mean - ((after[0] - position) / h - velocity) / h
        return matched_cubic(first, after[2], mean, moment, h)

    def _slopes_of_points(self, after: Sequence[float], h: float) -> Cubic:
        """Return the acceleration over a step from velocities or positions alone, as a line."""
        from_position = math.isnan(after[1])
        times = [*self.points[::2][-2 - from_position :], self.row[TIME] + h]
        values = [*self.points[1::2][-2 - from_position :], after[0 if from_position else 1]]
        ages = [t - self.row[TIME] for t in times]
        return (*derivatives(ages, values, 1 + from_position), 0.0, 0.0)

    def _remember(self) -> None:
        """Keep the last points of velocity or position where no acceleration is connected."""
        position, velocity, acceleration = self.row[DRIVE:END]
        if math.isnan(acceleration):
            value = position if math.isnan(velocity) else velocity
            self.points = [*self.points, self.row[TIME], value][-2 * PAST :]

    def _run_on(self) -> Cubic:
        """Extrapolate the box acceleration over the coming step: its last cubic goes on."""
        h, value = self.row[H], self.row[ACCELERATION]
        slopes: Cubic = (0.0, 0.0, 0.0, 0.0)
        if h != 0.0:
            slopes = end_derivatives(tuple(self.row[THEN:IMPACTS]), h)
        return slopes if math.isnan(value) else (value, *slopes[1:])

    def _defect(
        self, force: Cubic, acceleration: Cubic, outputs: Sequence[float], h: float
    ) -> float:
        """Return the energy that a step loses or makes, over the work exchanged in it."""
        work, energy = END, END + 1  # by the drive's own account
        taken = outputs[work - DRIVE] - self.row[work]
        given = outputs[energy - DRIVE] - self.row[energy]
        lost = taken - integrate_work(force, self.row[VELOCITY], acceleration, h)
        exchanged = abs(taken) + abs(given)
        return abs(lost) / exchanged if exchanged else 0.0

    # -- to go on elsewhere --

    def get_state(self) -> list[float]:
        """Return the master's own state as a list of floats, to be restored later."""
        missing = [math.nan] * (2 * PAST - len(self.points))
        return [*self.row, *self.points, *missing]

    def set_state(self, numbers: Sequence[float]) -> None:
        """Restore the state that :meth:`get_state` returned."""
        count = len(self.names)
        self.row, self.points = list(numbers[:count]), [x for x in numbers[count:] if x == x]

    def close(self) -> None:
        """Free the FMU states saved to go back."""
        self.oscillator.close()
        self.drive.channel.close()
