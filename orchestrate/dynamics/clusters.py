"""Run responses until they settle, and cluster irregular ones by single linkage.

What a periodic response settles to is decided by its orbit: see :mod:`.decision`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import Instance
from ..response.multiplicity import Repetition
from ..response.questions import Point
from ..response.respond import Response, respond

FEATURES = ("multiplicity", "impacts_per_period", "xi_rel_max", "mean", "deviation")
ABOUT = "; mean and deviation are those of the samples of the gap"
Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class AttractorSettings:
    """Settings for settling and clustering responses from many starts."""

    # as in orchestrate.attractors
    transient: int = 400
    settle: float = 300.0
    samples: int = 48
    converged: float = 1e-6
    longest: int = 20_000
    alike: float = 0.02
    alike_irregular: float = 0.25
    # over `converged`: within so much a state nearly repeats; states differ by more after fewer
    # periods than those of the response
    apart: float = 1e3
    irregular_samples: int = 400  # periods kept of an irregular response
    # weight of the impacts per period of irregular responses, a mean over the samples
    count_weight: float = 0.2
    residual: float = 1e-9  # of an orbit's equations in units of a eta^2, at most
    max_nodes: int = 400  # of an orbit that Newton's method is tried on
    margin: float = 1e-9  # by which the multipliers of a stable orbit are smaller than 1 at least
    # distances over the motion's size: where the FMU is again after the periods of an orbit; from
    # which a response may be coming to an orbit, and lies on it
    returns: float = 1e-6
    near: float = 0.1
    same: float = 1e-5
    # beyond which attractors of neighbouring values may be different ones, other things equal
    neighbour: float = 0.2


def transient_periods(transient: int, settle: float, eta: float) -> int:
    """Return the periods to drop: ``transient``, or ``settle * eta`` where that is more."""
    return max(transient, round(settle * eta))


class SettledResponse(NamedTuple):
    """A response run until it repeats or the limit is reached, and the periods that took."""

    response: Response  # its multiplicity is 0 where it is irregular: a torus, or chaos
    periods: int  # after which it was decided


def run_until_settled(
    instance: Instance, point: Point, start: ArrayLike, settings: AttractorSettings
) -> SettledResponse:
    """Simulate from a state at phase 0 until samples repeat or the limit; return the response."""
    dropped = transient_periods(
        settings.transient, settings.settle, point.excitation.eta(point.structure)
    )
    done, before = 0, Repetition(0, np.inf)
    while True:
        response = respond(instance, *point, start, dropped, settings.samples, settings.converged)
        done, start = done + dropped + settings.samples, response.end
        nearly = response.repetition(settings.apart * settings.converged)
        # a deviation that dies while it turns round is smaller after some periods than after one
        if response.multiplicity and nearly.multiplicity == response.multiplicity:
            return SettledResponse(response, done)
        if done >= settings.longest:
            break
        before, dropped = nearly, min(done, settings.longest - done)
    same = nearly.multiplicity == before.multiplicity
    if nearly.multiplicity and same and 2.0 * nearly.deviation < before.deviation:
        return SettledResponse(
            replace(response, tolerance=settings.apart * settings.converged), done
        )
    response = respond(instance, *point, start, 0, settings.irregular_samples, settings.converged)
    return SettledResponse(response, done + settings.irregular_samples)


def irregular_clusters(rows: ArrayLike, settings: AttractorSettings) -> NDArray[np.intp]:
    """Cluster irregular responses' feature rows by single linkage; return a label per row."""
    table = np.asarray(rows, dtype=float).reshape(-1, len(FEATURES))
    scale = np.maximum(np.abs(table[:, 2]), 1e-300)
    points = np.column_stack(
        [
            np.log(scale),
            table[:, 3] / scale,
            table[:, 4] / scale,
            settings.count_weight * table[:, 1],
        ]
    )
    return single_linkage(points, settings.alike_irregular)


def single_linkage(points: Floats, radius: float) -> NDArray[np.intp]:
    """Cluster points (n, d) by single linkage with a radius; return a label per point."""
    # memory grows with the number of points, not its square as in scipy.cluster.hierarchy.linkage
    labels = np.full(len(points), -1, dtype=np.intp)
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
