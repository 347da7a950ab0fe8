"""Decide by a hysteresis loop of held voltages where the motor's speed jumps.

A jump is a loss of stability of the slow motion: two motions exist at one voltage, and the ramp
loses the first. A steep but continuous branch is not a jump. The rule, for a stretch of the voltage
in which the ramp's record suggests a jump:

- Voltages are held on a grid of steps `grid`, from the ramp's own state before the stretch to the
  stretch's end, each taken to at `rate` and held until the speed has settled (:mod:`.settled`);
  those at which it does not are left out.
- Every step in which the speed gains `smallest` on the voltage, or moves by `against` against it,
  is halved, to `width`.
- Then the voltage goes back over that step. The motion is *lost* there where the speed comes back
  more than `clear` away, and both motions last, within `same`, when they are held `again` times.
  Where it comes back, the step is halved further.
- There is *no* jump where no such step is left, and on the way back the speed is nowhere `clear`
  away.
- All else is *undecided*: a first speed, or one on the way back, that does not settle, two motions
  nearer than `clear`, a step still large at `finest`, another motion on the way back, a speed that
  moves against the voltage and what comes after it, or after `max_rounds` of this.

From differences the `errors` of irregular motions' speeds are taken off, but not on the last way
back. Non-dimensional: voltages over K omega, speeds over omega, times in 1/omega, in the mirror
image in which the motor turns forward.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..running.job import Table
from .ramp_record import NOT_SHOWN, RampRecord, Suspect
from .run import Run
from .schedule import Course, Schedule
from .settled import SettledSettings, settled_speed

NONE, LOST, UNDECIDED = range(3)
SAVED = (
    *("oscillator_state", "shaker_state", "master_memory"),
    *("balance_memory", "revolution_memory", "control_memory"),
)


@dataclass(frozen=True)
class HysteresisSettings(SettledSettings):
    """Set the steps and thresholds of the hysteresis loop; defaults serve all drives tried."""

    shown: float = 4e-3  # fall of the slip in a ramp's record that suggests a jump
    share: float = 0.1  # of that fall, before and after the stretch over which voltages are held
    apart: int = 12  # widths of the record's mean: falls of the slip that are closer are one
    grid: float = 4e-3  # longest first step of the voltage
    rate: float = 5e-5  # of the voltage from one step to the next, in a time 1/omega
    width: float = 1e-4  # widest bracket of a jump
    finest: float = 1e-6  # shortest step of the voltage
    # change of the speed over a step, beyond that of the voltage, up to which it may be one branch;
    # below 0.866 of `clear`, so that no steps find a jump that others rule out
    smallest: float = 4e-3
    against: float = 1e-3  # the same where the speed moves against the voltage
    same: float = 2e-3  # largest difference of two settled speeds of one motion
    clear: float = 5e-3  # smallest difference of two motions' speeds at one voltage at a jump
    again: int = 3  # times that the motions beside a jump are held again
    lag: float = 2.0  # rotor times 1/b by which a speed follows a ramp late, without a jump
    lead: float = 6.0  # how much earlier than the record a course begins, in rotor times 1/b
    max_rounds: int = 150  # of looking at the largest step of a course
    errors: float = 3.0  # standard errors that are taken off a difference of speeds
    parts: tuple[float, ...] = (0.5, 0.25, 0.75)  # of a step: where a speed between is sought
    left: float = 0.1  # of the way between two motions' speeds: with less to go, the first is left
    slots: int = 12  # jumps of a direction that are stored, by their voltages

    @property
    def of_a_record(self) -> tuple[float, float, float]:
        """Return what of the rule concerns a ramp's record."""
        return self.shown, self.share, self.apart


class HeldPoint(NamedTuple):
    """Store the speed that settled at a held voltage, and the state reached."""

    voltage: float
    speed: float  # NaN where it did not settle in time
    error: float  # of the speed of an irregular motion; 0 where it converged
    state: Table


class Jump(NamedTuple):
    """Store where a motion is lost, or may be: between two voltages, in the ramp's order."""

    outcome: int  # `LOST` or `UNDECIDED`
    low: float
    high: float
    shown: Suspect = NOT_SHOWN  # where the run's record shows it


class VoltageHolder:
    """Restore states of a past ramp and hold voltages from there until speeds settle."""

    def __init__(
        self,
        begin: Callable[[Schedule], Run],
        schedule: Schedule,
        step: float,
        omega: float,
        volts: float,
        longest: float,
        settings: HysteresisSettings | None = None,
    ) -> None:
        # `volts` is negative where the motor turns backward; `longest` is the longest hold, s
        self.begin, self.schedule, self.step = begin, schedule, step
        self.omega, self.volts, self.longest = omega, volts, longest
        self.settings = settings or HysteresisSettings()
        self.checkpoints: dict[int, Table] = {}

    def add_checkpoints(self, table: Table, every: int, steps: int) -> None:
        """Store the ramp's saved states by their communication step."""
        for i in range(len(table["master_memory"])):
            state = {name: table[name][[i]] for name in SAVED}
            self.checkpoints[min((i + 1) * every, steps)] = state

    def state_before(self, step: int) -> Table | None:
        """Return the ramp's state before a step, from a checkpoint; None at the start."""
        if step not in self.checkpoints and step:
            last = max((known for known in self.checkpoints if known < step), default=0)
            run = self.begin(self.schedule)
            try:
                if last:
                    run.set_state(self.checkpoints[last])
                run.speeds(range(last, step))
                self.checkpoints[step] = run.get_state()
            finally:
                run.master.close()
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
    ) -> HeldPoint:
        """Take the voltage to another one at `rate`, and hold it until the speed settles."""
        # with `ends`, until the speed has come from the first of two nearly to the second one
        settings = self.settings
        moves = math.ceil(abs(voltage - first) / settings.rate / self.omega / self.step)
        count = moves + math.ceil(self.longest / self.step)
        piece = max(1, round(settings.piece / self.omega / self.step))
        times = (0.0, moves * self.step, count * self.step)
        volts = (self.volts * first, self.volts * voltage, self.volts * voltage)
        run = self.begin(Course(times, volts))
        speeds, speed, error = np.zeros(0), math.nan, 0.0
        try:
            if state is not None:
                run.set_state(state)
            run.speeds(range(moves))
            for begin in range(moves, count, piece):
                found = run.speeds(range(begin, min(begin + piece, count)))
                speeds = np.append(speeds, np.abs(found) / self.omega)
                speed, error = settled_speed(speeds, settings)
                if math.isfinite(speed):
                    break
                late = speeds[-settings.block :]
                if ends and late.size:
                    to_go = abs(float(late.mean()) - ends[1])
                    if to_go < settings.left * abs(ends[0] - ends[1]):
                        speed = ends[1]
                        break
            return HeldPoint(voltage, speed, error, run.get_state())
        finally:
            run.master.close()


class HysteresisLoop(VoltageHolder):
    """Decide where a course of held voltages loses its motion."""

    def decide(self, record: RampRecord) -> list[Jump]:
        """Return all jumps of a run in one direction, by their voltages."""
        jumps = []
        for leg in record.legs():
            suspects = record.suspects(leg, *self.settings.of_a_record)
            if not self.longest:
                ends = ((record.eta0(at.before), record.eta0(at.after), at) for at in suspects)
                jumps += [Jump(UNDECIDED, *end) for end in ends]
                continue
            for suspect in suspects:
                jumps += self.decide_stretch(record, leg, suspect)
            rest = leg[leg > suspects[-1].after] if suspects else leg
            jumps += self.decide_end(record, rest) if rest.size else []
        return merge_overlapping(jumps, record.sign)

    def decide_stretch(self, record: RampRecord, leg: np.ndarray, suspect: Suspect) -> list[Jump]:
        """Return the jumps of a stretch in which the record of a ramp suggests one."""
        point = self.first_point(record, leg, suspect.before)
        jumps = self.jumps(point, record.eta0(suspect.after))
        earlier = [jump._replace(shown=record.suspect_at(jump.high, leg)) for jump in jumps[:-1]]
        return earlier + [jump._replace(shown=suspect) for jump in jumps[-1:]]

    def decide_end(self, record: RampRecord, leg: np.ndarray) -> list[Jump]:
        """Return the jumps shortly before the end of a ramp, which show after it only."""
        last = int(leg[-1])
        end = self.hold_step(record.step(last))
        change = abs(end.speed - record.speed(last)) - self.settings.errors * end.error
        if change - self.lag(record, leg, last) <= self.settings.shown:
            return []
        jumps = self.jumps(self.first_point(record, leg, last), record.eta0(last))
        return [jump._replace(shown=Suspect(last, last, last)) for jump in jumps]

    def first_point(self, record: RampRecord, leg: np.ndarray, before: int) -> HeldPoint:
        """Hold a voltage before a row, from the ramp's state, where the ramp's motion lasts."""
        row = record.row_earlier(before, self.settings.lead, leg)
        back = max(1, before - row)
        while True:
            point = self.hold_step(record.step(row))
            gained = record.sign * (point.speed - record.speed(row))
            margin, error = 2.0 * self.settings.same, self.settings.errors * point.error
            lasts = -margin - error < gained < margin + self.lag(record, leg, row)
            if lasts or row == leg[0]:
                return point
            row, back = max(int(leg[0]), row - back), 2 * back

    def lag(self, record: RampRecord, leg: np.ndarray, row: int) -> float:
        """Return by how much a speed may follow a ramp late, without a jump."""
        earlier = record.row_earlier(row, self.settings.lag, leg)
        return float(abs(record.eta0(row) - record.eta0(earlier)))

    def jumps(self, first: HeldPoint, last: float) -> list[Jump]:
        """Return the jumps between a held point and a voltage: an empty list for none."""
        undecided = [Jump(UNDECIDED, first.voltage, last)]
        if math.isnan(first.speed):
            return undecided
        sign = math.copysign(1.0, last - first.voltage)
        points = self.hold_grid(first, last)
        jumps: dict[tuple[float, float], Jump] = {}
        for _ in range(self.settings.max_rounds):
            i = self.largest_step(points, jumps, sign)
            if i is None:
                break
            step = points[i].voltage, points[i + 1].voltage
            is_wide = abs(step[1] - step[0]) > self.settings.width
            if is_wide and self.insert_between(points, i):
                continue
            if jump := self.jump_over(points, i, last):
                jumps[step] = jump
        else:
            return undecided
        if not jumps and not self.comes_back(points):
            return undecided
        steps = ((low.voltage, high.voltage) for low, high in pairwise(points))
        return [jumps[step] for step in steps if step in jumps]

    def jump_over(self, points: list[HeldPoint], i: int, last: float) -> Jump | None:
        """Return the jump over a step, by the way back; None where the step is small or halved."""
        low, high = points[i : i + 2]
        sign, length = math.copysign(1.0, last - low.voltage), abs(high.voltage - low.voltage)
        landed, before = self.hold_from(low, high.voltage), low.voltage
        outcome = self.way_back(low, landed)
        points[i + 1] = high = landed if math.isfinite(landed.speed) else high
        may_be_none = outcome == NONE and length > self.settings.finest
        if may_be_none and (self.excess(low, high, sign) <= 0.0 or self.insert_between(points, i)):
            return None
        if sign * (high.speed - low.speed) < 0.0:  # what a ramp comes to there is chance
            del points[i + 2 :]
            return Jump(UNDECIDED, low.voltage, last)
        if outcome == LOST:
            outcome, before = self.confirm(points[: i + 1], sign)
        return Jump(outcome or UNDECIDED, before, high.voltage)

    def hold_grid(self, first: HeldPoint, last: float) -> list[HeldPoint]:
        """Step the voltage over the grid; return the points at which the speed settled."""
        count = max(1, math.ceil(abs(last - first.voltage) / self.settings.grid - 1e-9))
        points = [first]
        for voltage in np.linspace(first.voltage, last, count + 1)[1:].tolist():
            point = self.hold_from(points[-1], voltage)
            if math.isfinite(point.speed):
                points.append(point)
        return points

    def largest_step(
        self, points: list[HeldPoint], decided: dict[tuple[float, float], Jump], sign: float
    ) -> int | None:
        """Return the index of the largest undecided step of the speed; None if all are small."""
        excess = [
            -math.inf if (low.voltage, high.voltage) in decided else self.excess(low, high, sign)
            for low, high in pairwise(points)
        ]
        i = int(np.argmax(excess)) if excess else 0
        return i if excess and excess[i] > 0.0 else None

    def excess(self, low: HeldPoint, high: HeldPoint, sign: float) -> float:
        """Return by how much the speed changes more than on one branch, on which it rises."""
        scatter = min(self.error(low, high), self.settings.smallest)
        gained, length = sign * (high.speed - low.speed), abs(high.voltage - low.voltage)
        against = -gained - self.settings.against
        return max(gained - self.settings.smallest - length, against) - scatter

    def way_back(self, low: HeldPoint, landed: HeldPoint) -> int:
        """Return whether two motions exist at a step's lower voltage and the first is lost."""
        back = self.hold_from(landed, low.voltage)
        distance = self.distance(back, low)
        if distance <= self.settings.same:
            return NONE
        if math.isnan(back.speed) or distance < self.settings.clear:
            return UNDECIDED
        return LOST if self.hold_again(back) is back else UNDECIDED

    def confirm(self, points: list[HeldPoint], sign: float) -> tuple[int, float]:
        """Hold the motion before a loss again; return outcome and the voltage where it stays."""
        # near its end a motion seems to settle before it leaves: then one `width` earlier counts
        low, voltage = points[-1], points[-1].voltage - sign * self.settings.width
        later = self.hold_again(low)
        if later is low:
            return LOST, low.voltage
        earlier = [point for point in points if sign * (voltage - point.voltage) >= 0.0]
        stays = self.hold_from(earlier[-1], voltage) if earlier else later
        if stays is later or self.hold_again(stays) is not stays:
            return UNDECIDED, low.voltage
        return self.way_back(stays, later), voltage

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
        for part in self.settings.parts:
            voltage = low.voltage + part * (high.voltage - low.voltage)
            point = self.hold_from(low, voltage, high.speed)
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
            if abs(back.speed - point.speed) >= self.settings.clear:
                return False
            if math.isfinite(back.speed):
                last, settled = back, True
            elif settled and point is not points[0]:
                settled = False
            else:
                return False
        return True

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
