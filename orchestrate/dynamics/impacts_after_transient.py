"""Base of questions that drop a transient and evaluate the impacts of the periods after it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..fmu import OSCILLATOR, STATE, EventInstance, Impacts, Instance, start_motion
from ..response.questions import Point, StartedSeriesQuestion, State
from ..running.job import FAMILY, Fmus, Table
from .variational import nondimensional_impacts


class FollowedResponse(NamedTuple):
    """A response to follow: structure, excitation, and its state at phase 0 (m, m/s)."""

    point: Point
    start: State  # zeros mean rest, with a preload too, until the FMU has begun there
    touching: tuple[bool, bool] = (False, False)  # at begin and end of the periods followed


class ImpactsQuestion(StartedSeriesQuestion, ABC):
    """Base of questions along a parameter about the impacts of responses after a transient."""

    family: ClassVar[tuple[str, ...]] = FAMILY

    def items(self) -> Sequence[FollowedResponse]:
        points = self.series.points
        starts = np.broadcast_to(np.reshape(self.start, (-1, 4)), (len(points), 4)).tolist()
        return list(map(FollowedResponse, points, map(tuple, starts)))

    def work(self, fmus: Fmus, items: Sequence[FollowedResponse], previous: Table | None) -> Table:
        rows = []
        with Instance(fmus[OSCILLATOR]) as plain, EventInstance(fmus[OSCILLATOR]) as eventful:
            for item in items:
                start = state_after_transient(plain, *item[:2], self.transient)
                start_motion(eventful, *item.point, start)
                (first,), state = eventful.get("in_contact"), tuple(eventful.get(*STATE))
                impacts = simulate_nondimensional_impacts(eventful, item.point, start, self.periods)
                (last,) = eventful.get("in_contact")
                rows.append(self.row(impacts, FollowedResponse(item.point, state, (first, last))))
        return {"rows": np.array(rows, dtype=float)}

    @abstractmethod
    def row(self, impacts: Impacts, item: FollowedResponse) -> Sequence[float]:
        """Return the numbers that one response's impacts give; subclasses choose them."""


def state_after_transient(instance: Instance, point: Point, start: State, transient: int) -> State:
    """Run a response from its start for some periods; return its state at phase 0."""
    if not transient:
        return start
    start_motion(instance, *point, start)
    instance.step(0.0, transient * point.excitation.period)
    return tuple(instance.get(*STATE))


def simulate_nondimensional_impacts(
    instance: EventInstance, point: Point, start: ArrayLike, periods: int
) -> Impacts:
    """Run from a state at phase 0 for some periods; return the impacts in the paper's units."""
    start_motion(instance, *point, start)
    impacts = instance.record_impacts(0.0, periods * point.excitation.period)
    return nondimensional_impacts(impacts, point)
