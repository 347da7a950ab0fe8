"""Hold a voltage until the speed has settled, from a state of a past ramp or of another hold.

A state of the run is restored and its voltage is held. From there the voltage goes on in one step,
in short steps, each held until the speed has settled, so that the motion stays the same as long as
it lasts, or on a ramp. What has not settled in the time that is given has no speed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..running.job import Table
from .further_jumps import CLEAR, SMALLEST
from .run import Run
from .schedule import Constant, Ramp, Schedule

MEMORY = (
    "oscillator_state",
    "shaker_state",
    "master_memory",
    "revolution_memory",
    "control_memory",
)
FIRST = 4  # revolutions of a hold whose speed is still that of the ramp


class HeldPoint(NamedTuple):
    """Store where the speed settled at a held voltage, and the state reached."""

    voltage: float  # V
    speed: float  # mean speed over omega that it settles at; NaN where it had not settled in time
    error: float  # of the speed of an irregular motion; 0 where it settles
    begin: float  # mean speed of the first revolutions; NaN where there are none
    state: Table  # of the run, to go on from
    # voltage from which it was reached in one step, V; NaN where that was a state of the run
    origin: float
    # extremes of its mean speeds on the way there, over omega; NaN where there are none
    least: float = math.nan
    most: float = math.nan


@dataclass(frozen=True)
class HoldSettings:
    """Set steps, tolerances and limits of the held-voltage test."""

    # revolutions of a mean speed; a multiple of the periods after which motions usually repeat
    block: int = 24
    tolerance: float = 1e-4  # of the speed that a motion settles at, over omega
    width: float = 1e-4  # of the bracket of voltages that is asked for, over K omega
    # shortest step of the voltage, over K omega: where the speed still changes much over one, and
    # comes back, nothing is decided
    finest: float = 1e-6
    # largest difference of two settled speeds that may be of the same motion, over omega
    distinct: float = 2e-3
    # smallest difference of two settled speeds at one voltage that makes a jump, over omega
    two_motions: float = 5e-3
    # change of the settled speed between neighbours, over omega, below which there is no jump. It
    # is less than 0.866 `two_motions`: between two folds that are close, speeds at one voltage
    # differ by 2/sqrt(3) of what the speed jumps by at either, or less. So no steps find a jump
    # that others rule out
    smallest_jump: float = 4e-3
    # the same two for jumps beside the largest one
    further_motions: float = SMALLEST
    further_jump: float = 0.8 * SMALLEST
    # change of the speed over omega at a loss below which it is undecided, and the voltage, V,
    # shortly before which it is told all the same: voltages are held there at every rate
    least_told: float = 0.0
    told_near: float = math.nan
    # the same where a record suggests a jump: fast ramps show none that is smaller, so that whether
    # it is told would depend on the rate
    suspected_jump: float = CLEAR
    # change of the speed between neighbours, over omega, that is never put down to the scatter of
    # irregular motions: speeds that are known no better rule out no jump
    largest_scatter: float = 8e-3
    # how often a voltage is held again before the end of its motion counts as a loss, and how often
    # one is reached again from an irregular motion
    again: int = 3
    # range of voltages, over K omega, in which a motion may end meanwhile: where it does in a wider
    # one, it ends by chance or has long been unstable, and nothing is decided
    by_chance: float = 2e-4
    stair: float = 4e-3  # longest first step of the voltage, over K omega, and
    max_stairs: int = 25  # how many of them there are at most
    # longest step, over K omega, in which a motion is followed at first that a loss leads to
    short: float = 5e-4
    past: float = 0.02  # how far past the passing of the ramp the steps go, over K omega
    max_holds: int = 200  # most voltages that are held after them
    # of ramps from the end of a motion, over K omega in a time 1/omega: usual ones, whatever that
    # of the run was
    rates: tuple[float, ...] = (2e-4, 1e-4, 5e-5)


class VoltageHolder:
    """Restore states of a past ramp and hold voltages from there until speeds settle.

    Voltages are those of the mirror image in which the motor turns forward.
    """

    def __init__(
        self,
        begin: Callable[[Schedule], Run],
        schedule: Schedule,
        step: float,
        omega: float,
        volts: float,
        longest: float,
        settings: HoldSettings | None = None,
        sense: float = 1.0,
    ) -> None:
        """Store the ramp's schedule, its units and the settings of the test."""
        self.begin, self.schedule, self.step, self.sense = begin, schedule, step, sense
        self.omega, self.volts, self.longest = omega, volts, longest
        self.settings = settings or HoldSettings()
        self.checkpoints: dict[int, Table] = {}

    def add_checkpoints(self, table: Table, every: int, steps: int) -> None:
        """Store the ramp's saved states by their communication step."""
        for i in range(len(table["master_memory"])):
            state = {name: table[name][[i]] for name in MEMORY}
            self.checkpoints[min((i + 1) * every, steps)] = state

    def state_before(self, step: int) -> Table | None:
        """Return the ramp's state before a step, from a checkpoint; None at the start."""
        if step not in self.checkpoints and step:
            last = max((known for known in self.checkpoints if known < step), default=0)
            state = self.checkpoints[last] if last else None
            self.checkpoints[step] = self.follow_schedule(self.schedule, state, range(last, step))
        return self.checkpoints.get(step)

    def follow_schedule(self, schedule: Schedule, state: Table | None, steps: range) -> Table:
        """Return the state after communication steps of a schedule, from a state or the start."""
        run = self.begin(schedule)
        try:
            if state is not None:
                run.set_state(state)
            run.revolve(steps)
            return run.get_state()
        finally:
            run.master.close()

    def hold_step(self, step: int) -> HeldPoint:
        """Hold the voltage that the ramp has at a step, from its state there."""
        return self.hold_voltage(self.state_before(step), self.ramp_voltage(step))

    def ramp_voltage(self, step: int) -> float:
        """Return the voltage of the ramp at a communication step, V."""
        return self.sense * self.schedule.voltage((step + 0.5) * self.step)

    def step_from(self, point: HeldPoint, voltage: float) -> HeldPoint:
        """Change the voltage in one step from a held point, and hold it there."""
        return self.hold_voltage(point.state, voltage)._replace(origin=point.voltage)

    def ramp_from(self, point: HeldPoint, voltage: float, rate: float) -> HeldPoint:
        """Ramp the voltage from a held point at a rate over K omega^2, and hold it then."""
        ends = self.sense * point.voltage, self.sense * voltage
        ramp = Ramp(*ends, rate * self.volts * self.omega, back=False)
        steps = range(math.ceil(ramp.duration / self.step))
        return self.hold_voltage(self.follow_schedule(ramp, point.state, steps), voltage)

    def hold_voltage(self, state: Table | None, voltage: float) -> HeldPoint:
        """Simulate a constant voltage from a state until the speed settles."""
        count = math.ceil(self.longest / self.step)
        piece = max(1, round(150.0 / self.omega / self.step))
        held = Constant(self.sense * voltage, count * self.step)
        run, speeds = self.begin(held), np.zeros(0)
        speed, error, means = math.nan, 0.0, np.zeros(0)
        try:
            if state is not None:
                run.set_state(state)
            for first in range(0, count, piece):
                rows = run.revolve(range(first, min(first + piece, count)))
                speeds = np.append(speeds, np.abs(rows["speed"]) / self.omega)
                means = block_means(speeds, self.settings)
                speed, error = settled_speed(means, self.settings)
                if math.isfinite(speed):
                    break
            begin = float(speeds[:FIRST].mean()) if speeds.size else math.nan
            ends = (float(means.min()), float(means.max())) if means.size else (math.nan, math.nan)
            return HeldPoint(voltage, speed, error, begin, run.get_state(), math.nan, *ends)
        finally:
            run.master.close()

    def climb_stairs(
        self, low: HeldPoint, target: float, stair: float | None = None
    ) -> list[HeldPoint]:
        """Step the voltage to a target; return the points at which it settled."""
        span = abs(target - low.voltage) / self.volts
        stair = stair or self.settings.stair
        count = max(1, min(math.ceil(span / stair), self.settings.max_stairs))
        points = [low]
        for voltage in np.linspace(low.voltage, target, count + 1)[1:].tolist():
            point = self.step_from(points[-1], voltage)
            if math.isfinite(point.speed):
                points.append(point)
        return points

    def settled_between(self, low: HeldPoint, high: HeldPoint) -> HeldPoint | None:
        """Hold voltages between two points until one settles, the middle first; None if none."""
        parts = (0.5, 0.25, 0.75)
        voltages = (low.voltage + part * (high.voltage - low.voltage) for part in parts)
        points = (self.step_from(low, voltage) for voltage in voltages)
        return next((point for point in points if math.isfinite(point.speed)), None)

    def hold_again(self, point: HeldPoint) -> HeldPoint:
        """Hold a motion again; return its new point if the speed differs.

        An irregular motion may be lost while its voltage is still held, and one that is hardly
        unstable leaves long after its speed seemed to settle; other points are returned unchanged.
        """
        later = point
        for _ in range(self.settings.again):
            later = self.step_from(later, point.voltage)
            if self.differ(later, point):
                return later
        return point

    def is_irregular(self, point: HeldPoint) -> bool:
        """Return whether the speed of a point scatters, as in chaotic motion."""
        return point.error > self.settings.tolerance

    def is_within(self, low: HeldPoint, high: HeldPoint, width: float) -> bool:
        """Return whether two points' voltages are closer than a width over K omega."""
        return abs(high.voltage - low.voltage) <= width * self.volts

    def differ(self, point: HeldPoint, other: HeldPoint) -> bool:
        """Return whether two points have settled at clearly different speeds."""
        return abs(point.speed - other.speed) > self.settings.distinct + speed_difference_error(
            point, other
        )


def speed_difference_error(point: HeldPoint, other: HeldPoint) -> float:
    """Return three standard errors of the difference between two settled speeds."""
    return 3.0 * math.hypot(point.error, other.error)


def block_means(speeds: np.ndarray, settings: HoldSettings) -> np.ndarray:
    """Return the mean speeds of blocks of revolutions, without the first block."""
    count = len(speeds) // settings.block
    blocks = speeds[: count * settings.block].reshape(count, settings.block)
    return np.asarray(blocks.mean(axis=1)[1:])


def settled_speed(means: np.ndarray, settings: HoldSettings) -> tuple[float, float]:
    """Extrapolate the limit of block means (Aitken); return it with its error, or NaN.

    Means that approach a limit as an exponential say it before they are there (Aitken's process):
    three such limits in turn must agree. By a fold the approach is slower than any exponential, and
    they do not. Small changes to and fro have settled. Irregular motions have where three long
    means differ by less than their scatter.
    """
    changes = np.diff(means)
    if len(changes) < 4:
        return math.nan, 0.0
    last = changes[-4:]
    if np.abs(last).max() < 0.01 * settings.tolerance:
        return float(means[-1]), 0.0
    if not (last > 0.0).all() and not (last < 0.0).all():
        if np.ptp(means[-5:]) < 0.3 * settings.tolerance:
            return float(means[-5:].mean()), 0.0
    else:
        ratios = last[1:] / last[:-1]
        if ratios.max() < 0.95:
            limits = means[-3:] + last[1:] * ratios / (1.0 - ratios)
            if np.ptp(limits) < 0.5 * settings.tolerance:
                return float(limits[-1]), 0.0
    if len(means) < 24:
        return math.nan, 0.0
    thirds = means[-24:].reshape(3, 8).mean(axis=1)
    scatter = float(np.std(np.diff(means[-24:])))
    if np.ptp(thirds) < max(settings.tolerance, 0.7 * scatter):
        error = max(float(np.ptp(thirds)), 0.5 * float(np.std(means[-24:])))
        return float(thirds.mean()), error
    return math.nan, 0.0
