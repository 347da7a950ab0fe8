"""Simulate the steady-state response at one operating point: samples, impacts, largest gap."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import STATE, Instance, begin, gap_between, last_samples, samples_per_step
from ..structures import Excitation, Structure
from .multiplicity import (
    REPEATED,
    UNDECIDED,
    Decision,
    Repetition,
    decide_multiplicity,
    find_repetition,
    scale_states,
)
from .questions import Point
from .threshold import exceeds_threshold


@dataclass(frozen=True)
class Response:
    """Steady-state response at one operating point: stroboscopic samples, impacts, largest gap."""

    samples: NDArray[np.float64]  # x1, x2, v1, v2 at the excitation's phase 0 of successive periods
    x_rel_max: float  # largest gap in them, exact between the samples too
    impacts_per_period: float  # mean over the samples' periods
    impact_count: int  # impacts from the beginning of the transient to the last sample
    permanent_contact: bool  # whether any occurred in them
    frequency: float  # of the excitation, rad/s
    tolerance: float  # within which a state repeats, over the motion's size: see multiplicity
    gap_offset: float = 0.0  # the gap between unloaded springs, m
    # whether no response without impacts exists: the linear one would open or touch
    has_to_impact: bool = False

    @cached_property
    def states(self) -> NDArray[np.float64]:
        """Return the samples over the motion's size, see :func:`.multiplicity.scale_states`."""
        return scale_states(self.samples, self.frequency, self.x_rel_max)

    @cached_property
    def multiplicity(self) -> int:
        """Return the least number of periods after which states repeat, 0 if they do not.

        Within the tolerance; :meth:`decision` says how reliable it is.
        """
        return self.repetition(self.tolerance).multiplicity

    def repetition(self, tolerance: float) -> Repetition:
        """Return the multiplicity within a tolerance, and the largest deviation from it."""
        return find_repetition(self.states, tolerance)

    def decision(self, tolerance: float) -> Decision:
        """Return the multiplicity as decided by how deviations decay, and how it was decided."""
        n, decided = decide_multiplicity(self.states, tolerance)
        is_late = decided == REPEATED and self.lacks_impacts(self.impacts_per_period, n)
        return Decision(n, UNDECIDED if is_late else decided)

    def confirm(self, decision: Decision, impacts: int) -> int:
        """Return how the multiplicity was decided, undecided if impacts speak against it.

        A response that still converges, by less than the tolerance, may yet gain or lose some.
        """
        n, decided = decision
        if decided == REPEATED and (self.lacks_impacts(impacts, n) or not self.repeats(impacts, n)):
            return UNDECIDED
        return decided

    def repeats(self, impacts: int, n: int) -> bool:
        """Return whether the samples have the impacts of a motion with so many in n periods.

        One at phase 0 may be counted on either side of it.
        """
        count = len(self.samples)
        whole, rest = divmod(count, n)
        found = round(self.impacts_per_period * count)
        return whole * impacts - 1 <= found <= (whole + (rest > 0)) * impacts + 1

    def lacks_impacts(self, impacts: float, n: int) -> bool:
        """Return whether so many impacts, namely none, are too few for n periods to last.

        Between impacts the system is linear: what repeats after several periods is a transient.
        """
        return not impacts and (self.has_to_impact or n > 1)

    @property
    def gap(self) -> NDArray[np.float64]:
        """Return the gap at the samples, m."""
        return gap_between(self.samples, self.gap_offset)

    @cached_property
    def end(self) -> tuple[float, ...]:
        """Return the rounded state at the last sample, from which the next response starts."""
        return round_state(self.samples[-1], self.gap_offset)


def round_state(
    state: NDArray[np.float64], gap_offset: float = 0.0, bits: int = 44
) -> tuple[float, ...]:
    """Round a state to 44 bits (13 digits), so that it hardly depends on its history.

    Rounding never settles: what has converged to one response from two sides goes on to differ in
    its last digits for good. Without them it is the same to the last bit, and parts of a sweep that
    are begun elsewhere join it.

    Examples
    --------
    >>> round_state(np.array([0.25, 0.3, 1.0, -1.0]))
    (0.25, 0.30000000000001137, 1.0, -1.0)
    """
    x1, x2, v1, v2 = state.tolist()
    velocities = round_to_bits(v1, v2, bits)
    if gap_offset == 0.0:
        return (*round_to_bits(x1, x2, bits), *velocities)
    face_1, face_2 = round_to_bits(x1, x1 + float(gap_between(state, gap_offset)), bits)
    return (face_1, face_2 - gap_offset, *velocities)


def round_to_bits(first: float, second: float, bits: int) -> tuple[float, float]:
    """Round two numbers to a number of binary digits of the larger one."""
    digit = math.ldexp(1.0, math.frexp(max(abs(first), abs(second)))[1] - bits)
    if digit == 0.0:  # of the smallest numbers there are
        return first, second
    return (
        math.copysign(round(first / digit) * digit, first),
        math.copysign(round(second / digit) * digit, second),
    )


def respond(
    instance: Instance,
    structure: Structure,
    excitation: Excitation,
    start: ArrayLike,
    transient: int,
    samples: int,
    tolerance: float,
) -> Response:
    """Simulate a transient and samples from a state at phase 0; return the response."""
    period = excitation.period
    begin(instance, structure, excitation, start)
    if transient:
        instance.step(0.0, transient * period)
    impacts, contacts, touching = instance.get("impact_count", "contact_count", "in_contact")
    states, peak = stroboscopic_samples(instance, period, transient, samples)
    impacts_after, contacts_after = instance.get("impact_count", "contact_count")
    return Response(
        samples=states,
        x_rel_max=peak,
        impacts_per_period=(impacts_after - impacts) / samples,
        impact_count=impacts_after,
        permanent_contact=bool(touching) or contacts_after > contacts,
        frequency=excitation.frequency,
        tolerance=tolerance,
        gap_offset=structure.gap_offset,
        has_to_impact=exceeds_threshold(structure, excitation),
    )


def stroboscopic_samples(
    instance: Instance, period: float, transient: int, samples: int
) -> tuple[NDArray[np.float64], float]:
    """Run the FMU over some periods; return states at phase 0, and the largest gap."""
    room = samples_per_step(instance)
    states, peak = np.empty((len(STATE), samples)).T, 0.0
    for done in range(0, samples, room):
        count = min(room, samples - done)
        first = transient + done
        instance.set(x_rel_max_on=True, sample_count=count)
        instance.step(first * period, (first + count) * period)
        states[done : done + count] = last_samples(instance, count)
        peak = max(peak, *instance.get("x_rel_max"))
    return states, peak


def count_impacts_until(instance: Instance, before: int, time: float, target: float) -> int:
    """Run the FMU on to a time; return the impacts since an earlier count."""
    if target > time:
        instance.step(time, target)
    count: int = instance.get("impact_count")[0]
    return count - before


def count_impacts(instance: Instance, point: Point, start: ArrayLike, periods: int) -> int:
    """Run the FMU some periods from a state at phase 0; return the number of impacts."""
    begin(instance, *point, start)
    (before,) = instance.get("impact_count")
    return count_impacts_until(instance, before, 0.0, periods * point.excitation.period)


def follow_responses(
    instance: Instance,
    points: Iterable[Point],
    start: ArrayLike,
    transient: int,
    samples: int,
    tolerance: float,
    gap_offset: float | None = None,
) -> Iterator[Response]:
    """Yield the response at each point, started from the end state of the one before."""
    for structure, excitation in points:
        if gap_offset is not None and gap_offset != structure.gap_offset and np.any(start):
            start = np.add(start, (0.0, gap_offset - structure.gap_offset, 0.0, 0.0))
        response = respond(instance, structure, excitation, start, transient, samples, tolerance)
        yield response
        start, gap_offset = response.end, response.gap_offset
