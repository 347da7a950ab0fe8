"""Follow a response in frequency to its relative resonance, the maximum of its largest gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..access import Instance
from ..structures import Structure
from .questions import make_series
from .respond import Response, follow_responses


@dataclass(frozen=True)
class RelativeResonance:
    """The relative resonance of a response: frequency ratio eta of its largest gap, state."""

    eta: float  # frequency ratio of the largest gap
    state: tuple[float, ...]  # the response there at phase 0: x1, x2 in m, v1, v2 in m/s


def follow_to_peak(
    instance: Instance,
    structure: Structure,
    eta: float,
    start: ArrayLike,
    multiplicity: int,
    *,
    step: float = 0.001,
    reach: float = 1.0,
    fall: float = 0.02,
    transient: int = 500,
    samples: int = 80,
    tolerance: float = 1e-2,
) -> RelativeResonance:
    """Increase eta until the largest gap of a 1-impact response passes its peak; return that."""
    etas = np.round(eta + step * np.arange(1, round(reach / step)), 9)
    points = make_series(structure, tuple(etas.tolist()), None, None).points
    peak, largest = RelativeResonance(eta, tuple(np.asarray(start, dtype=float).tolist())), 0.0
    responses = follow_responses(instance, points, start, transient, samples, tolerance)
    for current_eta, response in zip(etas, responses, strict=True):
        if response.x_rel_max < (1.0 - fall) * largest:
            break
        if response.x_rel_max > largest and is_one_impact_orbit(response, multiplicity):
            peak, largest = RelativeResonance(float(current_eta), response.end), response.x_rel_max
    return peak


def is_one_impact_orbit(response: Response, multiplicity: int, slack: float = 0.1) -> bool:
    """Return whether a response has the multiplicity and about one impact per repetition."""
    impacts = response.impacts_per_period * multiplicity
    return response.multiplicity == multiplicity and abs(impacts - 1.0) < slack
