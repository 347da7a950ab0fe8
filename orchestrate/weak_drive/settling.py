"""Decide whether a motor at constant voltage has settled below or beyond the resonance.

A speed that is beyond the resonance may swing back, and one that hardly changes may be creeping
past a fold: neither the place nor the rate alone decides. The speed has settled where it converges
to a limit exponentially, or where it has long stayed within the same bounds. By a fold the approach
is algebraic, with changes that shrink less and less: it is told from exponential convergence by the
quotients of successive changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..structures.drive import Drive
from ..structures.structure import Structure
from . import averaged, own_resonance

UNDECIDED, CONVERGED, BOUNDED, NO_LOAD, NEITHER = range(5)
DECISIONS = {
    UNDECIDED: "undecided",
    CONVERGED: "converged",
    BOUNDED: "bounded",
    NO_LOAD: "no-load speed",
    NEITHER: "settled at the resonance",
}
MEAN = 60  # revolutions: means over them do not see motions that repeat after 2 to 6, 10 or 12
QUOTIENT = 0.25  # an approach to a fold has no two successive quotients that are smaller
CLOSE = 1e-5  # over omega, what a converging speed changes at last
NOISE = 3e-6  # over omega: communication points cut revolutions, their speeds scatter by 1e-6
LONGEST_MEMORY = 1000.0  # 1/omega, where next to nothing damps
PATIENCE = 600.0  # slowest time constants in the default limit


class Outcome(NamedTuple):
    """Store whether and where the speed has settled, and how that was decided."""

    decision: int  # key of `DECISIONS`: how it was decided
    # whether the speed, as a mean over `MEAN` revolutions, has settled beyond the resonance
    passed: bool = False
    time: float = math.nan  # from which it is beyond, s; NaN where it is not
    # the mean speed at last, rad/s; NaN where the motor was not simulated, or is undecided
    speed: float = math.nan

    @property
    def captured(self) -> bool:
        """Return whether the speed has settled below the resonance."""
        return self.decision not in (UNDECIDED, NEITHER) and not self.passed


class SettledEnd(NamedTuple):
    """Store the settled end of a speed record and how much it may still change."""

    decision: int  # `CONVERGED` or `BOUNDED`
    last: np.ndarray  # mean speeds over omega
    # what it may still change, over omega: it has a side where the threshold is further away
    margin: float


@dataclass(frozen=True)
class SettlingTest:
    """Set the thresholds and times of the test for a settled speed."""

    threshold: float  # speed between motions below and beyond the resonance, rad/s
    omega: float  # unit of the speeds' changes, rad/s
    slow: float  # slowest time constant, s
    motor: float  # time constant of the motor, s
    stay: int  # fewest revolutions on one side

    def judge_record(self, time: np.ndarray, speed: np.ndarray) -> Outcome:
        """Decide from the speed's record: captured, passed or undecided."""
        if len(speed) < 2 * MEAN:
            return Outcome(UNDECIDED)
        means = np.convolve(np.abs(speed) / self.omega, np.full(MEAN, 1.0 / MEAN), "valid")
        turn = float(np.median(np.diff(time[-MEAN:])))
        settled = self.find_convergence(means, turn) or self.find_bounds(means, turn)
        if settled is None:
            return Outcome(UNDECIDED)
        last = float(means[-1]) * self.omega
        sides = settled.last - self.threshold / self.omega
        if np.abs(sides).min() <= settled.margin or np.ptp(np.sign(sides)):
            return Outcome(NEITHER, speed=last)
        since = last_crossing(means > self.threshold / self.omega)
        if len(means) - since < self.stay:
            return Outcome(UNDECIDED)
        if sides[-1] < 0.0:
            return Outcome(settled.decision, speed=last)
        near = np.abs(speed[since : since + MEAN]) > self.threshold
        return Outcome(settled.decision, True, float(time[since + last_crossing(near)]), last)

    def find_convergence(self, means: np.ndarray, turn: float) -> SettledEnd | None:
        """Return the end of an exponentially converging record; else None.

        The ranges of four stretches that follow each other shrink by ``QUOTIENT`` or more each
        time, or are noise. No approach to a fold, and no passage by one, does: there
        x' = -a x^2, and of two successive quotients at least one is above 1/3.
        """
        shortest = max(MEAN, math.ceil(2.0 * self.motor / turn))
        for part in (8, 16, 32):
            width = len(means) // part
            if width < shortest:
                break
            ranges = [np.ptp(means[-i * width :][:width]) for i in (4, 3, 2, 1)]
            shrink = all(
                after < max(NOISE, QUOTIENT * before) for before, after in pairwise(ranges)
            )
            if shrink and ranges[-1] < CLOSE:
                return SettledEnd(CONVERGED, means[-width:], float(ranges[-1]) + NOISE)
        return None

    def find_bounds(self, means: np.ndarray, turn: float) -> SettledEnd | None:
        """Return the end of a record that stays in constant bounds; else None.

        The last quarter of the record is compared with the one before: its extremes, its mean and
        its range. An irregular or a swinging motion is told so. None where it has not.
        """
        quarter = len(means) // 4
        if quarter * turn < 25.0 * self.slow:
            return None
        early, late = means[-2 * quarter : -quarter], means[-quarter:]
        size = float(np.ptp(early))
        grown = max(early.min() - late.min(), late.max() - early.max())
        drift = abs(late.mean() - early.mean())
        if grown > 0.2 * size or drift > 0.1 * size or np.ptp(late) < 0.5 * size:
            return None
        return SettledEnd(BOUNDED, means[-2 * quarter :], 0.2 * size)


def last_crossing(beyond: np.ndarray) -> int:
    """Return the index from which a Boolean array keeps its last value."""
    changes = np.flatnonzero(beyond[1:] != beyond[:-1])
    return int(changes[-1]) + 1 if changes.size else 0


def settling_test(structure: Structure, drive: Drive, stay: int) -> SettlingTest:
    """Create the settling test of a structure and its drive."""
    omega = structure.omega
    return SettlingTest(
        threshold=own_resonance.dividing_speed(structure, drive) * omega,
        omega=omega,
        slow=longest_time_constant(structure, drive),
        motor=min(1.0 / drive.b(structure), LONGEST_MEMORY) / omega,
        stay=stay,
    )


def longest_time_constant(structure: Structure, drive: Drive) -> float:
    """Return the longest time constant of motor and dampers, s; each is limited.

    The motor's is 1/b, those of vibrations are 1/D of each damper.
    """
    rates = (drive.b(structure), structure.D1, structure.D2, drive.D_b(structure))
    return max(min(1.0 / rate if rate else math.inf, LONGEST_MEMORY) for rate in rates) / (
        structure.omega
    )


def time_past_the_fold(structure: Structure, drive: Drive, distance: float) -> float:
    """Estimate how long the speed creeps past the upper fold, s.

    Near the fold the speed obeys x' = r (distance + q x^2 / 2): it takes pi/(r sqrt(q distance/2)).
    """
    folds = averaged.folds(structure, drive)
    if not folds:
        return 0.0
    top, small = folds[0], 1e-3
    speeds = top.Omega + small * np.array([-1.5, -1.0, -0.5])
    voltages = averaged.no_load_speed(structure, drive, speeds)
    slope = float(voltages[2] - voltages[0]) / small
    bend = 2.0 * (top.eta0 - float(voltages[1])) / small**2
    growth = float(averaged.growth_rates(structure, drive, float(speeds[1]))[0].real)
    rate = -growth / slope
    if not (rate > 0.0 and bend > 0.0):  # the motion is lost before its fold
        return 0.0
    return math.pi / (rate * math.sqrt(0.5 * bend * distance)) / structure.omega


def usual_limit(structure: Structure, drive: Drive, distance: float) -> float:
    """Return the default time after which an unsettled start is undecided, s."""
    creeping = time_past_the_fold(structure.as_bonded(), drive, distance)
    return PATIENCE * longest_time_constant(structure, drive) + 10.0 * creeping
