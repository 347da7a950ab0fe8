"""Find speed jumps in a ramp's record, where the motor passes the resonance (Sommerfeld).

A slow ramp takes the motor along a branch of stationary motions. Where the branch ends the speed
leaves it and passes the resonance: it changes many times as much as the voltage does meanwhile, and
so fast that the rotor's inertia takes a good part of the torque that the vibration sets free. A
steep but stable branch is followed in the ramp's own time: it is no jump. A record of a ramp does
not always tell the two apart: near the edge of a fold the one passes into the other. :mod:`.held`
asks the FMUs then.

Non-dimensional throughout: time 1/omega, speeds over omega, the voltage as no-load speed over
omega. The slip is no-load speed less speed: what the vibration takes from the motor.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

JUMP, DOUBTFUL, SMOOTH, UNFINISHED = "jump", "doubtful", "smooth", "unfinished"
SHARE = 0.3  # of the change of the slip in a jump: more than half its maximum where folds are close


class SweepLeg(NamedTuple):
    """Store time, voltage and speed of the revolutions with a rising or a falling voltage."""

    # at the revolutions' ends
    time: np.ndarray
    eta0: np.ndarray
    Omega: np.ndarray


class Passing(NamedTuple):
    """Store where in a ramp's record the speed passes the resonance, and how clearly."""

    row: int  # where the slip passes half of its largest value
    # where the speed leaves its branch, and where it follows the voltage again
    before: int
    after: int
    # what the record tells: `JUMP`; `SMOOTH` where the speed never changes much more than the
    # voltage; `DOUBTFUL` between the two; `UNFINISHED` where the record ends on the way
    look: str
    half: float  # the same as `row`, between two rows


class Criterion(NamedTuple):
    """Set the thresholds by which a ramp's record counts as a jump."""

    growth: float = 3.0  # least change of the speed over that of the voltage meanwhile
    # least torque of the rotor's inertia at its largest, over the torque set free
    share: float = 0.25
    # least share times the square of the growth of the whole change. By the edge of a fold, where
    # the branch is vertical but not lost, it is 2 to 6 at every rate
    strength: float = 12.0
    # least change of the speed over the scatter of its changes before and after, in as long a time
    # too: the speed of an irregular motion comes and goes by itself
    clearness: float = 8.0
    around: int = 40  # of how many widths of the running mean before and after that scatter is


def find_passing(
    leg: SweepLeg,
    b: float,
    up: bool,
    threshold: float,
    criterion: Criterion | None = None,
    calm: float = 0.0,
) -> Passing | None:
    """Find where the speed passes the resonance for good; None where it does not."""
    limits, sign = criterion or Criterion(), 1.0 if up else -1.0
    width = mean_width(leg, b)
    if not width:
        return None
    means = SweepLeg(*(running_mean(values, width) for values in leg))
    speed = means.Omega
    fast = fast_rows(means, width, sign, limits)
    early = np.flatnonzero(sign * (speed - threshold) <= 0.0)
    if not early.size or early[-1] == len(speed) - 1:
        return None
    cross = min(max(0, int(early[-1]) - width // 2), len(fast) - 1)
    near = np.flatnonzero(fast[max(0, cross - 2 * width) : cross + 2 * width + 1])
    if near.size:
        cross = max(0, cross - 2 * width) + int(near[np.argmin(np.abs(near - 2 * width))])
    before, after = true_stretch_around(fast, cross) if fast[cross] else (cross, cross + width)
    last = min(after + 2 * width, len(leg.time) - 1)
    slower = np.flatnonzero(leg.Omega[last:] < calm)  # where a ramp down leaves this resonance
    end = last + int(slower[0]) if slower.size and not up else len(leg.time)
    half = half_slip_row(np.abs(leg.eta0 - leg.Omega)[:end], before, last, up)
    half = float(cross + width) if half is None else half
    look = classify_stretch(leg, means, b, sign, (before, after), limits) if fast[cross] else SMOOTH
    return Passing(math.ceil(half), before, last, look, half)


def mean_width(leg: SweepLeg, b: float) -> int:
    """Return the width of the running mean in revolutions; 0 for too short a record."""
    if len(leg.time) < 2:
        return 0
    width = max(4, math.ceil(0.5 / (b * float(np.median(np.diff(leg.time))))))
    return width if len(leg.time) >= 4 * width else 0


def fast_rows(means: SweepLeg, width: int, sign: float, limits: Criterion) -> np.ndarray:
    """Mark the rows where the mean speed changes much faster than the voltage."""
    rise = sign * lag_difference(means.Omega, width)
    return np.asarray(rise > limits.growth * np.abs(lag_difference(means.eta0, width)))


def classify_stretch(
    leg: SweepLeg,
    means: SweepLeg,
    b: float,
    sign: float,
    stretch: tuple[int, int],
    limits: Criterion,
) -> str:
    """Classify a fast change of the speed: jump, smooth, doubtful or unfinished."""
    before, after = stretch
    width = len(leg.time) - len(means.time) + 1
    last = min(after + 2 * width, len(leg.time) - 1)
    time, rise = means.time, sign * lag_difference(means.Omega, width)
    top = before + int(
        np.argmax(rise[before : after + 1] / lag_difference(time, width)[before : after + 1])
    )
    if after == len(rise) - 1 and rise[-1] > 0.5 * rise[top]:
        return UNFINISHED
    slip = sign * (leg.eta0 - leg.Omega)
    inertia = rise[top] / (b * (time[top + width] - time[top]))
    growth = abs(leg.Omega[last] - leg.Omega[before]) / np.ptp(leg.eta0[before : last + 1])
    if growth < limits.growth:
        return SMOOTH
    free = slip[before] - slip[last]
    strong = inertia * growth**2 >= limits.strength * free
    noise = scatter_of_changes(means.Omega, width, (before, last), limits)
    clear = strong and abs(leg.Omega[last] - leg.Omega[before]) >= limits.clearness * noise
    sure = before > width and inertia >= limits.share * free and clear
    return JUMP if sure else DOUBTFUL


def scatter_of_changes(
    speed: np.ndarray, width: int, stretch: tuple[int, int], limits: Criterion
) -> float:
    """Return how much the mean speed changes by itself before and after a stretch.

    The speed of an irregular motion wanders for longer than the mean takes: of its changes in one
    width and of those in as many rows as the stretch has, the larger ones count.
    """
    before, last = stretch
    far = limits.around * width
    around = speed[max(0, before - far) : before], speed[last + width : last + width + far]
    changes = [
        lag_difference(part, lag)
        for part in around
        for lag in (width, min(last - before, far // 4))
        if len(part) > (lag if lag == width else lag + width)
    ]
    return max((float(np.std(change)) for change in changes), default=0.0)


def running_mean(values: np.ndarray, width: int) -> np.ndarray:
    """Return the means over `width` successive values."""
    return np.convolve(values, np.full(width, 1.0 / width), "valid")


def lag_difference(values: np.ndarray, width: int) -> np.ndarray:
    """Return the differences of values that lie `width` rows apart."""
    return np.asarray(values[width:] - values[:-width])


def true_stretch_around(runs: np.ndarray, top: int) -> tuple[int, int]:
    """Return first and last index of the run of true values that contains an index."""
    breaks = np.flatnonzero(~runs)
    before, after = breaks[breaks < top], breaks[breaks > top]
    return (
        int(before[-1]) + 1 if before.size else 0,
        int(after[0]) - 1 if after.size else len(runs) - 1,
    )


def half_slip_row(slip: np.ndarray, before: int, last: int, up: bool) -> float | None:
    """Return the fractional row where the slip crosses half its maximum; None if it never does.

    Where folds are close the slip is as large as that beyond the resonance too. It crosses
    ``SHARE`` of the way from there to its maximum then, where that is more.
    """
    level = slip[before:]
    highest, largest = int(np.argmax(level)), float(level.max())
    beyond = float(slip[min(last, len(slip) - 1)] if up else slip[before])
    half = max(0.5 * largest, beyond + SHARE * (largest - beyond))
    first = highest + 1 if up else 0
    rows = first + np.flatnonzero((level[first:] < half) == up)
    if not rows.size:
        return None
    row = int(rows[0])
    if row == 0:
        return float(before)
    ahead = (half - level[row]) / (level[row - 1] - level[row])
    return before + row - float(min(max(ahead, 0.0), 1.0))


def time_beyond_threshold(time: np.ndarray, Omega: np.ndarray, threshold: float) -> float:
    """Return the time from which the speed stays above a threshold; NaN if it does not."""
    below = np.flatnonzero(Omega <= threshold)
    if not len(Omega) or Omega[-1] <= threshold:
        return math.nan
    return float(time[below[-1] + 1]) if below.size else float(time[0])


def explain_not_passed(leg: SweepLeg, up: bool, resonance: float) -> str:
    """Explain in words why the speed does not pass the resonance for good."""
    if not len(leg.time):
        return f"the voltage does not {'rise' if up else 'fall'}"
    speed = np.abs(leg.Omega)
    first, last = float(speed[: 1 + len(speed) // 50].mean()), float(speed[-1])
    beyond = first > resonance
    if beyond == up and (last > resonance) == up:
        return f"began {'beyond' if up else 'below'} the resonance"
    return f"ends {'below' if up else 'beyond'} the resonance"
