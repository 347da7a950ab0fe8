"""Run responses until they settle; thresholds of what they settle to.

What a response has settled to is decided afterwards, see :mod:`.decision`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..fmu import Instance
from ..model.arguments import MAX_COUNT, checked_integer, checked_positive
from ..response.questions import Point
from ..response.respond import Response, responses_from
from ..response.response_loop import LoopSettings, Responses, response_loop
from .settled_motion import Floats, SettledMotion


@dataclass(frozen=True, kw_only=True)
class AttractorSettings:
    """Thresholds of what responses from many starts settle to, see :mod:`.decision`."""

    converged: float = 1e-6  # relative deviation within which a repeated state decides
    # periods up to which a response is run on that does not repeat, or that Newton's method does
    # not confirm; beyond it is irregular, or undecided: more where transients are long, near
    # bifurcations
    longest: int = 20_000
    # distance over the motion's size within which responses that repeat are one attractor if
    # Newton's method finds no stable orbit
    alike: float = 0.02
    # relative difference within which irregular responses belong to one attractor
    alike_irregular: float = 0.25
    # over `converged`: within so much a state nearly repeats; states differ by more after fewer
    # periods than those of the response
    apart: float = 1e3
    irregular_samples: int = 400  # periods kept of an irregular response
    # weight of the impacts per period of irregular responses, a mean over the samples
    count_weight: float = 0.2
    residual: float = 1e-9  # of an orbit's equations in units of a eta^2, at most
    max_nodes: int = 400  # of an orbit that Newton's method is tried on
    # distances over the motion's size: where the FMU is again after the periods of an orbit; from
    # which a response may be coming to an orbit, and lies on it
    returns: float = 1e-6
    near: float = 0.1
    same: float = 1e-5
    # beyond which attractors of neighbouring values may be different ones, other things equal
    neighbour: float = 0.2

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(each.default, int):
                checked_integer(each.name, value, 0)
            else:
                checked_positive(each.name, value)


@dataclass(frozen=True, kw_only=True)
class SettlingSettings(AttractorSettings):
    """Thresholds, and how long responses are run before they are looked at."""

    transient: int  # periods dropped at least
    settle: float  # the same over eta: a slow decay takes time, not periods
    samples: int  # periods kept

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_integer("samples", self.samples, 4)

    @classmethod
    def from_settings(cls, settings: AttractorSettings | None, **lengths: Any) -> SettlingSettings:
        own = AttractorSettings() if settings is None else settings
        if not isinstance(own, AttractorSettings):
            raise InputError(f"settings = {own!r}: expected AttractorSettings(longest=..., ...)")
        thresholds = {each.name: getattr(own, each.name) for each in fields(AttractorSettings)}
        return cls(**thresholds, **lengths)


RUN_LENGTHS = ("transient", "settle", "samples")


def transient_periods(transient: int, settle: float, eta: float) -> int:
    """Return the periods to drop: ``transient``, or ``settle * eta`` where that is more."""
    if settle * eta > MAX_COUNT:
        raise InputError(f"settle = {settle:g}: expected at most {MAX_COUNT / eta:g}")
    return max(transient, round(settle * eta))


class SettledResponse(NamedTuple):
    """A response run until it repeats or the limit is reached, and the periods that took."""

    response: Response  # its multiplicity is 0 where it is irregular: a torus, or chaos
    periods: int  # after which it was decided


class ReachedMotion(NamedTuple):
    """A motion that a response has come to, a state on it, and the periods that it was run."""

    motion: SettledMotion
    state: Floats  # at phase 0, on it
    periods: int


def run_until_settled(
    instance: Instance,
    point: Point,
    starts: ArrayLike,
    settings: SettlingSettings,
    known: Sequence[SettledMotion] = (),
) -> list[SettledResponse | ReachedMotion]:
    """Run starts at phase 0 until they repeat, or come to one of the known motions."""
    ends, converged = np.reshape(np.asarray(starts, dtype=float), (-1, 4)), settings.converged
    loop, loose = response_loop(instance), settings.apart * converged
    dropped = transient_periods(
        settings.transient, settings.settle, point.excitation.eta(point.structure)
    )
    rule = partial(LoopSettings, samples=settings.samples, known=known, same=loose)
    settled: dict[int, SettledResponse | ReachedMotion] = {}
    known_states = [(motion, state) for motion in known for state in motion.states]

    def record_responses(
        indices: NDArray[np.intp], results: Responses, tolerance: float, n: list[int] | None = None
    ) -> None:
        responses = responses_from(results, [point] * len(indices), tolerance, n)
        for index, response in zip(indices.tolist(), responses, strict=True):
            settled[index] = SettledResponse(response, done)

    done, left = 0, np.arange(len(ends))
    before, deviation = np.zeros(len(ends), dtype=int), np.full(len(ends), np.inf)
    while len(left):
        own = rule(transient=dropped, tolerance=converged, loose=loose)
        results = loop.simulate([point] * len(left), ends, own)
        done += dropped + settings.samples
        counts = results.counts
        n, nearly, reached = counts["multiplicity"], counts["nearly"], counts["reached"]
        for row in np.flatnonzero(reached).tolist():
            motion, state = known_states[reached[row] - 1]
            settled[int(left[row])] = ReachedMotion(motion, state, done)
        # a deviation that dies while it turns round is smaller after some periods than after one
        repeats = (n > 0) & (nearly == n)
        dying = (nearly > 0) & (nearly == before) & (2.0 * results.deviations < deviation)
        dying &= done >= settings.longest
        for chosen, tolerance in ((repeats, converged), (dying & ~repeats, loose)):
            rows = np.flatnonzero(chosen)
            record_responses(left[rows], results.select(rows), tolerance, nearly[rows].tolist())
        rest = np.flatnonzero(~(repeats | dying) & (reached == 0))
        left, ends = left[rest], results.ends[rest]
        before, deviation = nearly[rest], results.deviations[rest]
        if done >= settings.longest:
            break
        dropped = min(done, settings.longest - done)
    if len(left):
        done += settings.irregular_samples
        own = LoopSettings(transient=0, samples=settings.irregular_samples)
        record_responses(left, loop.simulate([point] * len(left), ends, own), converged)
    return [settled[i] for i in range(len(settled))]
