"""Where the speed jumps, as the voltage comes and goes.

A slow ramp takes the motor along a branch of stationary motions. Where the branch ends the speed
leaves it: it changes many times as much as the voltage does meanwhile, and so fast that the rotor's
inertia takes a good part of the torque that the vibration sets free. A steep but stable branch is
followed in the ramp's own time: it is no jump.

Non-dimensional throughout: time 1/omega, speeds over omega, the voltage as no-load speed over
omega. The slip is no-load speed less speed: what the vibration takes from the motor.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class Way(NamedTuple):
    """Revolutions on which the voltage goes one way, each shape (n,).

    Attributes
    ----------
    time, eta0, Omega : ndarray
        At the revolutions' ends.
    """

    time: np.ndarray
    eta0: np.ndarray
    Omega: np.ndarray


class Jump(NamedTuple):
    """A jump of the speed, by rows.

    Attributes
    ----------
    row : int
        Where the slip passes half of its largest value.
    before, after : int
        Where the speed leaves its branch, and where it follows the voltage again.
    """

    row: int
    before: int
    after: int


class Criterion(NamedTuple):
    """What counts as a jump.

    Attributes
    ----------
    growth : float
        Least change of the speed over that of the voltage meanwhile.
    share : float
        Least torque of the rotor's inertia at its largest, over the torque set free.
    """

    growth: float = 3.0
    share: float = 0.12


def find_jump(way: Way, b: float, up: bool, criterion: Criterion | None = None) -> Jump | None:
    """Find the jump on a way up or down; None where the speed follows the voltage.

    Parameters
    ----------
    way : Way
    b : float
        Slope of the torque line, the inverse of the time in which a rotor without load settles.
    up : bool
        Whether the voltage rises; a jump goes the same way.
    criterion : Criterion, optional
    """
    limits, sign = criterion or Criterion(), 1.0 if up else -1.0
    if len(way.time) < 2:
        return None
    width = max(4, math.ceil(0.5 / (b * float(np.median(np.diff(way.time))))))
    if len(way.time) < 4 * width:
        return None
    time, eta0, speed = (running_mean(values, width) for values in way)
    rise, change = sign * apart(speed, width), np.abs(apart(eta0, width))
    top = int(np.argmax(rise / apart(time, width)))
    before, after = extent(rise > limits.growth * change, top)
    unfinished = after == len(rise) - 1 and rise[-1] > 0.5 * rise[top]
    if rise[top] <= limits.growth * change[top] or unfinished:
        return None
    last = min(after + 2 * width, len(way.time) - 1)
    slip = sign * (way.eta0 - way.Omega)
    freed = slip[before] - slip[last]
    inertia = rise[top] / (b * (time[top + width] - time[top]))
    grown = abs(way.Omega[last] - way.Omega[before])
    if inertia < limits.share * freed or grown < limits.growth * np.ptp(
        way.eta0[before : last + 1]
    ):
        return None
    row = half_slip(np.abs(way.eta0 - way.Omega), before, up)
    return None if row is None else Jump(row, before, last)


def running_mean(values: np.ndarray, width: int) -> np.ndarray:
    """Means of ``width`` values each: motions that repeat after some revolutions look steady."""
    return np.convolve(values, np.full(width, 1.0 / width), "valid")


def apart(values: np.ndarray, width: int) -> np.ndarray:
    """Differences of values ``width`` places apart."""
    return np.asarray(values[width:] - values[:-width])


def extent(runs: np.ndarray, top: int) -> tuple[int, int]:
    """First and last place of the stretch of true values around ``top``."""
    breaks = np.flatnonzero(~runs)
    before, after = breaks[breaks < top], breaks[breaks > top]
    return (
        int(before[-1]) + 1 if before.size else 0,
        int(after[0]) - 1 if after.size else len(runs) - 1,
    )


def half_slip(slip: np.ndarray, before: int, up: bool) -> int | None:
    """The row at which the slip falls below (down: rises above) half of its largest value."""
    level = slip[before:]
    if up:
        highest = int(np.argmax(level))
        after = 1 + highest + np.flatnonzero(level[highest + 1 :] < 0.5 * level[highest])
    else:
        after = np.flatnonzero(level > 0.5 * level.max())
    return before + int(after[0]) if after.size else None


def stays_beyond(time: np.ndarray, Omega: np.ndarray, divide: float) -> float:
    """Time from which a speed stays above ``divide``; NaN where it ends below."""
    below = np.flatnonzero(Omega <= divide)
    if not len(Omega) or Omega[-1] <= divide:
        return math.nan
    return float(time[below[-1] + 1]) if below.size else float(time[0])


def why_none(way: Way, up: bool, resonance: float, has_folds: bool) -> str:
    """Why there is no jump.

    Parameters
    ----------
    way : Way
    up : bool
    resonance : float
        Speed of the resonance over omega.
    has_folds : bool
        Whether the averaged theory, bonded, has folds.
    """
    if not len(way.time):
        return f"the voltage does not {'rise' if up else 'fall'}"
    speed = np.abs(way.Omega)
    first, last = float(speed[: 1 + len(speed) // 50].mean()), float(speed[-1])
    beyond = first > resonance
    if beyond == up and (last > resonance) == up:
        return f"began {'beyond' if up else 'below'} the resonance"
    if abs(speed[-1] - speed[-5:][0]) > np.ptp(way.eta0[-5:]) * Criterion().growth:
        return "the ramp ends within a jump"
    if (last > resonance) != up:
        return f"ends {'below' if up else 'beyond'} the resonance"
    if has_folds:
        return "not told from a steep branch at this rate: the averaged theory has a fold"
    return "no fold: the speed follows the voltage through the resonance"
