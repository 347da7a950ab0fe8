"""Lyapunov exponents of long runs, judged steady or not by comparing successive parts (F test).

The standard error of one run knows how much the exponent scatters within the run. It knows nothing
of a transient that ends later: chaos that dies out has an exponent of its own while it lasts. So a
long run is cut into parts, and their exponents must agree within what the batches of each part say.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import STATE, EventInstance, gap_between
from ..response.questions import Point
from .following import State, follow_impacts
from .lyapunov import WANDER, Exponent, largest_exponent
from .variational import period_in_tau

NOT_RUN, STEADY, ENDED, UNDECIDED = -1, 0, 1, 2
WORDS = {
    NOT_RUN: "not run",
    STEADY: "steady",
    ENDED: "steady after a transient",
    UNDECIDED: "undecided",
}
BLOCKS, BATCHES = 400, 40  # of each part: its error must be known well enough to judge by it
FALSE_ALARM_CHANCE = 1e-3  # chance at which parts of a steady response are taken for unsteady ones


class LongRun(NamedTuple):
    """Result of a long run: its Lyapunov exponent, whether it was steady, and its periods."""

    # of the last parts, per unit of tau: of all parts where the response was steady from the
    # beginning, of those after the transient where one ended
    exponent: Exponent
    outcome: int  # of `WORDS`
    periods: int  # excitation periods followed in all


def parts_agree(values: ArrayLike, errors: ArrayLike, floor: float, batches: int = BATCHES) -> bool:
    """Return whether exponents of successive parts scatter as their errors predict (F test).

    Examples
    --------
    >>> parts_agree([0.25, 0.26, 0.24], [0.01, 0.01, 0.01], 0.0)
    True
    >>> parts_agree([0.25, 0.26, 0.01], [0.01, 0.01, 0.01], 0.0)
    False
    """
    from scipy.stats import f

    means, own = np.asarray(values, dtype=float), np.asarray(errors, dtype=float)
    if not (np.isfinite(means).all() and np.isfinite(own).all()):
        return False
    ratio = means.var(ddof=1) / max(float(np.mean(own**2)) + floor**2, 1e-300)
    freedom = len(means) - 1, len(means) * max(batches - 2, 1)
    return bool(f.sf(ratio, *freedom) > FALSE_ALARM_CHANCE)


def mean_exponent(parts: Sequence[Exponent]) -> Exponent:
    """Return the mean exponent of equally long parts, its error from the parts' scatter."""
    values = np.array([part.value for part in parts])
    return Exponent(float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values))))


def exponents_of_parts(
    instance: EventInstance, point: Point, start: State, periods: int, parts: int
) -> tuple[list[Exponent], State]:
    """Run the FMU over successive parts; return each part's exponent, and the end state."""
    eta, exponents = point.excitation.eta(point.structure), []
    for _ in range(parts):
        impacts = follow_impacts(instance, point, start, periods)
        start = tuple(instance.get(*STATE))
        end = periods * period_in_tau(eta)
        exponents.append(largest_exponent(impacts, end, point, BLOCKS, BATCHES))
    return exponents, start


def wander_error(periods: int, eta: float, wander: float = WANDER) -> float:
    """Return the exponent's error if a deviation wanders by a factor over the run: log/time."""
    floor: float = np.log(wander) / (periods * period_in_tau(eta))
    return floor


def run_until_steady(
    instance: EventInstance,
    point: Point,
    start: State,
    periods: int,
    parts: int,
    runs: int,
) -> LongRun:
    """Simulate run after run until the exponents of a run's parts agree; return the exponent.

    Where the parts of a run do not agree, the motion is followed on for as many parts again, which
    are then judged by themselves: a transient that ended is left behind.
    """
    floor = wander_error(periods, point.excitation.eta(point.structure))
    _, start = exponents_of_parts(instance, point, start, periods, 1)
    exponents: list[Exponent] = []
    for run in range(runs):
        exponents, start = exponents_of_parts(instance, point, start, periods, parts)
        values, errors = np.transpose(exponents)
        if parts_agree(values, errors, floor):
            outcome = ENDED if run else STEADY
            return LongRun(mean_exponent(exponents), outcome, periods * (1 + parts * (run + 1)))
    return LongRun(mean_exponent(exponents), UNDECIDED, periods * (1 + parts * runs))


def perturbed_start(point: Point, start: State, seed: NDArray[np.int64] | Sequence[int]) -> State:
    """Return a start state randomly perturbed by up to 1 per cent, for an independent chaotic
    run.
    """
    x1, _, v1, v2 = start
    gap_change, shift, fast, slow = 0.01 * np.random.default_rng(seed).uniform(-1.0, 1.0, 4)
    offset = point.structure.gap_offset
    new_gap = float(gap_between(np.array(start), offset)) * (1.0 + gap_change)
    x1 = x1 * (1.0 + shift)
    x2 = x1 + new_gap - offset
    return float(x1), float(x2), float(v1 * (1.0 + fast)), float(v2 * (1.0 + slow))
