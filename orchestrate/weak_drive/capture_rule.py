"""Decide whether a motor switched on has settled below or beyond the resonance.

- The speed has settled by the rule of :mod:`.steady_speed`, to `FINENESS` of the voltage's
  tolerance: *converged*, or with an error *bounded*. A motor whose no-load speed is below the
  resonance is captured, without a run.
- It is *captured* where the settled speed is below the resonance, and *passed* where it is beyond,
  as its means have been for `stay` revolutions.
- It has settled *at the resonance*, which is neither, where both are within the tolerance and
  `errors`.
- All else is *undecided*: a motion that keeps swinging slowly, or across the resonance.

The resonance is the speed that divides motions below it from those beyond (:mod:`.own_resonance`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..model.drive import Drive
from ..model.structure import Structure
from . import averaged, own_resonance
from .steady_speed import SettledSettings, settled_speed

FINENESS = 0.1  # of a settled speed's tolerance, over that of the voltage
MIN_TOLERANCE, MAX_TOLERANCE = 1e-6, 1e-4  # over omega
UNDECIDED, CONVERGED, BOUNDED, NO_LOAD, NEITHER = range(5)
DECISIONS = {
    UNDECIDED: "undecided",
    CONVERGED: "converged",
    BOUNDED: "bounded",
    NO_LOAD: "no-load speed",
    NEITHER: "settled at the resonance",
}


class CaptureOutcome(NamedTuple):
    """Store whether and where the speed has settled, and how that was decided."""

    decision: int  # key of `DECISIONS`: how it was decided
    passed: bool = False  # whether the speed has settled beyond the resonance
    time: float = math.nan  # from which it is beyond, s; NaN where it is not
    # the mean speed at last, rad/s; NaN where the motor was not simulated, or is undecided
    speed: float = math.nan

    @property
    def is_captured(self) -> bool:
        """Return whether the speed has settled below the resonance."""
        return self.decision not in (UNDECIDED, NEITHER) and not self.passed


@dataclass(frozen=True)
class SettlingTest:
    """Set what a settled speed is compared with."""

    threshold: float  # speed between motions below and beyond the resonance, rad/s
    omega: float  # unit of the speeds' changes, rad/s
    stay: int  # fewest revolutions on one side
    rule: SettledSettings
    errors: float = 3.0  # of the settled speed, within which it may be on either side

    def judge_record(self, time: np.ndarray, speed: np.ndarray) -> CaptureOutcome:
        speeds, block = np.abs(speed) / self.omega, self.rule.block
        mean, error = settled_speed(speeds, self.rule)
        if math.isnan(mean):
            return CaptureOutcome(UNDECIDED)
        threshold = self.threshold / self.omega
        if abs(mean - threshold) <= self.rule.tolerance + self.errors * error:
            return CaptureOutcome(NEITHER, speed=mean * self.omega)
        means = np.convolve(speeds, np.full(block, 1.0 / block), "valid")
        since = index_of_last_change(means > threshold)
        passed = bool(mean > threshold)
        if len(means) - since < self.stay or passed != (means[-1] > threshold):
            return CaptureOutcome(UNDECIDED)
        decision = BOUNDED if error else CONVERGED
        if not passed:
            return CaptureOutcome(decision, speed=mean * self.omega)
        near = speeds[since : since + block] > threshold
        crossed = float(time[since + index_of_last_change(near)])
        return CaptureOutcome(decision, True, crossed, mean * self.omega)


def index_of_last_change(flags: np.ndarray) -> int:
    """Return the index from which a Boolean array keeps its last value."""
    changes = np.flatnonzero(flags[1:] != flags[:-1])
    return int(changes[-1]) + 1 if changes.size else 0


def make_settling_test(
    structure: Structure, drive: Drive, stay: int, border_tolerance: float
) -> SettlingTest:
    omega = structure.omega
    threshold = own_resonance.dividing_speed(structure, drive) * omega
    tolerance = min(max(FINENESS * border_tolerance, MIN_TOLERANCE), MAX_TOLERANCE)
    return SettlingTest(threshold, omega, stay, SettledSettings(tolerance=tolerance))


def longest_time_constant(structure: Structure, drive: Drive) -> float:
    """Return the longest time constant of motor and dampers, s; each is limited."""
    rates = (drive.b(structure), structure.D1, structure.D2, drive.D_b(structure))
    return max(min(1.0 / rate, 1000.0) if rate else 1000.0 for rate in rates) / structure.omega


def time_past_the_fold(structure: Structure, drive: Drive, excess: float) -> float:
    """Estimate how long the speed creeps past the upper fold, s, at an excess over its eta0."""
    # x' = r (excess + q x^2 / 2) takes pi/(r sqrt(q excess/2))
    folds = averaged.folds(structure, drive)
    if not folds:
        return 0.0
    top, small = folds[0], 1e-3
    speeds = top.Omega + small * np.array([-1.5, -1.0, -0.5])
    voltages = averaged.stationary_voltage(structure, drive, speeds)
    slope = float(voltages[2] - voltages[0]) / small
    bend = 2.0 * (top.eta0 - float(voltages[1])) / small**2
    growth = float(averaged.growth_rates(structure, drive, float(speeds[1]))[0].real)
    rate = -growth / slope
    if not (rate > 0.0 and bend > 0.0):  # the motion is lost before its fold
        return 0.0
    return math.pi / (rate * math.sqrt(0.5 * bend * excess)) / structure.omega


def default_time_limit(structure: Structure, drive: Drive, border_tolerance: float) -> float:
    """Return the default time after which an unsettled start is undecided, s."""
    creeping = time_past_the_fold(structure.as_bonded(), drive, border_tolerance)
    return 600.0 * longest_time_constant(structure, drive) + 10.0 * creeping
