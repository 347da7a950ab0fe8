"""How long permanent contact lasts: root search for the first zero (19) of the contact force.

The force is sampled. Where it nearly vanishes between two samples and they do not show it, its
largest value there is found first: a contact may open and press again within a sample.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .closed_form import ClosedForm, Floats

Force = Callable[..., Floats]


def contact_durations(
    form: ClosedForm, phase: Floats, position: Floats, velocity: Floats, spans: Floats
) -> Floats:
    """Return how long permanent contacts last, in tau; infinite if not released in the span."""
    from scipy.optimize.elementwise import find_root

    if not len(spans):
        return np.zeros(0)

    def force(time: Floats, *begin: Floats) -> Floats:
        """Return the contact force (18) a time after permanent contact has begun."""
        return form.force(*form.common_motion(time, *begin))

    periods = form.fastest * float(spans.max()) / (2.0 * math.pi)
    # no short contact is passed over, nor a part of an oscillation
    count = max(64, math.ceil(16 * periods))
    early = (0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2)  # and two samples after the span
    times = np.array([*early, *range(1, count + 3)]) / count * spans[:, None]
    begin = np.array([phase, position, velocity])
    forces = force(times, *begin[:, :, None])
    opens = forces[:, 1:] >= 0.0  # below zero at first: pressed
    first = np.where(opens.any(axis=1), opens.argmax(axis=1) + 1, times.shape[1])
    ends = np.append(times, np.full((len(spans), 1), np.inf), axis=1)
    rows = np.arange(len(spans))
    low, high = ends[rows, first - 1], ends[rows, first]
    for row, before, top in short_openings(force, begin, times, forces, first):
        if top < high[row]:
            low[row], high[row] = before, top
    known = np.isfinite(high)
    root = find_root(force, (low[known], high[known]), args=tuple(begin[:, known]))
    # where rounding leaves no change of sign in the bracket, its end is near enough
    high[known] = np.where(root.success, root.x, high[known])
    return np.where(high <= spans, high, np.inf)


def short_openings(
    force: Force, begin: Floats, times: Floats, forces: Floats, first: NDArray[np.intp]
) -> list[tuple[int, float, float]]:
    """Find openings between samples that are all pressed: contact, last sample, largest force."""
    from scipy.optimize.elementwise import find_minimum

    left, middle, right = forces[:, :-2], forces[:, 1:-1], forces[:, 2:]
    before, after = np.diff(times, axis=1)[:, :-1], np.diff(times, axis=1)[:, 1:]
    rise, fall = (middle - left) / before, (middle - right) / after
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = (rise * after - fall * before) / (before + after)
        above = slope**2 * (before + after) / (4.0 * (rise + fall))  # of the parabola's vertex
    # more than the force rises above the samples
    tops = (rise >= 0.0) & (fall > 0.0) & (middle < 0.0) & (middle + 4.0 * above >= 0.0)
    tops &= np.arange(1, times.shape[1] - 1) < first[:, None]
    row, place = np.nonzero(tops)
    if not len(row):
        return []
    bracket = tuple(times[row, place + shift] for shift in range(3))
    found = find_minimum(
        lambda time, *start: -force(time, *start), bracket, args=tuple(begin[:, row])
    )
    is_open = found.f_x <= 0.0
    return list(
        zip(
            row[is_open].tolist(),
            bracket[0][is_open].tolist(),
            found.x[is_open].tolist(),
            strict=True,
        )
    )
