"""Decide by a hysteresis loop of held voltages where the motor's speed jumps.

A jump is a loss of stability of the slow motion: two motions exist at one voltage, and the ramp
loses the first. A steep but continuous branch is not a jump. The rule, for each ramp as a whole:

- Voltages on a grid of steps `grid`, from the ramp's own state at its beginning to its end: the
  voltage is raised to each at `rate` and held until the speed has settled (:mod:`.steady_speed`);
  those at which it does not are left out.
- Every step in which the speed gains `smallest` more or less than at the lower rate of the steps
  next to it (without these: than the voltage), or moves by `against` against the voltage, is
  halved, to `width`, and to `finest` where the speed comes back over it.
- The motion before such a step has to last; if it does not, the motion that follows it is taken.
  Where disturbances are known to grow (:mod:`.growth`), it is held for `growths` growth times, and
  left out where these are longer than `patience` holds. Unless they are known to decay, it may be
  a transient: it is held for `again` times as long as it took to settle, and for `lives` times the
  longest time after which it was seen to be lost within the step, up to `patience` holds, and on a
  ramp up to a `budget` of them.
- It is *lost* over that step where the speed, taken back over it, is `clear` away and stays within
  `same` when it is held `again` times. There is *no* jump where no such step is left but of
  `finest`, over which the speed comes back, and on a way back over all of the ramp the speed is
  nowhere `clear` away; from a voltage where it is only `same` away the ramp's motion is taken.
- All else is *undecided*: a ramp's beginning or end, or a way back, that does not settle, two
  motions nearer than `clear`, a step within which nothing settles or after `max_rounds` of this,
  another motion on the way back, and what comes after these or a loss if the speed moves against
  the voltage, unless a motion that had converged comes to one other at `landings` voltages past it.

From differences the `errors` of irregular motions' speeds are taken off, but not on the last way
back. Non-dimensional: voltages over K omega, speeds over omega, times in 1/omega, in the mirror
image in which the motor turns forward.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..running.job import Table
from .ramp_record import RampRecord
from .run import MotorRun, state_rows
from .schedule import Course, Schedule
from .steady_speed import SettledSettings, settled_speed

NONE, LOST, UNDECIDED = range(3)


@dataclass(frozen=True)
class HysteresisSettings(SettledSettings):
    """Set the steps and thresholds of the hysteresis loop; defaults serve all drives tried."""

    grid: float = 0.02  # longest first step of the voltage
    rate: float = 5e-5  # of the voltage from one step to the next, in a time 1/omega
    width: float = 1e-4  # widest bracket of a jump, where motions settle in time
    finest: float = 1e-6  # shortest step of the voltage
    # change of the speed over a step, beyond what its neighbours' are, up to which it may be one
    # branch; below 0.866 of `clear`, so that no steps find a jump that others rule out
    smallest: float = 4e-3
    against: float = 1e-3  # the same where the speed moves against the voltage
    neighbour: float = 0.25  # of a step, what one next to it is at least to be compared with
    same: float = 2e-3  # largest difference of two settled speeds of one motion
    clear: float = 5e-3  # smallest difference of two motions' speeds at one voltage at a jump
    again: int = 3  # times that a motion next to a jump is held again
    growths: float = 30.0  # growth times after which a motion is seen to last, or not
    lives: float = 5.0  # of a motion beyond a step: how long that before it has to last
    patience: float = 10.0  # longest holds that these may be
    budget: float = 40.0  # the same of a ramp's motions together, after which they are left out
    landings: int = 6  # voltages, by `width`, at which one motion follows one that is lost
    max_rounds: int = 150  # of looking at the largest step of a ramp
    errors: float = 3.0  # standard errors that are taken off a difference of speeds
    parts: tuple[float, ...] = (0.5, 0.25, 0.75)  # of a step: where a speed between is sought
    left: float = 0.1  # of the way between two motions' speeds: with less to go, the first is left


class HeldPoint(NamedTuple):
    """Store the speed that settled at a held voltage, and the state reached."""

    voltage: float
    speed: float  # NaN where it did not settle in time
    error: float  # of the speed of an irregular motion; 0 where it converged
    state: Table
    time: float = 0.0  # s, held there until then: in it the motion before was lost, if it was
    lasts: float = 0.0  # s, for which the motion is known to last


class Jump(NamedTuple):
    """Store where a motion is lost, or may be: between two voltages, in the ramp's order."""

    outcome: int  # `LOST` or `UNDECIDED`
    low: float
    high: float
    before: float = math.nan  # settled speeds at these voltages
    after: float = math.nan


class HysteresisLoop:
    """Decide where a course of held voltages loses its motion, from states of a past ramp."""

    def __init__(
        self,
        begin: Callable[[Schedule], MotorRun],
        schedule: Schedule,
        step: float,
        omega: float,
        volts: float,
        longest: float,
        settings: HysteresisSettings | None = None,
        growth: Callable[[MotorRun, float, float], float] | None = None,
    ) -> None:
        # `volts` is negative where the motor turns backward; `longest` is the longest hold, s;
        # `growth` returns the rate, 1/s, at which disturbances of a run's motion grow
        self.begin, self.schedule, self.step = begin, schedule, step
        self.omega, self.volts, self.longest = omega, volts, longest
        self.settings, self.growth = settings or HysteresisSettings(), growth
        self.checkpoints: dict[int, Table] = {}
        self.left_out: set[float] = set()  # voltages at which a motion does not settle again
        self.spent = 0.0  # s, for which motions of a ramp were held on

    def add_checkpoints(self, table: Table, every: int, steps: int) -> None:
        """Store the ramp's saved states by their communication step."""
        for i in range(len(table["master_memory"])):
            state = state_rows(table, slice(i, i + 1))
            self.checkpoints[min((i + 1) * every, steps)] = state

    def state_before(self, step: int) -> Table | None:
        """Return the ramp's state before a step, from a checkpoint; None at the start."""
        if step not in self.checkpoints and step:
            last = max((known for known in self.checkpoints if known < step), default=0)
            with closing(self.begin(self.schedule)) as run:
                if last:
                    run.set_state(self.checkpoints[last])
                run.speeds(range(last, step))
                self.checkpoints[step] = run.get_state()
        return self.checkpoints.get(step)

    def hold_step(self, step: int) -> HeldPoint:
        """Hold the voltage that the ramp has at a step, from its state there."""
        voltage = self.schedule.voltage((step + 0.5) * self.step) / self.volts
        return self.hold(self.state_before(step), voltage, voltage)

    def hold_from(self, point: HeldPoint, voltage: float, limit: float | None = None) -> HeldPoint:
        """Take the voltage slowly from a held point to another one, and hold it there."""
        ends = None if limit is None else (point.speed, limit)
        return self.hold(point.state, point.voltage, voltage, ends)

    def hold(
        self,
        state: Table | None,
        first: float,
        voltage: float,
        ends: tuple[float, float] | None = None,
        least: float = 0.0,
    ) -> HeldPoint:
        """Take the voltage to another one at `rate`, and hold it until the speed settles."""
        # with `ends`, until the speed has come from the first of two nearly to the second one;
        # for the time `least`, s, unless it has left
        settings = self.settings
        moves = math.ceil(abs(voltage - first) / settings.rate / self.omega / self.step)
        count = moves + math.ceil((least + self.longest) / self.step)
        piece = max(1, round(settings.piece / self.omega / self.step))
        times = (0.0, moves * self.step, count * self.step)
        volts = (self.volts * first, self.volts * voltage, self.volts * voltage)
        speeds, speed, error, time = np.zeros(0), math.nan, 0.0, 0.0
        with closing(self.begin(Course(times, volts))) as run:
            if state is not None:
                run.set_state(state)
            run.speeds(range(moves))
            for begin in range(moves, count, piece):
                end = min(begin + piece, count)
                found, time = run.speeds(range(begin, end)), (end - moves) * self.step
                speeds = np.append(speeds, np.abs(found) / self.omega)
                speed, error = settled_speed(speeds, settings)
                if math.isfinite(speed):
                    away = abs(speed - speeds[: settings.block].mean()) - settings.errors * error
                    if away > settings.clear or (begin - moves) * self.step >= least:
                        break
                    speed = math.nan
                late = speeds[-settings.block :]
                if ends and late.size:
                    to_go = abs(float(late.mean()) - ends[1])
                    if to_go < settings.left * abs(ends[0] - ends[1]):
                        speed = ends[1]
                        break
            return HeldPoint(voltage, speed, error, run.get_state(), time)

    # -- the rule --

    def decide(self, record: RampRecord) -> list[Jump]:
        """Return all jumps of a run in one direction, by their voltages."""
        jumps = []
        for leg in record.legs():
            first, last = record.eta0(leg[[0, -1]]).tolist()
            if self.longest:
                jumps += self.jumps(self.hold_step(record.step(int(leg[0]))), last)
            else:
                jumps.append(Jump(UNDECIDED, first, last))
        return merge_overlapping(jumps, record.sign)

    def jumps(self, first: HeldPoint, last: float) -> list[Jump]:
        """Return the jumps between a held point and a voltage: an empty list for none."""
        sign = math.copysign(1.0, last - first.voltage)
        points = self.hold_grid(first, last)
        if not points:
            return [Jump(UNDECIDED, first.voltage, last)]
        jumps: dict[tuple[float, float], Jump] = {}
        self.spent = 0.0
        for _ in range(self.settings.max_rounds):
            i = self.largest_step(points, jumps)
            if i is None:
                break
            low, high = points[i : i + 2]
            if low.lasts < self.least(low, high):
                point = self.lasting(low, high)
                if math.isfinite(point.speed):
                    points[i] = point
                else:
                    self.left_out.add(points.pop(i).voltage)
                continue
            is_wide = abs(high.voltage - low.voltage) > self.settings.width
            if is_wide and self.insert_between(points, i):
                continue
            if jump := self.jump_over(points, i, sign):
                jumps[low.voltage, points[i + 1].voltage] = jump
        else:
            del points[(self.largest_step(points, jumps) or 0) + 1 :]
        steps = {(low.voltage, high.voltage) for low, high in pairwise(points)}
        known = [jump for step, jump in jumps.items() if step in steps and jump.outcome != NONE]
        if not known and not self.comes_back(points):
            return [Jump(UNDECIDED, first.voltage, last)]
        beyond = [(first.voltage, points[0].voltage), (points[-1].voltage, last)]
        unsettled = [Jump(UNDECIDED, *ends) for ends in beyond if ends[0] != ends[1]]
        return merge_overlapping([*known, *unsettled], sign)

    def jump_over(self, points: list[HeldPoint], i: int, sign: float) -> Jump | None:
        """Return the jump over a step, by the way back; None where the step is small or halved."""
        low, high = points[i : i + 2]
        landed = self.hold_beside(low, high.voltage, high)
        points[i + 1] = high = landed if math.isfinite(landed.speed) else high
        if low.lasts < self.least(low, high):
            return None
        outcome = self.way_back(low, landed)
        if outcome == NONE and abs(high.voltage - low.voltage) > self.settings.finest:
            if self.excess(points, i, {}) <= 0.0 or self.insert_between(points, i):
                return None
            outcome = UNDECIDED
        is_against = outcome != NONE and sign * (high.speed - low.speed) < 0.0
        if is_against and not self.lands_surely(low, high):
            del points[i + 2 :]
        return Jump(outcome, low.voltage, high.voltage, low.speed, high.speed)

    def hold_grid(self, first: HeldPoint, last: float) -> list[HeldPoint]:
        """Step the voltage over the grid; return the points at which the speed settled."""
        count = max(1, math.ceil(abs(last - first.voltage) / self.settings.grid - 1e-9))
        points = [first]
        for voltage in np.linspace(first.voltage, last, count + 1)[1:].tolist():
            points.append(self.hold_from(points[-1], voltage))
        return [point for point in points if math.isfinite(point.speed)]

    def largest_step(
        self, points: list[HeldPoint], decided: dict[tuple[float, float], Jump]
    ) -> int | None:
        """Return the index of the largest undecided step of the speed; None if all are small."""
        excess = [self.excess(points, i, decided) for i in range(len(points) - 1)]
        i = int(np.argmax(excess)) if excess else 0
        return i if excess and excess[i] > 0.0 else None

    def excess(
        self, points: list[HeldPoint], i: int, decided: dict[tuple[float, float], Jump]
    ) -> float:
        """Return by how much the speed changes more over a step than on one branch."""
        low, high = points[i : i + 2]
        if (low.voltage, high.voltage) in decided:
            return -math.inf
        length, rates = abs(high.voltage - low.voltage), []
        for a, b in (points[j : j + 2] for j in (i - 1, i + 1) if 0 <= j < len(points) - 1):
            own = abs(b.voltage - a.voltage)
            if own >= self.settings.neighbour * length and (a.voltage, b.voltage) not in decided:
                rates.append((b.speed - a.speed) / (b.voltage - a.voltage))
        gained = length * (high.speed - low.speed) / (high.voltage - low.voltage)
        changed = abs(gained - length * min(rates, default=1.0)) - self.settings.smallest
        scatter = min(self.error(low, high), self.settings.smallest)
        return max(changed, -gained - self.settings.against) - scatter

    def lands_surely(self, low: HeldPoint, high: HeldPoint) -> bool:
        """Return whether a motion that had converged comes to one other wherever it is lost."""
        step = math.copysign(self.settings.width, high.voltage - low.voltage)
        voltages = [high.voltage + n * step for n in range(1, self.settings.landings + 1)]
        speeds = (self.hold_from(low, voltage).speed for voltage in voltages)
        is_one = all(abs(speed - high.speed) < self.settings.clear for speed in speeds)
        return low.error == 0.0 and is_one

    def way_back(self, low: HeldPoint, landed: HeldPoint) -> int:
        """Return whether two motions exist at a step's lower voltage and the first is lost."""
        back = self.hold_from(landed, low.voltage)
        later = back if self.is_same(back, low) else self.hold_again(back)
        if self.is_same(later, low):
            return NONE
        is_clear = self.distance(back, low) >= self.settings.clear
        return LOST if later is back and is_clear else UNDECIDED

    def hold_beside(
        self, low: HeldPoint, voltage: float, high: HeldPoint, limit: float | None = None
    ) -> HeldPoint:
        """Hold a voltage from a point until it is there or has lost its motion for another one."""
        point = self.hold_from(low, voltage, limit)
        if abs(point.speed - low.speed) < abs(point.speed - high.speed):
            return self.lasting(point, high)
        return point._replace(time=max(point.time, high.time))

    def least(self, low: HeldPoint, high: HeldPoint) -> float:
        """Return for how long, s, a motion before a step has to last if it may be a transient."""
        settings = self.settings
        least = max(settings.again * low.time, settings.lives * high.time)
        return min(least, settings.patience * self.longest)

    def lasting(self, point: HeldPoint, high: HeldPoint) -> HeldPoint:
        """Hold a motion until it is known to last; return it, or what it has become."""
        rate = self.growth_rate(point)
        if rate <= 0.0:
            return point._replace(lasts=math.inf)
        grown = self.settings.growths / rate if rate > 0.0 else 0.0
        is_spent = self.spent > self.settings.budget * self.longest
        if grown > self.settings.patience * self.longest or is_spent:
            return point._replace(speed=math.nan)
        least = max(grown, self.least(point, high) - point.lasts)
        later = self.hold(point.state, point.voltage, point.voltage, least=least)
        self.spent += later.time
        lasted = point.lasts + later.time
        if self.distance(later, point) <= self.settings.same:
            return later._replace(time=point.time, lasts=lasted)
        return later._replace(time=max(point.time + lasted, high.time))

    def growth_rate(self, point: HeldPoint) -> float:
        """Return the rate, 1/s, at which disturbances of a motion grow; NaN if it is unknown."""
        if self.growth is None:
            return math.nan
        with closing(self.begin(self.schedule)) as run:
            run.set_state(point.state)
            speed = math.copysign(point.speed, self.volts) * self.omega
            return self.growth(run, point.voltage * self.volts, speed)

    def hold_again(self, point: HeldPoint) -> HeldPoint:
        """Hold a motion again and again; return its new point if it has left, else the point."""
        later = point
        for _ in range(self.settings.again):
            later = self.hold_from(later, point.voltage)
            if not self.distance(later, point) <= self.settings.same:  # or not settled
                return later
        return point

    def insert_between(self, points: list[HeldPoint], i: int) -> bool:
        """Hold voltages within a step until one settles, and insert it; return whether one does."""
        low, high = points[i : i + 2]
        change = high.voltage - low.voltage
        limit = high.speed if abs(change) < 0.5 * self.settings.smallest else None
        for voltage in (low.voltage + part * change for part in self.settings.parts):
            if voltage in self.left_out:
                continue
            point = self.hold_beside(low, voltage, high, limit)
            if math.isfinite(point.speed):
                points.insert(i + 1, point)
                return True
        return False

    def comes_back(self, points: list[HeldPoint]) -> bool:
        """Return whether the speed comes back, less than `clear` away, over all voltages."""
        # single ones between the ends need not settle
        last, settled = points[-1], True
        for point in reversed(points[:-1]):
            back = self.hold_from(last, point.voltage)
            away = abs(back.speed - point.speed)
            if away >= self.settings.clear:
                return False
            if math.isfinite(back.speed):
                last, settled = back if away <= self.settings.same else point, True
            elif settled and point is not points[0]:
                settled = False
            else:
                return False
        return True

    def is_same(self, point: HeldPoint, other: HeldPoint) -> bool:
        """Return whether two settled speeds may be of one motion, and are not `clear` away."""
        is_near = abs(point.speed - other.speed) < self.settings.clear
        return is_near and self.distance(point, other) <= self.settings.same

    def distance(self, point: HeldPoint, other: HeldPoint) -> float:
        """Return how far two settled speeds are apart at least, by their errors."""
        return abs(point.speed - other.speed) - self.error(point, other)

    def error(self, point: HeldPoint, other: HeldPoint) -> float:
        """Return the error of the difference between two settled speeds."""
        return self.settings.errors * math.hypot(point.error, other.error)


def merge_overlapping(jumps: list[Jump], sign: float) -> list[Jump]:
    """Return jumps by their voltages, those of one outcome whose brackets overlap as one."""
    merged: list[Jump] = []
    for jump in sorted(jumps, key=lambda jump: sign * jump.low):
        last = merged[-1] if merged else jump
        if merged and jump.outcome == last.outcome and sign * (jump.low - last.high) <= 0.0:
            high = max(last.high, jump.high, key=lambda eta0: sign * eta0)
            merged[-1] = last._replace(high=high)
        else:
            merged.append(jump)
    return merged
