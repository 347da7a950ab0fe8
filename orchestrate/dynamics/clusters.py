"""Settled responses told apart: what they have in common at whatever phase one looks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import Instance
from ..response.multiplicity import multiplicity
from ..response.questions import Point
from ..response.respond import Response, respond

FEATURES = ("multiplicity", "impacts_per_period", "xi_rel_max", "mean", "deviation")
ABOUT = "; mean and deviation are those of the samples of the gap"
Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Telling:
    """How responses from many starts are told apart.

    Parameters
    ----------
    transient : int
        Periods dropped, at least.
    settle : float
        Periods dropped at least, times eta: a decay e^{-D tau} with D = 0.005 by a factor of ten
        thousand.
    samples : int
        Periods looked at.
    converged : float
        Relative deviation within which a repeated state decides.
    apart : float
        Over ``converged``: within so much a state nearly repeats; states differ by more after fewer
        periods than those of the response.
    longest : int
        Periods after which a response that does not repeat is irregular.
    irregular_samples : int
        Periods looked at then.
    alike, alike_irregular : float
        Features of one attractor differ by less, relatively: periodic responses, others, whose
        means are taken over few periods.
    count_weight : float
        Weight of the impacts per period: a count over the samples may be off by one.
    """

    transient: int = 400
    settle: float = 300.0
    samples: int = 48
    converged: float = 1e-6
    apart: float = 1e3
    longest: int = 20_000
    irregular_samples: int = 400
    alike: float = 0.02
    alike_irregular: float = 0.25
    count_weight: float = 0.2


def settling(transient: int, settle: float, eta: float) -> int:
    """Periods to drop from a start far from the response: more where periods are short."""
    return max(transient, round(settle * eta))


class Settled(NamedTuple):
    """A response that has been run on until it is known what it is.

    Attributes
    ----------
    response : Response
        Its multiplicity is 0 where it is irregular: a torus, or chaos.
    periods : int
        After which it was decided.
    """

    response: Response
    periods: int


def response_from(instance: Instance, point: Point, start: ArrayLike, telling: Telling) -> Settled:
    """The response from a state at phase 0, in m and m/s, run on until a repeated state decides.

    Each time it does not repeat, it is run on for as long as before. One that nearly repeats at the
    end counts as periodic if it did so before and its deviation shrinks, else it is a narrow torus.
    """
    dropped = settling(telling.transient, telling.settle, point.excitation.eta(point.structure))
    done, before = 0, (0, np.inf)
    while True:
        response = respond(instance, *point, start, dropped, telling.samples, telling.converged)
        done, start = done + dropped + telling.samples, response.end
        if response.multiplicity and decided(response, telling):
            return Settled(response, done)
        nearly = deviation(response.samples, telling.apart * telling.converged)
        if done >= telling.longest:
            break
        before, dropped = nearly, min(done, telling.longest - done)
    if nearly[0] and nearly[0] == before[0] and 2.0 * nearly[1] < before[1]:
        return Settled(replace(response, multiplicity=nearly[0]), done)
    response = respond(instance, *point, start, 0, telling.irregular_samples, telling.converged)
    return Settled(response, done + telling.irregular_samples)


def decided(response: Response, telling: Telling) -> bool:
    """Whether a state that repeats does so after no fewer periods.

    A deviation that dies while it turns round is smaller after some periods than after one.
    """
    nearly = multiplicity(response.samples, telling.apart * telling.converged)
    return nearly == response.multiplicity


def deviation(samples: Floats, tolerance: float) -> tuple[int, float]:
    """After how many periods states nearly repeat, and how nearly; 0 and infinity where never."""
    n = multiplicity(samples, tolerance)
    if not n:
        return 0, np.inf
    states = samples[len(samples) // 2 :]
    scale = np.abs(states).max(axis=0)
    away = np.abs(states[n:] - states[:-n]).max(axis=0)
    return n, float(np.divide(away, scale, out=np.zeros_like(away), where=scale > 0.0).max())


def features(response: Response, length: float) -> list[float]:
    """What tells a response apart, by ``FEATURES``: none of it depends on the phase of its samples.

    Parameters
    ----------
    response : Response
    length : float
        Unit of the gap, a eta^2 in m.
    """
    n, samples = response.multiplicity, response.samples
    gaps = (samples[:, 1] - samples[:, 0]) / length
    impacts = response.impacts_per_period
    if n:  # over whole periods of the response
        gaps, impacts = gaps[-n:], round(n * impacts) / n
    return [n, impacts, response.x_rel_max / length, float(gaps.mean()), float(gaps.std())]


def clusters(rows: ArrayLike, telling: Telling) -> NDArray[np.intp]:
    """Labels 0, 1, ... of attractors, the most frequent first.

    Parameters
    ----------
    rows : array_like, shape (n, 5)
        Features of responses. Those belong together whose multiplicity agrees and that a chain of
        responses connects, each like the next.
    telling : Telling

    Returns
    -------
    ndarray of int, shape (n,)
        Of as many as each other, that of the smaller multiplicity comes first, then the one met
        first.
    """
    table = np.asarray(rows, dtype=float)
    labels = np.zeros(len(table), dtype=np.intp)
    scale = np.maximum(np.abs(table[:, 2]), 1e-300)
    shape = np.column_stack([np.log(scale), table[:, 3] / scale, table[:, 4] / scale])
    for n in np.unique(table[:, 0]):
        which = np.flatnonzero(table[:, 0] == n)
        points = np.column_stack([shape[which], telling.count_weight * table[which, 1]])
        radius = telling.alike if n else telling.alike_irregular
        labels[which] = labels.max() + 1 + connected(points, radius)
    _, positions, sizes = np.unique(labels, return_inverse=True, return_counts=True)
    rank = np.empty(len(sizes), dtype=np.intp)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(len(sizes))
    return rank[positions]


def connected(points: Floats, radius: float) -> NDArray[np.intp]:
    """Labels 0, 1, ... of points that chains of steps no longer than ``radius`` connect.

    The clusters of single linkage at that distance, in memory that grows with the number of
    points and not with its square.

    Parameters
    ----------
    points : ndarray, shape (n, k)
    radius : float

    Returns
    -------
    ndarray of int, shape (n,)
        In the order in which the clusters are met.
    """
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


@dataclass(frozen=True)
class Attractor:
    """What many responses of one kind have in common.

    Attributes
    ----------
    share : float
        Of the responses.
    about : ndarray, shape (3,)
        Medians of the first three of ``FEATURES``.
    state : ndarray, shape (4,)
        A state on it at phase 0: x1, x2 in m, v1, v2 in m/s.
    """

    share: float
    about: Floats
    state: Floats


def attractors_of(labels: NDArray[np.intp], rows: Floats, ends: Floats) -> Sequence[Attractor]:
    """The attractors of labelled responses.

    Parameters
    ----------
    labels : ndarray of int, shape (n,)
    rows : ndarray, shape (n, 5)
    ends : ndarray, shape (n, 4)
        States at the ends of the responses; that of the first one of each kind is taken.
    """
    return [
        Attractor(
            share=float(np.mean(labels == label)),
            about=np.median(rows[labels == label][:, :3], axis=0),
            state=ends[(labels == label).argmax()],
        )
        for label in range(labels.max() + 1)
    ]
