"""Decide by a hysteresis loop of held voltages where the motor's speed jumps.

A jump is a loss of stability of the slow motion: two motions exist at one voltage, and the ramp
loses the first. A steep but continuous branch is not a jump. The rule, for each ramp as a whole:

- From the ramp's own state at its beginning, the voltage is raised at `rate` from one value of a
  `grid` to the next, and held until the speed has settled (:mod:`.steady_speed`).
- In the ramp's order, a step over which the speed gains `bend` more or less than by the slope over
  as long a step before is divided at `parts`, to `width`.
- The motion before such a step has to last: if disturbances are known to grow (:mod:`.growth`), for
  `growths` growth times; if that is unknown, `lives` times as long as it took to settle or lasted
  past the step; both up to `patience` holds. If it does not, what it has become takes its place.
- It is *lost* where the speed, taken back over the step, lasts `clear` away. There is *no* jump
  where the speed comes back over each such step, to `same`, or the two motions are `small` apart,
  and is nowhere `clear` away on a way back over all of the ramp.
- All else is *undecided*: what does not settle, what is left after a `budget` of holds, and what
  comes after a loss by less than `clear`, or against the voltage, unless the motion had converged
  and comes to one other at each of some `landings` past it.

Speeds of irregular motions have errors, which are taken off. Non-dimensional: voltages over K
omega, speeds over omega, times in 1/omega, in the mirror image in which the motor turns forward.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..model.drive import Drive
from ..model.structure import Structure
from ..running.job import Table
from .ramp_record import RampRecord
from .run import MotorRun, select_state
from .schedule import Course, Schedule
from .steady_speed import SettledSettings, settled_speed

NONE, LOST, UNDECIDED = range(3)


@dataclass(frozen=True)
class HysteresisSettings(SettledSettings):
    """Set the steps and thresholds of the hysteresis loop; defaults serve all drives tried."""

    grid: float = 0.02  # longest first step of the voltage
    rate: float = 5e-5  # of the voltage from one step to the next, in a time 1/omega
    width: float = 1e-4  # of a step that is not halved: widest bracket of a jump, if motions settle
    bend: float = 1e-3  # more or less of the speed over a step than by the slope before it
    same: float = 2e-3  # largest difference of two settled speeds of one motion
    small: float = 4.5e-3  # difference of two motions' speeds up to which their exchange is no jump
    clear: float = 5e-3  # the same from which on it is one
    landings: int = 6  # voltages past a small loss, or one against the voltage, that are tried
    lives: float = 5.0  # times that a motion has to last what it took to settle, or lasted past it
    growths: float = 30.0  # growth times after which a motion is seen to last, or not
    patience: float = 10.0  # `max_hold` that these may be
    budget: float = 60.0  # `max_hold` of a ramp, beside its grid
    parts: tuple[float, ...] = (0.5, 0.25, 0.75)  # of a step: where a speed between is sought
    base_hold: float = 4000.0  # longest hold by default, in 1/omega, of a rotor without inertia
    rotor_holds: float = 200.0  # and the times 1/b, in which the rotor settles, added to it

    def usual_hold(self, structure: Structure, drive: Drive) -> float:
        """Return the longest time, s, for which a voltage is held by default."""
        return (self.base_hold + self.rotor_holds / drive.b(structure)) / structure.omega


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
        start_run: Callable[[Schedule], MotorRun],
        schedule: Schedule,
        step: float,
        omega: float,
        volts: float,
        max_hold: float,
        settings: HysteresisSettings | None = None,
        growth: Callable[[MotorRun, float, float], float] | None = None,
    ) -> None:
        # `volts` is negative where the motor turns backward; `max_hold` is in s;
        # `growth` returns the rate, 1/s, at which disturbances of a run's motion grow
        self.start_run, self.schedule, self.step = start_run, schedule, step
        self.omega, self.volts, self.max_hold = omega, volts, max_hold
        self.settings, self.growth = settings or HysteresisSettings(), growth
        self.checkpoints: dict[int, Table] = {}
        self.left_out: set[float] = set()  # voltages at which a motion does not settle again
        self.spent = 0.0  # s, for which motions of a ramp were held on

    def add_checkpoints(self, table: Table, chunk_size: int, step_count: int) -> None:
        for i in range(len(table["master_memory"])):
            state = select_state(table, slice(i, i + 1))
            self.checkpoints[min((i + 1) * chunk_size, step_count)] = state

    def ramp_state_before(self, step: int) -> Table | None:
        """Return the ramp's state before a step, from a checkpoint; None at the start."""
        if step not in self.checkpoints and step:
            last = max((known for known in self.checkpoints if known < step), default=0)
            with closing(self.start_run(self.schedule)) as run:
                if last:
                    run.set_state(self.checkpoints[last])
                run.run_steps_for_speeds(range(last, step))
                self.checkpoints[step] = run.get_state()
        return self.checkpoints.get(step)

    def hold_ramp_voltage(self, step: int) -> HeldPoint:
        voltage = self.schedule.voltage((step + 0.5) * self.step) / self.volts
        return self.move_and_hold(self.ramp_state_before(step), voltage, voltage)

    def hold_from(self, point: HeldPoint, voltage: float) -> HeldPoint:
        """Take the voltage slowly from a held point to another one, and hold it there."""
        return self.move_and_hold(point.state, point.voltage, voltage)

    def move_and_hold(
        self, state: Table | None, first: float, voltage: float, min_time: float = 0.0
    ) -> HeldPoint:
        """Take the voltage to another one at `rate`, and hold it until the speed settles."""
        # for the time `min_time`, s, unless it has left
        settings = self.settings
        moves = math.ceil(abs(voltage - first) / settings.rate / self.omega / self.step)
        count = moves + math.ceil((min_time + self.max_hold) / self.step)
        piece = max(1, round(settings.piece / self.omega / self.step))
        times = (0.0, moves * self.step, count * self.step)
        volts = (self.volts * first, self.volts * voltage, self.volts * voltage)
        speeds, speed, error, time = np.zeros(0), math.nan, 0.0, 0.0
        with closing(self.start_run(Course(times, volts))) as run:
            if state is not None:
                run.set_state(state)
            run.run_steps_for_speeds(range(moves))
            for begin in range(moves, count, piece):
                end = min(begin + piece, count)
                found, time = run.run_steps_for_speeds(range(begin, end)), (end - moves) * self.step
                speeds = np.append(speeds, np.abs(found) / self.omega)
                speed, error = settled_speed(speeds, settings)
                left = abs(speed - speeds[: settings.block].mean()) - error > settings.clear
                if math.isfinite(speed) and (left or time >= min_time):
                    break
            self.spent += time
            return HeldPoint(voltage, speed, error, run.get_state(), time)

    # -- the rule --

    def decide_jumps(self, record: RampRecord) -> list[Jump]:
        jumps = []
        for leg in record.rows_by_leg():
            first, last = record.eta0(leg[[0, -1]]).tolist()
            if self.max_hold:
                start = self.hold_ramp_voltage(record.step_of_row(int(leg[0])))
                jumps += self.find_jumps(start, last)
            else:
                jumps.append(Jump(UNDECIDED, first, last))
        return merge_overlapping(jumps, record.voltage_direction)

    def find_jumps(self, first: HeldPoint, last: float) -> list[Jump]:
        sign = math.copysign(1.0, last - first.voltage)
        points = self.hold_grid(first, last)
        if not points:
            return [Jump(UNDECIDED, first.voltage, last)]
        jumps: list[Jump] = []
        self.spent, i = 0.0, 0
        while i < len(points) - 1:
            low, high = points[i : i + 2]
            lifetime = self.required_lifetime(low, high)
            if self.excess_change(points, i, jumps) <= 0.0:
                i += 1
            elif self.spent > self.settings.budget * self.max_hold:
                del points[i + 1 :]
            elif self.insert_point_between(points, i):
                continue
            elif low.lasts < lifetime:
                points[i] = self.hold_until_lasting(low, high, lifetime)
                if points[i].lasts:
                    continue
                if math.isnan(points[i].speed):
                    self.left_out.add(points.pop(i).voltage)
                jumps = [jump for jump in jumps if sign * (jump.high - low.voltage) < 0.0]
                i = max(i - 1, 0)
            elif jump := self.update_step_and_find_jump(points, i, jumps):
                jumps.append(jump)
                i += 1
        known = [jump for jump in jumps if jump.outcome != NONE]
        if not known and not self.comes_back_over_all(points):
            return [Jump(UNDECIDED, first.voltage, last)]
        beyond = [(first.voltage, points[0].voltage), (points[-1].voltage, last)]
        unsettled = [Jump(UNDECIDED, *ends) for ends in beyond if ends[0] != ends[1]]
        return merge_overlapping([*known, *unsettled], sign)

    def hold_grid(self, first: HeldPoint, last: float) -> list[HeldPoint]:
        """Step the voltage over the grid; return the points at which the speed settled."""
        count = max(1, math.ceil(abs(last - first.voltage) / self.settings.grid - 1e-9))
        points = [first]
        for voltage in np.linspace(first.voltage, last, count + 1)[1:].tolist():
            points.append(self.hold_from(points[-1], voltage))
        return [point for point in points if math.isfinite(point.speed)]

    def excess_change(self, points: list[HeldPoint], i: int, jumps: list[Jump]) -> float:
        """Return by how much the speed changes more over a step than on one branch."""
        low, high = points[i : i + 2]
        length = abs(high.voltage - low.voltage)
        begin = abs(jumps[-1].high - low.voltage) if jumps else math.inf
        before = [p for p in points[:i] if abs(p.voltage - low.voltage) <= begin]
        near, others = (low, before) if before else (high, points[i + 2 :])
        slopes = {abs(abs(p.voltage - near.voltage) - length): speed_slope(p, near) for p in others}
        expected = slopes[min(slopes)] if slopes else 1.0  # over about as long a step
        change = abs(speed_slope(low, high) - expected) * length
        return (
            change - self.settings.bend - min(self.difference_error(low, high), self.settings.same)
        )

    def insert_point_between(self, points: list[HeldPoint], i: int) -> bool:
        """Hold voltages within a wide step until one settles; insert it and return whether any."""
        low, high = points[i : i + 2]
        change = high.voltage - low.voltage
        for part in self.settings.parts if abs(change) > self.settings.width else ():
            voltage = low.voltage + part * change
            if voltage in self.left_out:
                continue
            point = self.hold_from_low_end(low, voltage, high, requires_lifetime=False)
            if math.isfinite(point.speed):
                points.insert(i + 1, point)
                return True
            self.left_out.add(voltage)
        return False

    def update_step_and_find_jump(
        self, points: list[HeldPoint], i: int, jumps: list[Jump]
    ) -> Jump | None:
        """Replace a step's end by what lasts, drop unsure ones after; return the jump, or None."""
        low, high = points[i : i + 2]
        landed = self.hold_from_low_end(low, high.voltage, high, requires_lifetime=True)
        points[i + 1] = high = landed if math.isfinite(landed.speed) else high
        is_brief = low.lasts < self.required_lifetime(low, high)
        if is_brief or self.excess_change(points, i, jumps) <= 0.0:
            return None
        outcome, change = self.outcome_of_way_back(low, high), abs(high.speed - low.speed)
        is_clear = math.copysign(change, speed_slope(low, high)) >= self.settings.clear
        if outcome != NONE and not is_clear:
            if not self.lands_on_one_motion(low, high):
                del points[i + 2 :]
            elif change < self.settings.small:
                outcome = NONE
        if outcome == NONE and abs(high.voltage - low.voltage) > self.settings.width:
            outcome = UNDECIDED
        return Jump(outcome, low.voltage, high.voltage, low.speed, high.speed)

    def outcome_of_way_back(self, low: HeldPoint, high: HeldPoint) -> int:
        """Return whether two motions last at a step's lower voltage and the first is lost."""
        back = self.hold_from(high, low.voltage)
        if self.may_be_same_motion(back, low):
            return NONE
        later = self.hold_until_lasting(back, back, self.required_lifetime(back, back))
        if self.may_be_same_motion(later, low):
            return NONE
        lasts = self.speed_distance(later, back) <= self.settings.same
        is_clear = self.speed_distance(back, low) >= self.settings.clear
        return LOST if lasts and is_clear else UNDECIDED

    def lands_on_one_motion(self, low: HeldPoint, high: HeldPoint) -> bool:
        """Return whether a motion that had converged comes to one other wherever it is lost."""
        step, point = math.copysign(self.settings.width, high.voltage - low.voltage), high
        for n in range(self.settings.landings):
            point = self.hold_from(point, high.voltage + 2**n * step)
            away = abs(self.hold_from(low, point.voltage).speed - point.speed)
            if not away < self.settings.clear:
                return False
        return low.error == 0.0

    def hold_from_low_end(
        self, low: HeldPoint, voltage: float, high: HeldPoint, requires_lifetime: bool
    ) -> HeldPoint:
        """Hold a voltage within a step or at its high end, from the motion at its low end."""
        # a motion that stays nearer to that of the low end is held on where its disturbances may
        # grow: with `requires_lifetime` at least that long, else only if their growth is known
        point = self.hold_from(low, voltage)
        if abs(point.speed - low.speed) < abs(point.speed - high.speed):
            lifetime = self.required_lifetime(point, high) if requires_lifetime else 0.0
            return self.hold_until_lasting(point, high, lifetime)
        return point._replace(time=max(point.time, high.time))

    def required_lifetime(self, low: HeldPoint, high: HeldPoint) -> float:
        """Return for how long, s, a motion before a step has to last if it may be a transient."""
        lifetime = self.settings.lives * max(low.time, high.time)
        return min(lifetime, self.settings.patience * self.max_hold)

    def hold_until_lasting(self, point: HeldPoint, high: HeldPoint, lifetime: float) -> HeldPoint:
        """Hold a motion until it is known to last; return it, or what it has become."""
        # at least for the time `lifetime`, s, unless disturbances of it are known to decay
        rate = self.growth_rate(point)
        if rate <= 0.0:
            return point._replace(lasts=math.inf)
        grown = self.settings.growths / rate if rate > 0.0 else 0.0
        if grown > self.settings.patience * self.max_hold:
            return point._replace(speed=math.nan, lasts=0.0)
        lifetime = max(grown, lifetime - point.lasts)
        if lifetime <= 0.0:
            return point
        later = self.move_and_hold(point.state, point.voltage, point.voltage, lifetime)
        lasted = point.lasts + later.time
        if self.speed_distance(later, point) <= self.settings.same:
            return later._replace(time=point.time, lasts=lasted)
        return later._replace(time=max(point.time + lasted, high.time))

    def growth_rate(self, point: HeldPoint) -> float:
        """Return the rate, 1/s, at which disturbances of a motion grow; NaN if it is unknown."""
        if self.growth is None:
            return math.nan
        with closing(self.start_run(self.schedule)) as run:
            run.set_state(point.state)
            speed = math.copysign(point.speed, self.volts) * self.omega
            return self.growth(run, point.voltage * self.volts, speed)

    def comes_back_over_all(self, points: list[HeldPoint]) -> bool:
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

    def may_be_same_motion(self, point: HeldPoint, other: HeldPoint) -> bool:
        """Return whether two settled speeds may be of one motion, and are not `clear` away."""
        is_near = abs(point.speed - other.speed) < self.settings.clear
        return is_near and self.speed_distance(point, other) <= self.settings.same

    def speed_distance(self, point: HeldPoint, other: HeldPoint) -> float:
        """Return how far two settled speeds are apart at least, by their errors."""
        return abs(point.speed - other.speed) - self.difference_error(point, other)

    def difference_error(self, point: HeldPoint, other: HeldPoint) -> float:
        """Return the error of the difference between two settled speeds."""
        return math.hypot(point.error, other.error)


def speed_slope(low: HeldPoint, high: HeldPoint) -> float:
    return (high.speed - low.speed) / (high.voltage - low.voltage)


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
