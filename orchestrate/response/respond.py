"""Simulate the steady-state response at one operating point: samples, impacts, largest gap."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import Instance, checked_four_numbers
from ..model import Excitation, Structure
from .multiplicity import Decision, Repetition, find_repetition, lacks_impacts
from .questions import Point
from .response_loop import LoopSettings, Responses, response_loop


@dataclass(frozen=True)
class Response:
    """Steady-state response at one operating point: stroboscopic samples, impacts, largest gap."""

    samples: NDArray[np.float64]  # x1, x2, v1, v2 at the excitation's phase 0 of successive periods
    end: tuple[float, ...]  # the last one, rounded, from which the next response starts
    x_rel_max: float  # largest gap in them, exact between the samples too
    impacts_per_period: float  # mean over the samples' periods
    permanent_contact: bool  # whether any occurred in them
    frequency: float  # of the excitation, rad/s
    tolerance: float  # within which a state repeats, over the motion's size: see multiplicity
    # whether no response without impacts exists: the linear one would open or touch
    has_to_impact: bool = False
    known_multiplicity: int | None = None  # within the tolerance, where it is known already

    @cached_property
    def multiplicity(self) -> int:
        """Return the least number of periods after which states repeat, 0 if they do not."""
        if self.known_multiplicity is not None:
            return self.known_multiplicity
        return self.find_repetition(self.tolerance).multiplicity

    def find_repetition(self, tolerance: float) -> Repetition:
        return find_repetition(self.samples, self.frequency, self.x_rel_max, tolerance)

    def lacks_impacts(self, impacts: float, n: int) -> bool:
        """Return whether no impacts are too few for n periods to last."""
        return bool(lacks_impacts(impacts, n, self.has_to_impact))


def simulate_response(
    instance: Instance,
    structure: Structure,
    excitation: Excitation,
    start: ArrayLike,
    transient: int,
    samples: int,
    tolerance: float,
) -> Response:
    """Run one response from a start at phase 0; transient and samples are in periods."""
    points = [Point(structure, excitation)]
    settings = LoopSettings(transient=transient, samples=samples)
    results = response_loop(instance).simulate(points, [checked_four_numbers(start)], settings)
    return next(responses_from(results, points, tolerance))


def responses_from(
    results: Responses,
    points: Sequence[Point],
    tolerance: float,
    multiplicity: Sequence[int] | None = None,
) -> Iterator[Response]:
    """Yield the loop's results as responses; their multiplicity is found when it is read."""
    impacts = results.counts["impacts_after"] - results.counts["impacts_before"]
    contact = results.permanent_contact
    for i, point in enumerate(points):
        yield Response(
            samples=results.states[i],
            end=tuple(results.ends[i].tolist()),
            x_rel_max=float(results.x_rel_max[i]),
            impacts_per_period=int(impacts[i]) / results.states.shape[1],
            permanent_contact=bool(contact[i]),
            frequency=point.excitation.frequency,
            tolerance=tolerance,
            has_to_impact=bool(results.must_impact[i]),
            known_multiplicity=None if multiplicity is None else multiplicity[i],
        )


class DecidedResponse(NamedTuple):
    """A response, how its multiplicity was decided, and its impacts per period."""

    response: Response
    decision: Decision
    impacts_per_period: float


def decisions_from(results: Responses, responses: Iterable[Response]) -> Iterator[DecidedResponse]:
    decisions = (results.counts[name].tolist() for name in ("multiplicity", "decided"))
    columns = *decisions, results.impacts.tolist()
    for response, n, decided, impacts in zip(responses, *columns, strict=True):
        yield DecidedResponse(response, Decision(n, decided), impacts)
