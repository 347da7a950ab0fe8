"""Run responses until they settle, and cluster irregular ones by single linkage.

What a periodic response settles to is decided by its orbit: see :mod:`.decision`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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
from ..response.response_loop import LoopSettings, response_loop
from .settled_motion import SettledMotion

FEATURES = ("multiplicity", "impacts_per_period", "xi_rel_max", "mean", "deviation")
ABOUT = "; mean and deviation are those of the samples of the gap"
Floats = NDArray[np.float64]


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
class SettlingRun(AttractorSettings):
    """Thresholds, and how long responses are run before they are looked at."""

    transient: int  # periods dropped at least
    settle: float  # the same over eta: a slow decay takes time, not periods
    samples: int  # periods kept

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_integer("samples", self.samples, 4)

    @classmethod
    def from_settings(cls, settings: AttractorSettings | None, **lengths: Any) -> SettlingRun:
        given = AttractorSettings() if settings is None else settings
        if not isinstance(given, AttractorSettings):
            raise InputError(f"settings = {given!r}: expected AttractorSettings(longest=..., ...)")
        thresholds = {each.name: getattr(given, each.name) for each in fields(AttractorSettings)}
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
    """A known motion that a response has come to, where, and the periods that took at most."""

    motion: SettledMotion
    state: Floats  # at phase 0, on it
    periods: int


def run_until_settled(
    instance: Instance,
    point: Point,
    starts: ArrayLike,
    settings: SettlingRun,
    known: Sequence[SettledMotion] = (),
) -> list[SettledResponse | ReachedMotion]:
    """Run starts at phase 0 until they repeat or come to a known motion by :mod:`.decision`."""
    ends, converged = np.reshape(np.asarray(starts, dtype=float), (-1, 4)), settings.converged
    loop, loose = response_loop(instance), settings.apart * converged
    dropped = transient_periods(
        settings.transient, settings.settle, point.excitation.eta(point.structure)
    )
    rule = partial(LoopSettings, samples=settings.samples, known=known, same=loose)
    settled: dict[int, SettledResponse | ReachedMotion] = {}
    places = [(motion, state) for motion in known for state in motion.states]
    done, left = 0, np.arange(len(ends))
    before, deviation = np.zeros(len(ends), dtype=int), np.full(len(ends), np.inf)
    while len(left):
        asked = rule(transient=dropped, tolerance=converged, loose=loose)
        results = loop.respond([point] * len(left), ends, asked)
        done += dropped + settings.samples
        counts = results.counts
        n, nearly, reached = counts["multiplicity"], counts["nearly"], counts["reached"]
        for row in np.flatnonzero(reached).tolist():
            motion, state = places[reached[row] - 1]
            settled[int(left[row])] = ReachedMotion(motion, state, done)
        # a deviation that dies while it turns round is smaller after some periods than after one
        repeats = (n > 0) & (nearly == n)
        dying = (nearly > 0) & (nearly == before) & (2.0 * results.deviations < deviation)
        dying &= done >= settings.longest
        for chosen, tolerance in ((repeats, converged), (dying & ~repeats, loose)):
            rows = np.flatnonzero(chosen)
            points = [point] * len(rows)
            found = responses_from(results.rows(rows), points, tolerance, nearly[rows].tolist())
            settled |= settled_by_number(left[rows], found, done)
        rest = np.flatnonzero(~(repeats | dying) & (reached == 0))
        left, ends = left[rest], results.ends[rest]
        before, deviation = nearly[rest], results.deviations[rest]
        if done >= settings.longest:
            break
        dropped = min(done, settings.longest - done)
    if len(left):
        points, done = [point] * len(left), done + settings.irregular_samples
        asked = LoopSettings(transient=0, samples=settings.irregular_samples)
        irregular = responses_from(loop.respond(points, ends, asked), points, converged)
        settled |= settled_by_number(left, irregular, done)
    return [settled[i] for i in range(len(settled))]


def settled_by_number(
    numbers: NDArray[np.intp], responses: Iterable[Response], periods: int
) -> dict[int, SettledResponse]:
    pairs = zip(numbers.tolist(), responses, strict=True)
    return {number: SettledResponse(response, periods) for number, response in pairs}


def irregular_clusters(rows: ArrayLike, settings: AttractorSettings) -> NDArray[np.intp]:
    """Cluster irregular responses' feature rows by single linkage; return a label per row.

    The distance is Euclidean: of the logarithm of the largest gap, of mean and deviation over it,
    and of the impacts a period times `count_weight`.
    """
    table = np.asarray(rows, dtype=float).reshape(-1, len(FEATURES))
    scale = np.maximum(np.abs(table[:, 2]), 1e-300)
    counts = settings.count_weight * table[:, 1]
    points = np.column_stack([np.log(scale), table[:, 3] / scale, table[:, 4] / scale, counts])
    return single_linkage(points, settings.alike_irregular)


def single_linkage(points: Floats, radius: float) -> NDArray[np.intp]:
    """Cluster points (n, d) by single linkage with a radius; return a label per point."""
    # memory grows with the number of points, not its square as in scipy.cluster.hierarchy.linkage
    labels = np.zeros(len(points), dtype=np.intp)
    left = np.arange(len(points))
    count = 0
    while len(left):
        waiting, left = [left[0]], left[1:]
        labels[waiting[0]] = count
        while waiting and len(left):
            near = np.linalg.norm(points[left] - points[waiting.pop()], axis=1) <= radius
            labels[left[near]] = count
            waiting.extend(left[near])
            left = left[~near]
        count += 1
    return labels
