"""Search a ramp's record for speed jumps besides the passing of the resonance.

Beside the passing of the resonance the speed may jump once more, by less. On a stable branch below
the resonance the torque that the vibration takes grows with the speed. It is the slip less what
turns the rotor faster. Where it falls on the way up, or rises on the way down, a motion may be
lost there; so where the speed changes much faster than the voltage. What falls by less than half of
the smallest further jump, or by no more than the scatter of an irregular motion, says nothing.
What falls by less than twice that jump is asked at held voltages, and undecided at most: fast ramps
show no such jump, and while the speed runs to the next motion the torque falls by more.

Non-dimensional, as :mod:`.jumps`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .jumps import (
    DOUBTFUL,
    JUMP,
    SMOOTH,
    Criterion,
    Passing,
    SweepLeg,
    classify_stretch,
    fast_rows,
    lag_difference,
    mean_width,
    running_mean,
    true_stretch_around,
)

SMALLEST = 8e-3  # change of the speed over omega from which on there is a further jump
CLEAR = 2.0 * SMALLEST  # change from which on the record shows one at every usual rate
LAST_STRETCH = 0.02  # of K omega, before the end of a ramp: a loss there may show after it
LEAST = 0.5 * SMALLEST  # change of the torque, as a speed over omega, from which on one is sought
LASTING = 10  # widths of the mean before and after, over which an irregular motion's torque falls
APART = 4  # widths of the mean between two places; for fewer no scatter is known


def find_further_jumps(
    leg: SweepLeg, b: float, up: bool, threshold: float, main: tuple[int, int] | None = None
) -> list[Passing]:
    """Find where the ramp may lose a motion besides the passing of the resonance."""
    limits, sign = Criterion(), 1.0 if up else -1.0
    width = mean_width(leg, b)
    if not width or len(leg.time) < 2 * APART * width:
        return []
    means = SweepLeg(*(running_mean(values, width) for values in leg))
    fast = fast_rows(means, width, sign, limits)
    torque, first = sign * vibration_torque(means, b, width), 3 * width // 2
    passings: list[Passing] = []

    for high, low in find_falls(torque, LEAST):
        before, after = high + first, low + first
        ended = [end - first for _, end in taken_spans(passings, main) if end <= before]
        looks = {
            classify_stretch(leg, means, b, sign, part, limits)
            for part in true_stretches(fast, high, low)
        }
        is_natural = leg.Omega[before] > threshold and not looks - {SMOOTH}
        if not high or is_natural or not lies_outside(before, after, taken_spans(passings, main)):
            continue
        earlier = torque[max(0, high - limits.around * width, *ended) : high]
        later = torque[low : low + limits.around * width]
        begins = not ended and len(earlier) < APART * width
        scatter = calmest_scatter(later, width) if begins else scatter_about_trend(earlier, width)
        noise, fall = limits.clearness * scatter, torque[high] - torque[low]
        reach = LASTING * width
        lasts = noise <= LEAST or earlier[-reach:].mean() - later[:reach].mean() > 0.5 * fall
        if fall > max(LEAST, noise) and lasts:
            rows = np.flatnonzero(torque[high : low + 1] < 0.5 * (torque[high] + torque[low]))
            half = float(before + rows[0])
            look = JUMP if looks == {JUMP} and fall > CLEAR else DOUBTFUL
            passings.append(Passing(math.ceil(half), before, after, look, half))
    for before, after in true_stretches(fast, 0, len(fast)):
        last = min(after + 2 * width, len(leg.time) - 1)
        excess = sign * (leg.Omega[last] - leg.Omega[before]) - np.ptp(leg.eta0[before : last + 1])
        is_jump = classify_stretch(leg, means, b, sign, (before, after), limits) == JUMP
        if is_jump and excess > LEAST and lies_outside(before, last, taken_spans(passings, main)):
            half, look = 0.5 * (before + after), JUMP if excess > CLEAR else DOUBTFUL
            passings.append(Passing(math.ceil(half), before, last, look, half))
    return sorted(passings)


def taken_spans(found: Sequence[Passing], main: tuple[int, int] | None) -> list[tuple[int, int]]:
    """Return the row ranges that already belong to a jump or to the passing of the resonance."""
    return [(other.before, other.after) for other in found] + ([main] if main else [])


def lies_outside(before: int, after: int, spans: Sequence[tuple[int, int]]) -> bool:
    """Return whether a range of rows overlaps none of some others."""
    return all(after < low or before > high for low, high in spans)


def vibration_torque(means: SweepLeg, b: float, width: int) -> np.ndarray:
    """Compute the mean torque taken by the vibration, as a speed over omega."""
    middle = slice(width, len(means.time) - width)
    acceleration = lag_difference(means.Omega, 2 * width) / lag_difference(means.time, 2 * width)
    return np.asarray((means.eta0 - means.Omega)[middle] - acceleration / b)


def find_falls(values: np.ndarray, least: float) -> list[tuple[int, int]]:
    """Find the spans from a maximum to the next minimum that fall by at least `least`."""
    spans, high, low, falling = [], 0, 0, False
    for i, value in enumerate(values.tolist()):
        if falling:
            low = i if value < values[low] else low
            if value >= values[low] + least:
                spans.append((high, low))
                high, falling = i, False
        elif value > values[high]:
            high = i
        elif value <= values[high] - least:
            low, falling = i, True
    return [*spans, (high, low)] if falling else spans


def scatter_about_trend(values: np.ndarray, width: int) -> float:
    """Estimate the standard deviation of values about a smooth trend."""
    if len(values) < APART * width:
        return math.inf
    third = values
    for _ in range(3):
        third = lag_difference(third, width)
    return float(np.sqrt(np.mean(third**2) / 20.0))


def calmest_scatter(values: np.ndarray, width: int) -> float:
    """Estimate the least scatter about a smooth trend of stretches that follow each other.

    After a jump at the begin of a fast ramp the torque swings for long: these swings are no scatter
    of the motion before, and of an irregular motion each stretch scatters.
    """
    stretches = range(0, max(1, len(values) - APART * width + 1), LASTING * width)
    return min(
        scatter_about_trend(values[first : first + LASTING * width], width) for first in stretches
    )


def true_stretches(runs: np.ndarray, first: int, last: int) -> list[tuple[int, int]]:
    """Return first and last index of each run of true values that begins in a range."""
    begins = np.flatnonzero(runs & ~np.concatenate([[False], runs[:-1]]))
    return [true_stretch_around(runs, int(i)) for i in begins if first <= i <= last]
