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
from collections.abc import Iterator
from copy import copy
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..running.job import Chunk
from .further_jumps import LAST_STRETCH
from .jumps import Passing
from .voltage_hold import HeldPoint, VoltageHolder, speed_difference_error

NOT_ASKED, LOST, FOLLOWS, LEFT_BEFORE, UNDECIDED = range(5)
MEANINGS = {
    NOT_ASKED: "not asked",
    LOST: "lost",
    FOLLOWS: "follows",
    LEFT_BEFORE: "left before",
    UNDECIDED: "undecided",
}


class Verdict(NamedTuple):
    """Store a result of the held-voltage test: the outcome and the bracket of voltages."""

    outcome: int  # `NOT_ASKED`, `LOST`, `FOLLOWS`, `LEFT_BEFORE` or `UNDECIDED`
    # the last voltage at which the motion stays and the first at which it is lost, V; of an
    # undecided verdict the voltages between which the speed changes most, as far as known; NaN else
    low: float = math.nan
    high: float = math.nan

    def mirrored(self, sense: float) -> Verdict:
        """Return the verdict with the voltages of a motor that turns in this sense, 1 or -1."""
        return self._replace(low=sense * self.low, high=sense * self.high)


class HeldCourse(NamedTuple):
    """Store the verdicts on the largest and on all other speed changes of a held course."""

    verdict: Verdict  # on the largest change of the speed
    further: tuple[Verdict, ...] = ()  # on the others at which a motion is lost, or may be


class HeldVoltageTest(VoltageHolder):
    """Test whether a past ramp lost a motion, by restoring states and holding voltages.

    Its parameters are those of :class:`.voltage_hold.VoltageHolder`.
    """

    def for_further_jumps(self) -> HeldVoltageTest:
        """Return a copy of this test with the settings for further jumps."""
        test, settings = copy(self), self.settings
        test.settings = replace(
            settings, two_motions=settings.further_motions, smallest_jump=settings.further_jump
        )
        return test

    def for_suspected_jumps(self, end: float) -> HeldVoltageTest:
        """Return a copy with the settings for places where a record suggests a further jump."""
        test = self.for_further_jumps()
        settings = test.settings
        test.settings = replace(settings, least_told=settings.suspected_jump, told_near=end)
        return test

    def classify(
        self,
        steps: Passing,
        ends: tuple[int, int],
        threshold: float,
        up: bool,
        resonance: tuple[float, float] | None = None,
    ) -> HeldCourse:
        """Decide whether a passage of a speed threshold loses the motion, and where."""
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
        """Hold voltages to the end of a ramp and bracket the losses that it would show
        afterwards.
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

        UNDECIDED if none does, but there is one to come to, or if a ramp stays on the motion: an
        irregular one ends by chance. Else FOLLOWS.
        """
        last, landed, *after = points
        if not after or not self.ends_against(last, landed, sign):
            return FOLLOWS
        before_next, beyond = largest_change([landed, *after], sign)[1:]
        stays = False
        for voltage in self.places_between(landed, before_next):
            for left in self.ramps_further(last, landed, voltage, sign):
                if self.may_be_a_loss(last, left, sign):
                    return LOST
                stays = True
        back = self.climb_stairs(beyond, landed.voltage)[-1]
        is_there = back.voltage != landed.voltage or self.is_further(back, landed, sign)
        return UNDECIDED if stays or is_there else FOLLOWS

    def ramps_further(
        self, last: HeldPoint, landed: HeldPoint, voltage: float, sign: float
    ) -> Iterator[HeldPoint]:
        """Ramp to a voltage from both sides of an end; yield where the first comes further along.

        It may have left its motion for another one, or be on it still.
        """
        for rate in self.settings.rates:
            left, beside = (self.ramp_from(point, voltage, rate) for point in (last, landed))
            if self.is_further(left, beside, sign):
                yield left

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
                    return self.told(low, high, what == LOST)
            middle = self.settled_between(low, high)
            if middle is None:
                lost = self.classify_return(low, high) == LOST
                lasts = lost and not self.replace_if_lost(points, i)
                return self.told(low, high, lasts)
            points.insert(i + 1, middle)
        return Verdict(UNDECIDED, low.voltage, high.voltage)

    def told(self, low: HeldPoint, high: HeldPoint, is_lost: bool) -> Verdict:
        """Return the loss between two points; undecided if it is none for sure, or too small."""
        near_end = abs(self.settings.told_near - low.voltage) <= LAST_STRETCH * self.volts
        is_large = near_end or abs(high.speed - low.speed) >= self.settings.least_told
        return Verdict(LOST if is_lost and is_large else UNDECIDED, low.voltage, high.voltage)

    def smallest_change(self, low: HeldPoint, high: HeldPoint) -> float:
        """Return the smallest speed change that may be a jump, over omega."""
        settings = self.settings
        return min(
            settings.smallest_jump + speed_difference_error(low, high), settings.largest_scatter
        )

    def classify_return(self, low: HeldPoint, high: HeldPoint) -> int:
        """Step back to the lower voltage; return LOST if its speed is another."""
        back = self.step_from(high, low.voltage)
        if abs(back.speed - low.speed) > self.settings.two_motions + speed_difference_error(
            back, low
        ):
            return LOST if self.hold_again(back) is back else UNDECIDED
        comes_back = math.isfinite(back.speed) and not self.differ(back, low)
        return FOLLOWS if comes_back else UNDECIDED

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


def largest_change(points: list[HeldPoint], sign: float) -> tuple[int, HeldPoint, HeldPoint]:
    """Find the neighbouring points with the largest speed change; return index and both."""
    pairs = list(pairwise(points))
    i = int(np.argmax([sign * (high.speed - low.speed) for low, high in pairs]))
    return i, *pairs[i]


def with_final_chunk(chunks: list[Chunk]) -> list[Chunk]:
    """Split the last item, the held-voltage test, into a chunk of its own."""
    last = chunks[-1]
    if last.stop - last.start == 1:
        return chunks
    steps = Chunk(last.index, last.start, last.stop - 1, last.after)
    return [*chunks[:-1], steps, Chunk(last.index + 1, last.stop - 1, last.stop, last.index)]
