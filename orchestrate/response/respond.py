"""Simulate the steady-state response at one operating point: samples, impacts, largest gap."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import Instance, four_numbers, gap_between
from ..model import Excitation, Structure
from ..model.outcomes import IRREGULAR, REPEATED, UNDECIDED
from .multiplicity import Decision, Repetition, decide_multiplicity, find_repetition
from .questions import Point
from .response_loop import COUNTS, LoopSettings, Responses, response_loop, round_state
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
    known_multiplicity: int | None = None  # within the tolerance, where it has been found

    @cached_property
    def multiplicity(self) -> int:
        """Return the least number of periods after which states repeat, 0 if they do not."""
        if self.known_multiplicity is not None:
            return self.known_multiplicity
        return self.repetition(self.tolerance).multiplicity

    def repetition(self, tolerance: float) -> Repetition:
        """Return the multiplicity within a tolerance, and the largest deviation from it."""
        return find_repetition(self.samples, self.frequency, self.x_rel_max, tolerance)

    def decision(self, tolerance: float) -> Decision:
        """Return the multiplicity as decided by how deviations decay, and how it was decided."""
        return decide_multiplicity(self.samples, self.frequency, self.x_rel_max, tolerance)

    def conclude(self, decision: Decision, impacts: int) -> tuple[Decision, float]:
        """Return a decision, undecided where impacts contradict it, and impacts per period.

        A repeated response is undecided if the samples do not have the ``impacts`` of its next n
        periods, up to one at either end, or if there are none though n > 1 or no motion without
        impacts exists. An irregular one is undecided if it has no impacts: then it is linear, and
        converges. Impacts per period are exact where it repeats, else the samples' mean.
        """
        (n, decided), mean = decision, self.impacts_per_period
        if decided == IRREGULAR and not mean:
            return Decision(1, UNDECIDED), mean
        if decided != REPEATED:
            return decision, mean
        if self.lacks_impacts(impacts, n) or not self.repeats(impacts, n):
            decided = UNDECIDED
        return Decision(n, decided), impacts / n

    def repeats(self, impacts: int, n: int) -> bool:
        """Return whether the samples have the impacts of a motion with so many in n periods."""
        count = len(self.samples)
        whole, rest = divmod(count, n)
        found = round(self.impacts_per_period * count)
        return whole * impacts - 1 <= found <= (whole + (rest > 0)) * impacts + 1

    def lacks_impacts(self, impacts: float, n: int) -> bool:
        """Return whether so many impacts, namely none, are too few for n periods to last."""
        return not impacts and (self.has_to_impact or n > 1)

    @property
    def gap(self) -> NDArray[np.float64]:
        """Return the gap at the samples, m."""
        return gap_between(self.samples, self.gap_offset)

    @cached_property
    def end(self) -> tuple[float, ...]:
        """Return the rounded state at the last sample, from which the next response starts."""
        return round_state(self.samples[-1], self.gap_offset)


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
    points = [Point(structure, excitation)]
    settings = LoopSettings(transient=transient, samples=samples)
    results = response_loop(instance).respond(points, [four_numbers(start)], settings)
    return next(responses_from(results, points, tolerance))


def responses_from(
    results: Responses,
    points: Sequence[Point],
    tolerance: float,
    multiplicity: Sequence[int] | None = None,
) -> Iterator[Response]:
    """Yield the responses of a loop's rows, with their multiplicity where it has been found."""
    count = results.states.shape[1]
    columns = zip(*(results.counts[name].tolist() for name in COUNTS), strict=True)
    exceeding: dict[int, bool] = {}  # by point: a basin's responses have one in common
    for i, (point, numbers) in enumerate(zip(points, columns, strict=True)):
        before, contacts_before, touching, after, contacts_after, *_ = numbers
        if id(point) not in exceeding:
            exceeding[id(point)] = exceeds_threshold(*point)
        yield Response(
            samples=results.states[i],
            x_rel_max=float(results.x_rel_max[i]),
            impacts_per_period=(after - before) / count,
            impact_count=after,
            permanent_contact=bool(touching) or contacts_after > contacts_before,
            frequency=point.excitation.frequency,
            tolerance=tolerance,
            gap_offset=point.structure.gap_offset,
            has_to_impact=exceeding[id(point)],
            known_multiplicity=None if multiplicity is None else multiplicity[i],
        )


class DecidedResponse(NamedTuple):
    """A response, how its multiplicity was decided, and its impacts per period."""

    response: Response
    decision: Decision
    impacts_per_period: float


def decisions_from(results: Responses, responses: Iterable[Response]) -> Iterator[DecidedResponse]:
    """Yield the responses of a loop that decides, with their decisions as impacts leave them."""
    columns = (
        results.counts[name].tolist() for name in ("multiplicity", "decided", "later_impacts")
    )
    for response, n, decided, later in zip(responses, *columns, strict=True):
        decision = Decision(n, decided)
        yield DecidedResponse(response, *response.conclude(decision, later - response.impact_count))
