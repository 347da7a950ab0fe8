"""Bracket the voltage at which a speed jump happens, by holding voltages until speeds settle.

Where the record of a ramp does not tell a jump from a steep branch, a state of the run is restored
and its voltage is held until the speed has settled. From there the voltage goes on in short steps,
each held until the speed has settled, so that the motion stays the same as long as it lasts. Where
the speed changes most the steps are halved: the largest change of the settled speed is bracketed,
whatever the rate of the ramp was. Then the voltage goes back from beyond that change. Where the
speed does not come back with it, two motions exist at one voltage, and the first one is lost on the
way. The course begins before the resonance and ends beyond it, of the bonded structure and of the
delaminated one. Where the speed comes back, the steps are halved further, until the speed changes
less from each of them to the next than it would between two motions that are told apart, and all
the steps go back: so the speed follows the voltage. What has not settled in the time that is given,
comes back another way, or is still steep at the shortest step, decides nothing. Where the speed
falls back against the way of the voltage a motion ends too, and chance may have it to which other
one a ramp comes: the course tries ramps from before that end. A motion is held again before its end
counts as a loss, and what a loss leads to is followed in short steps: it may end soon.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..running.job import Chunk, Table
from .further_jumps import SMALLEST
from .jumps import Passing
from .run import Run
from .schedule import Constant, Ramp, Schedule

MEMORY = (
    "oscillator_state",
    "shaker_state",
    "master_memory",
    "revolution_memory",
    "control_memory",
)
FIRST = 4  # revolutions of a hold whose speed is still that of the ramp
NOT_ASKED, LOST, FOLLOWS, LEFT_BEFORE, UNDECIDED = range(5)
MEANINGS = {
    NOT_ASKED: "not asked",
    LOST: "lost",
    FOLLOWS: "follows",
    LEFT_BEFORE: "left before",
    UNDECIDED: "undecided",
}


class Verdict(NamedTuple):
    """Store a result of the held-voltage test: the outcome and the bracket of voltages.

    Attributes
    ----------
    outcome : int
        ``NOT_ASKED``, ``LOST``, ``FOLLOWS``, ``LEFT_BEFORE`` or ``UNDECIDED``.
    low, high : float
        The last voltage at which the motion stays and the first at which it is lost, V; of an
        undecided verdict the voltages between which the speed changes most, as far as known; NaN
        else.
    """

    outcome: int
    low: float = math.nan
    high: float = math.nan


class HeldCourse(NamedTuple):
    """Store the verdicts on the largest and on all other speed changes of a held course.

    Attributes
    ----------
    verdict : Verdict
        On the largest change of the speed.
    further : tuple of Verdict
        On the others at which a motion is lost, or may be.
    """

    verdict: Verdict
    further: tuple[Verdict, ...] = ()


class HeldPoint(NamedTuple):
    """Store where the speed settled at a held voltage, and the state reached.

    Attributes
    ----------
    voltage : float
        V.
    speed : float
        Mean speed over omega that it settles at; NaN where it had not settled in time.
    error : float
        Of the speed of an irregular motion; 0 where it settles.
    begin : float
        Mean speed of the first revolutions; NaN where there are none.
    state : dict of ndarray
        Of the run, to go on from.
    origin : float
        Voltage from which it was reached in one step, V; NaN where that was a state of the run.
    least, most : float
        Extremes of its mean speeds on the way there, over omega; NaN where there are none.
    """

    voltage: float
    speed: float
    error: float
    begin: float
    state: Table
    origin: float
    least: float = math.nan
    most: float = math.nan


@dataclass(frozen=True)
class HoldSettings:
    """Set steps, tolerances and limits of the held-voltage test.

    Attributes
    ----------
    block : int
        Revolutions of a mean speed; a multiple of the periods after which motions usually repeat.
    tolerance : float
        Of the speed that a motion settles at, over omega.
    width : float
        Of the bracket of voltages that is asked for, over K omega.
    finest : float
        Shortest step of the voltage, over K omega: where the speed still changes much over one, and
        comes back, nothing is decided.
    distinct : float
        Largest difference of two settled speeds that may be of the same motion, over omega.
    two_motions : float
        Smallest difference of two settled speeds at one voltage that makes a jump, over omega.
    smallest_jump : float
        Change of the settled speed between neighbours, over omega, below which there is no jump. It
        is less than 0.866 ``two_motions``: between two folds that are close, speeds at one voltage
        differ by 2/sqrt(3) of what the speed jumps by at either, or less. So no steps find a jump
        that others rule out.
    further_motions, further_jump : float
        The same two for jumps beside the largest one: a record shows none that is smaller at every
        usual rate, so that whether it is told would depend on the rate.
    largest_scatter : float
        Change of the speed between neighbours, over omega, that is never put down to the scatter of
        irregular motions: speeds that are known no better rule out no jump.
    again : int
        How often a voltage is held again before the end of its motion counts as a loss, and how
        often one is reached again from an irregular motion.
    by_chance : float
        Range of voltages, over K omega, in which a motion may end meanwhile: where it does in a
        wider one, it ends by chance or has long been unstable, and nothing is decided.
    stair : float
        Longest first step of the voltage, over K omega, and
    max_stairs : int
        how many of them there are at most.
    short : float
        Longest step, over K omega, in which a motion is followed at first that a loss leads to.
    past : float
        How far past the passing of the ramp the steps go, over K omega.
    max_holds : int
        Most voltages that are held after them.
    rates : tuple of float
        Of ramps from the end of a motion, over K omega in a time 1/omega: usual ones, whatever that
        of the run was.
    """

    block: int = 24
    tolerance: float = 1e-4
    width: float = 1e-4
    finest: float = 1e-6
    distinct: float = 2e-3
    two_motions: float = 5e-3
    smallest_jump: float = 4e-3
    further_motions: float = SMALLEST
    further_jump: float = 0.8 * SMALLEST
    largest_scatter: float = 8e-3
    again: int = 3
    by_chance: float = 2e-4
    stair: float = 4e-3
    max_stairs: int = 25
    short: float = 5e-4
    past: float = 0.02
    max_holds: int = 200
    rates: tuple[float, ...] = (2e-4, 1e-4, 5e-5)


class HeldVoltageTest:
    """Test whether a past ramp lost a motion, by restoring states and holding voltages.

    Parameters
    ----------
    begin : callable
        Begins a run with another schedule.
    schedule : Schedule
        Of the run.
    step : float
        Its communication step, s.
    omega, volts : float
        The units of speed and voltage.
    longest : float
        Time for which a voltage is held at most, s.
    settings : HoldSettings, optional
    """

    def __init__(
        self,
        begin: Callable[[Schedule], Run],
        schedule: Schedule,
        step: float,
        omega: float,
        volts: float,
        longest: float,
        settings: HoldSettings | None = None,
    ) -> None:
        """Store the ramp's schedule, its units and the settings of the test."""
        self.begin, self.schedule, self.step = begin, schedule, step
        self.omega, self.volts, self.longest = omega, volts, longest
        self.settings = settings or HoldSettings()
        self.checkpoints: dict[int, Table] = {}

    def for_further_jumps(self) -> HeldVoltageTest:
        """Return a copy of this test with the settings for further jumps."""
        test, settings = copy(self), self.settings
        test.settings = replace(
            settings, two_motions=settings.further_motions, smallest_jump=settings.further_jump
        )
        return test

    def add_checkpoints(self, table: Table, every: int, steps: int) -> None:
        """Store the ramp's saved states by their communication step."""
        for i in range(len(table["master_memory"])):
            state = {name: table[name][[i]] for name in MEMORY}
            self.checkpoints[min((i + 1) * every, steps)] = state

    def state_before(self, step: int) -> Table | None:
        """Return the ramp's state before a step, from a checkpoint; None at the start."""
        if step not in self.checkpoints and step:
            last = max((known for known in self.checkpoints if known < step), default=0)
            state = self.checkpoints[last] if last else None
            self.checkpoints[step] = self.follow_schedule(self.schedule, state, range(last, step))
        return self.checkpoints.get(step)

    def follow_schedule(self, schedule: Schedule, state: Table | None, steps: range) -> Table:
        """Return the state after communication steps of a schedule, from a state or the start."""
        run = self.begin(schedule)
        try:
            if state is not None:
                run.set_state(state)
            run.revolve(steps)
            return run.get_state()
        finally:
            run.master.close()

    def hold_step(self, step: int) -> HeldPoint:
        """Hold the voltage that the ramp has at a step, from its state there."""
        return self.hold_voltage(self.state_before(step), self.ramp_voltage(step))

    def ramp_voltage(self, step: int) -> float:
        """Return the voltage of the ramp at a communication step, V."""
        return self.schedule.voltage((step + 0.5) * self.step)

    def step_from(self, point: HeldPoint, voltage: float) -> HeldPoint:
        """Change the voltage in one step from a held point, and hold it there."""
        return self.hold_voltage(point.state, voltage)._replace(origin=point.voltage)

    def ramp_from(self, point: HeldPoint, voltage: float, rate: float) -> HeldPoint:
        """Ramp the voltage from a held point at a rate over K omega^2, and hold it then."""
        ramp = Ramp(point.voltage, voltage, rate * self.volts * self.omega, back=False)
        steps = range(math.ceil(ramp.duration / self.step))
        return self.hold_voltage(self.follow_schedule(ramp, point.state, steps), voltage)

    def hold_voltage(self, state: Table | None, voltage: float) -> HeldPoint:
        """Simulate a constant voltage from a state until the speed settles."""
        count = math.ceil(self.longest / self.step)
        piece = max(1, round(150.0 / self.omega / self.step))
        run, speeds = self.begin(Constant(voltage, count * self.step)), np.zeros(0)
        speed, error, means = math.nan, 0.0, np.zeros(0)
        try:
            if state is not None:
                run.set_state(state)
            for first in range(0, count, piece):
                rows = run.revolve(range(first, min(first + piece, count)))
                speeds = np.append(speeds, np.abs(rows["speed"]) / self.omega)
                means = block_means(speeds, self.settings)
                speed, error = settled_speed(means, self.settings)
                if math.isfinite(speed):
                    break
            begin = float(speeds[:FIRST].mean()) if speeds.size else math.nan
            ends = (float(means.min()), float(means.max())) if means.size else (math.nan, math.nan)
            return HeldPoint(voltage, speed, error, begin, run.get_state(), math.nan, *ends)
        finally:
            run.master.close()

    def classify(
        self,
        steps: Passing,
        ends: tuple[int, int],
        threshold: float,
        up: bool,
        resonance: tuple[float, float] | None = None,
    ) -> HeldCourse:
        """Decide whether a passage of a speed threshold loses the motion, and where.

        Parameters
        ----------
        steps : Passing
            By steps of the run.
        ends : (int, int)
            Steps at which the voltage begins and ceases to go this way.
        threshold : float
            Speed over omega between the motions below and beyond the resonance.
        up : bool
        resonance : (float, float), optional
            Least and largest speed that may divide them: the held course begins before both and
            ends beyond both, as far as the run goes. By default both are the threshold.
        """
        sign = 1.0 if up else -1.0
        near, far = (resonance or (threshold, threshold))[:: 1 if up else -1]

        def is_beyond(point: HeldPoint, threshold: float = threshold) -> bool:
            """Return whether a held speed has passed a threshold in the voltage's direction."""
            return sign * (point.speed - threshold) > 0.0

        step, back = steps.before, max(1, steps.row - steps.before)
        low = self.hold_step(step)
        while math.isnan(low.speed) or is_beyond(low, near) or self.has_left_motion(low, sign):
            if step <= ends[0]:
                if math.isnan(low.speed):
                    return HeldCourse(Verdict(UNDECIDED))
                if is_beyond(low):
                    return HeldCourse(Verdict(LEFT_BEFORE))
                break
            step, back = max(ends[0], step - back), 2 * back
            low = self.hold_step(step)
        low = self.begin_before_end(low, step, ends[0], sign)
        target = self.target_voltage(steps.after, ends[1], sign)
        points = self.climb_stairs(low, target)
        if not is_beyond(points[-1], far):
            points += self.extend_past(points[-1], target, ends[1], sign, far)
        if not is_beyond(points[-1]):
            return HeldCourse(Verdict(UNDECIDED, points[-1].voltage, target))
        verdict, *others = self.judge_course(list(points), sign)
        if verdict.outcome == FOLLOWS and not (
            is_beyond(points[-1], far) and self.returns_same_way(points)
        ):
            verdict = Verdict(UNDECIDED, low.voltage, points[-1].voltage)
        return HeldCourse(verdict, tuple(others))

    def losses_before_the_end(self, steps: tuple[int, int], up: bool) -> list[Verdict]:
        """Hold voltages to the end of a ramp and bracket the losses that it would show afterwards.

        Parameters
        ----------
        steps : (int, int)
            Of the run, at which the course begins, and at which the ramp ends.
        up : bool

        Returns
        -------
        list of Verdict
            Losses, certain and undecided ones; none where the speed follows the voltage.
        """
        sign, test = 1.0 if up else -1.0, self.for_further_jumps()
        low = self.hold_step(steps[0])
        points = self.climb_stairs(low, self.ramp_voltage(steps[1]))
        if not test.may_leave_a_motion(points, sign):
            return []  # so where the first voltage does not settle
        verdicts = test.judge_course(points, sign)
        return [verdict for verdict in verdicts if verdict.outcome != FOLLOWS]

    def judge_course(self, points: list[HeldPoint], sign: float) -> list[Verdict]:
        """Bracket the losses of a course; undecided are those that another ramp may not meet.

        A motion may end against the way: the speed goes back to that of another motion, which the
        course follows then. But a ramp goes on while its motion ends, and may come to one further
        along instead, as chance has it. Where one does, the motion is lost at that end; and where
        one may, what the course loses afterwards is undecided.
        """
        found = self.find_left_motion(points, sign)
        if found is None:
            verdicts = self.bracket_changes(points, sign)
            if any(self.retrace_landing(points, verdict, sign) for verdict in verdicts):
                verdicts = self.bracket_changes(points, sign)
            found = self.find_left_motion(points, sign)  # halved steps show what longer ones hid
            if found is None:
                return verdicts
        i, end = found
        before, after = (
            [
                verdict
                for verdict in (self.bracket_changes(part, sign) if len(part) > 1 else [])
                if verdict.outcome != FOLLOWS
            ]
            for part in (points[: i + 1], points[i + 1 :])
        )
        return [end, *before, *(verdict._replace(outcome=UNDECIDED) for verdict in after)]

    def find_left_motion(self, points: list[HeldPoint], sign: float) -> tuple[int, Verdict] | None:
        """Find a motion that ends against the way and may be left for one further along, or None.

        Steps in which the speed falls back, or came back from further along, are halved: the course
        takes up what the halves settle at, as a motion that exists in a narrow range of voltages.

        Returns
        -------
        (int, Verdict), optional
            Index of the last point before its end, and the end: ``LOST`` or ``UNDECIDED``.
        """
        i = 0
        while i + 1 < len(points):
            points[i + 1 : i + 1] = self.halve_fall(points[i], points[i + 1], sign)
            what = self.classify_landing(points[i:], sign)
            if what != FOLLOWS:
                return i, Verdict(what, points[i].voltage, points[i + 1].voltage)
            i += 1
        return None

    def retrace_landing(self, points: list[HeldPoint], end: Verdict, sign: float) -> bool:
        """Follow the motion that a loss leads to in short steps; return whether it ends soon.

        The course came there in long steps, which pass over the end of a motion. Where short ones
        come to another motion than they did, the course goes on with that.
        """
        i = next((i for i, point in enumerate(points) if point.voltage == end.high), len(points))
        if end.outcome != LOST or i + 1 >= len(points):
            return False
        landed, after = points[i], points[i + 1 :]
        far = (
            j
            for j in range(len(after))
            if not self.is_within(landed, after[j], self.settings.stair)
        )
        j = next(far, len(after) - 1)
        path = self.climb_stairs(landed, after[j].voltage, self.settings.short)
        if path[-1].voltage != after[j].voltage:
            return False
        is_same = not self.differ(path[-1], after[j])
        tail = after[j + 1 :] if is_same else self.climb_stairs(path[-1], after[-1].voltage)[1:]
        points[i:] = path + tail
        return not is_same or self.may_leave_a_motion(path, sign)

    def may_leave_a_motion(self, points: list[HeldPoint], sign: float) -> bool:
        """Return whether the speed changes too much somewhere for one motion, either way."""
        return any(
            self.may_be_a_loss(*pair, sign) or self.falls_back(*pair, sign)
            for pair in pairwise(points)
        )

    def falls_back(self, low: HeldPoint, high: HeldPoint, sign: float) -> bool:
        """Return whether the speed changes against the way of the voltage, by another motion's."""
        return sign * (high.speed - low.speed) < 0.0 and self.differ(low, high)

    def halve_fall(self, low: HeldPoint, high: HeldPoint, sign: float) -> list[HeldPoint]:
        """Halve a step in which the speed falls back; return the points of a course between.

        So where it came back from further along while the last voltage was held. The last points
        are those before and past the end of the motion, unless the halves do not settle.
        """
        lows, last = [], high
        if not (self.falls_back(low, high, sign) or self.passed_further(low, high, sign)):
            return []
        while not self.is_within(low, high, self.settings.width):
            middle = self.settled_between(low, high)
            if middle is None:
                break
            if self.falls_back(low, high, sign):
                stays = sign * (high.speed - middle.speed) < sign * (middle.speed - low.speed)
            else:
                stays = not self.came_back(middle, sign)
            low, high = (middle, high) if stays else (low, middle)
            lows += [middle] if stays else []
        return lows + ([high] if high is not last else [])

    def passed_further(self, low: HeldPoint, high: HeldPoint, sign: float) -> bool:
        """Return whether a speed came back from further along, but to no motion further along."""
        return self.came_back(high, sign) and not self.may_be_a_loss(low, high, sign)

    def classify_landing(self, points: list[HeldPoint], sign: float) -> int:
        """Return LOST if a ramp from a motion's end comes to one further along than the course.

        UNDECIDED if none does, but there is one to come to; else FOLLOWS.

        Parameters
        ----------
        points : list of HeldPoint
            Of the course: the last one before the end, the first one past it, and all after it.
        sign : float
        """
        last, landed, *after = points
        if not after or not self.ends_against(last, landed, sign):
            return FOLLOWS
        before_next, beyond = largest_change([landed, *after], sign)[1:]
        for voltage in self.places_between(landed, before_next):
            for rate in self.settings.rates:
                left, beside = (self.ramp_from(point, voltage, rate) for point in (last, landed))
                if self.is_further(left, beside, sign):
                    return LOST
        back = self.climb_stairs(beyond, landed.voltage)[-1]
        is_there = back.voltage != landed.voltage or self.is_further(back, landed, sign)
        return UNDECIDED if is_there else FOLLOWS

    def places_between(self, landed: HeldPoint, last: HeldPoint) -> list[float]:
        """Return voltages at which ramps meet a motion, V, clear of its end if there is room.

        Near its end a ramp throws any motion out.
        """
        stair, room = self.settings.stair * self.volts, abs(last.voltage - landed.voltage)
        far = min(max(room - stair, 0.5 * room), self.past_volts)
        way = math.copysign(1.0, last.voltage - landed.voltage)
        return [landed.voltage + way * part for part in (far, max(far - stair, 0.5 * far)) if room]

    def ends_against(self, low: HeldPoint, high: HeldPoint, sign: float) -> bool:
        """Return whether a motion is lost in a short step for one less far along."""
        return (
            self.is_within(low, high, self.settings.width)
            and self.is_further(low, high, sign)
            and self.classify_return(low, high) == LOST
        )

    def is_further(self, point: HeldPoint, other: HeldPoint, sign: float) -> bool:
        """Return whether a point is on a motion further along than another at its voltage."""
        apart = self.settings.two_motions + speed_difference_error(point, other)
        return sign * (point.speed - other.speed) > apart

    def bracket_changes(self, points: list[HeldPoint], sign: float) -> list[Verdict]:
        """Bracket the largest speed change and all others that may be jumps.

        Others count where the speed changes from one voltage to the next by more than the voltage
        does, and by as much as tells two motions apart: a branch is steeper only beside a fold.
        """
        verdicts = [self.bracket_largest_change(points, sign)]
        places = [i for i, point in enumerate(points) if point.voltage == verdicts[0].low]
        if verdicts[0].outcome != LOST or not places:
            return verdicts
        test = self.for_further_jumps()
        for part in (points[: places[0] + 1], points[places[0] + 1 :]):
            if any(test.may_be_a_loss(low, high, sign) for low, high in pairwise(part)):
                others = test.bracket_changes(part, sign)
                verdicts += [verdict for verdict in others if verdict.outcome != FOLLOWS]
        return verdicts

    def may_be_a_loss(self, low: HeldPoint, high: HeldPoint, sign: float) -> bool:
        """Return whether the speed changes too much for one stable branch."""
        allowed = abs(high.voltage - low.voltage) / self.volts + self.smallest_change(low, high)
        return sign * (high.speed - low.speed) > allowed

    def extend_past(
        self, point: HeldPoint, voltage: float, last: int, sign: float, speed: float
    ) -> list[HeldPoint]:
        """Step the voltage further until the speed is well past a threshold."""
        end, points = self.ramp_voltage(last), [point]
        step, missing = sign * self.settings.stair * self.volts, sign * (speed - point.speed)
        left = self.settings.max_stairs + math.ceil(max(missing, 0.0) / self.settings.stair)
        while left and sign * (end - voltage) > 0.0:
            voltage = min(voltage + step, end) if sign > 0.0 else max(voltage + step, end)
            held = self.step_from(points[-1], voltage)
            points += [held] if math.isfinite(held.speed) else []
            left -= 1
            if sign * (points[-1].speed - speed) > 0.0:
                left = min(left, round(self.settings.past / self.settings.stair))
        return points[1:]

    def target_voltage(self, after: int, last: int, sign: float) -> float:
        """Return the voltage where the held steps are to end, well past the jump, V."""
        past = self.ramp_voltage(after) + sign * self.past_volts
        end = self.ramp_voltage(last)
        return min(past, end) if sign > 0.0 else max(past, end)

    def returns_same_way(self, points: list[HeldPoint]) -> bool:
        """Step the voltages back; return whether the same speeds settle again."""
        last = points[-1]
        for point in reversed(points[:-1]):
            back = self.step_from(last, point.voltage)
            if self.differ(back, point):
                return False
            last = back if math.isfinite(back.speed) else last
        return True

    def climb_stairs(
        self, low: HeldPoint, target: float, stair: float | None = None
    ) -> list[HeldPoint]:
        """Step the voltage to a target; return the points at which it settled."""
        span = abs(target - low.voltage) / self.volts
        stair = stair or self.settings.stair
        count = max(1, min(math.ceil(span / stair), self.settings.max_stairs))
        points = [low]
        for voltage in np.linspace(low.voltage, target, count + 1)[1:].tolist():
            point = self.step_from(points[-1], voltage)
            if math.isfinite(point.speed):
                points.append(point)
        return points

    def has_left_motion(self, low: HeldPoint, sign: float) -> bool:
        """Return whether the held speed left the motion that the ramp was on."""
        allowed = 2.0 * self.settings.distinct + 3.0 * low.error
        return sign * (low.speed - low.begin) < -allowed

    def came_back(self, low: HeldPoint, sign: float) -> bool:
        """Return whether the held speed came back from further along, as past a motion's end."""
        furthest = low.most if sign > 0.0 else low.least
        allowed = 2.0 * self.settings.distinct + 3.0 * low.error
        return sign * (low.speed - furthest) < -allowed and not self.is_irregular(low)

    def begin_before_end(self, low: HeldPoint, step: int, first: int, sign: float) -> HeldPoint:
        """Return where to begin if a motion ended while the first voltage was held, else that.

        The speed came back then, which it also does after a fast ramp: it is such an end if a
        course from well before falls back on its way there.

        Parameters
        ----------
        low : HeldPoint
        step, first : int
            Of the run: that of the held point, and the earliest.
        sign : float
        """
        if not self.came_back(low, sign):
            return low
        back = 1
        while step > first and abs(self.ramp_voltage(step) - low.voltage) < self.past_volts:
            step, back = max(first, step - back), 2 * back
        earlier = self.hold_step(step)
        if math.isnan(earlier.speed) or earlier.voltage == low.voltage:
            return low
        path = pairwise(self.climb_stairs(earlier, low.voltage))
        return earlier if any(self.falls_back(*pair, sign) for pair in path) else low

    @property
    def past_volts(self) -> float:
        """Return how far past the passing of the ramp the steps go, V."""
        return self.settings.past * self.volts

    def bracket_largest_change(self, points: list[HeldPoint], sign: float) -> Verdict:
        """Halve voltage steps until the largest speed change is bracketed, and judge it."""
        ended = math.nan
        for _ in range(self.settings.max_holds):
            i, low, high = largest_change(points, sign)
            if sign * (high.speed - low.speed) < self.smallest_change(low, high):
                return Verdict(FOLLOWS)
            if self.is_within(low, high, self.settings.width):
                short = high.origin in (low.voltage, high.voltage)  # a short step, or held again
                again = high if short else self.step_from(low, high.voltage)
                if self.differ(again, high):
                    points[i + 1] = again  # a longer step of the voltage had thrown it across
                    continue
                what = self.classify_return(low, high)
                if what == LOST and self.replace_if_lost(points, i):
                    ended = low.voltage if math.isnan(ended) else ended
                    if abs(low.voltage - ended) <= self.settings.by_chance * self.volts:
                        continue  # it was lost before, as close as a bracket can tell
                    what = UNDECIDED
                if what != FOLLOWS or self.is_within(low, high, self.settings.finest):
                    return Verdict(LOST if what == LOST else UNDECIDED, low.voltage, high.voltage)
            middle = self.settled_between(low, high)
            if middle is None:
                lost = self.classify_return(low, high) == LOST
                lasts = lost and not self.replace_if_lost(points, i)
                return Verdict(LOST if lasts else UNDECIDED, low.voltage, high.voltage)
            points.insert(i + 1, middle)
        return Verdict(UNDECIDED, low.voltage, high.voltage)

    def smallest_change(self, low: HeldPoint, high: HeldPoint) -> float:
        """Return the smallest speed change that may be a jump, over omega."""
        settings = self.settings
        return min(
            settings.smallest_jump + speed_difference_error(low, high), settings.largest_scatter
        )

    def settled_between(self, low: HeldPoint, high: HeldPoint) -> HeldPoint | None:
        """Hold voltages between two points until one settles, the middle first; None if none."""
        parts = (0.5, 0.25, 0.75)
        voltages = (low.voltage + part * (high.voltage - low.voltage) for part in parts)
        points = (self.step_from(low, voltage) for voltage in voltages)
        return next((point for point in points if math.isfinite(point.speed)), None)

    def classify_return(self, low: HeldPoint, high: HeldPoint) -> int:
        """Step back to the lower voltage; return LOST if its speed is another."""
        back = self.step_from(high, low.voltage)
        if abs(back.speed - low.speed) > self.settings.two_motions + speed_difference_error(
            back, low
        ):
            return LOST if self.hold_again(back) is back else UNDECIDED
        comes_back = math.isfinite(back.speed) and not self.differ(back, low)
        return FOLLOWS if comes_back else UNDECIDED

    def hold_again(self, point: HeldPoint) -> HeldPoint:
        """Hold a motion again; return its new point if the speed differs.

        An irregular motion may be lost while its voltage is still held, and one that is hardly
        unstable leaves long after its speed seemed to settle; other points are returned unchanged.
        """
        later = point
        for _ in range(self.settings.again):
            later = self.step_from(later, point.voltage)
            if self.differ(later, point):
                return later
        return point

    def replace_if_lost(self, points: list[HeldPoint], i: int) -> bool:
        """Replace a point by a slower course's; return whether it is another motion.

        The point's motion may end meanwhile, if it is irregular or hardly unstable. And an
        irregular motion before may have fallen into it by chance, where it exists in a narrow range
        of voltages: where it ends then says nothing of the motion that a ramp follows. So it is
        reached anew from there.
        """
        irregular = [j for j in range(i) if self.is_irregular(points[j])]
        first = irregular[-1] if irregular else 0
        before = points[first]
        for _ in range(self.settings.again if irregular else 0):
            before = self.step_from(before, before.voltage)
            path = [before]
            for point in points[first + 1 : i + 1]:
                path.append(self.step_from(path[-1], point.voltage))
            if self.differ(path[-1], points[i]):
                points[first + 1 : i + 1] = [
                    settled for settled in path[1:] if math.isfinite(settled.speed)
                ]
                return True
        later = self.hold_again(points[i])
        is_other, points[i] = later is not points[i], later
        return is_other

    def is_irregular(self, point: HeldPoint) -> bool:
        """Return whether the speed of a point scatters, as in chaotic motion."""
        return point.error > self.settings.tolerance

    def is_within(self, low: HeldPoint, high: HeldPoint, width: float) -> bool:
        """Return whether two points' voltages are closer than a width over K omega."""
        return abs(high.voltage - low.voltage) <= width * self.volts

    def differ(self, point: HeldPoint, other: HeldPoint) -> bool:
        """Return whether two points have settled at clearly different speeds."""
        return abs(point.speed - other.speed) > self.settings.distinct + speed_difference_error(
            point, other
        )


def speed_difference_error(point: HeldPoint, other: HeldPoint) -> float:
    """Return three standard errors of the difference between two settled speeds."""
    return 3.0 * math.hypot(point.error, other.error)


def largest_change(points: list[HeldPoint], sign: float) -> tuple[int, HeldPoint, HeldPoint]:
    """Find the neighbouring points with the largest speed change; return index and both."""
    pairs = list(pairwise(points))
    i = int(np.argmax([sign * (high.speed - low.speed) for low, high in pairs]))
    return i, *pairs[i]


def block_means(speeds: np.ndarray, settings: HoldSettings) -> np.ndarray:
    """Return the mean speeds of blocks of revolutions, without the first block."""
    count = len(speeds) // settings.block
    blocks = speeds[: count * settings.block].reshape(count, settings.block)
    return np.asarray(blocks.mean(axis=1)[1:])


def settled_speed(means: np.ndarray, settings: HoldSettings) -> tuple[float, float]:
    """Extrapolate the limit of block means (Aitken); return it with its error, or NaN.

    Means that approach a limit as an exponential say it before they are there (Aitken's process):
    three such limits in turn must agree. By a fold the approach is slower than any exponential, and
    they do not. Small changes to and fro have settled. Irregular motions have where three long
    means differ by less than their scatter.
    """
    changes = np.diff(means)
    if len(changes) < 4:
        return math.nan, 0.0
    last = changes[-4:]
    if np.abs(last).max() < 0.01 * settings.tolerance:
        return float(means[-1]), 0.0
    if not (last > 0.0).all() and not (last < 0.0).all():
        if np.ptp(means[-5:]) < 0.3 * settings.tolerance:
            return float(means[-5:].mean()), 0.0
    else:
        ratios = last[1:] / last[:-1]
        if ratios.max() < 0.95:
            limits = means[-3:] + last[1:] * ratios / (1.0 - ratios)
            if np.ptp(limits) < 0.5 * settings.tolerance:
                return float(limits[-1]), 0.0
    if len(means) < 24:
        return math.nan, 0.0
    thirds = means[-24:].reshape(3, 8).mean(axis=1)
    scatter = float(np.std(np.diff(means[-24:])))
    if np.ptp(thirds) < max(settings.tolerance, 0.7 * scatter):
        error = max(float(np.ptp(thirds)), 0.5 * float(np.std(means[-24:])))
        return float(thirds.mean()), error
    return math.nan, 0.0


def with_final_chunk(chunks: list[Chunk]) -> list[Chunk]:
    """Split the last item, the held-voltage test, into a chunk of its own."""
    last = chunks[-1]
    if last.stop - last.start == 1:
        return chunks
    steps = Chunk(last.index, last.start, last.stop - 1, last.after)
    return [*chunks[:-1], steps, Chunk(last.index + 1, last.stop - 1, last.stop, last.index)]
