"""Find the extreme displacements of mass 1 and box within each communication step.

Between impacts the first mass follows m x'' + d x' + k x = -m y'' with the cubic y'' that it was
told: its Taylor series is known from a state at either end of the step. Before an impact the series
from the beginning holds, after it the one from the end, so the turning points are as exact as the
states at the communication points. Of several impacts in one step only the last is told apart.
``compiled.c`` has the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ..structures.structure import Structure
from .exchange import Cubic, OscillatorOutputs, ShakerOutputs, Step
from .polynomials import end_slope, end_value

TERMS = 8  # derivatives of the series: a step of 0.2/omega leaves 1e-11 of the amplitude
Series = tuple[float, ...]


class Range(NamedTuple):
    """Store the lowest and the highest position over a step, m."""

    low: float
    high: float


def taylor_value(series: Series, time: float, order: int = 0) -> float:
    """Evaluate a Taylor series, or one of its derivatives, at a time from its centre."""
    total = 0.0
    for power in range(len(series) - 1 - order, -1, -1):
        total = series[power + order] + total * time / (power + 1)
    return total


def taylor_coefficients(
    structure: Structure, motion: OscillatorOutputs, acceleration: Cubic
) -> Series:
    """Return the derivatives of x1 at a state, given the box's acceleration."""
    mass, stiffness, damping = structure.m1, structure.k1, structure.d1
    balance = 0.0  # where the springs' forces are
    if motion.x_rel == 0.0 and motion.v1 == motion.v2:  # in contact
        mass, stiffness = mass + structure.m2, stiffness + structure.k2
        damping += structure.d2
        balance = position_in_balance(structure)
    derivatives = [motion.x1 - balance, motion.v1]
    for order in range(TERMS - 1):
        pull = (damping * derivatives[-1] + stiffness * derivatives[-2]) / mass
        derivatives.append(-pull - (acceleration[order] if order < len(acceleration) else 0.0))
    return (motion.x1, *derivatives[1:])


def position_in_balance(structure: Structure) -> float:
    """Return the x1 at which the springs balance in contact, m."""
    return structure.gap_offset * structure.k2 / (structure.k1 + structure.k2)


def end_derivatives(cubic: Cubic, h: float) -> Cubic:
    """Return the value and the derivatives of a cubic at the end of a step."""
    return end_value(cubic, h), end_slope(cubic, h), cubic[2] + h * cubic[3], cubic[3]


def extrema(series: Series, first: float, last: float) -> list[float]:
    """Return the positions at the ends of a time span and at a turning point between."""
    begin, end = taylor_value(series, first, 1), taylor_value(series, last, 1)
    positions = [taylor_value(series, first), taylor_value(series, last)]
    if begin * end < 0.0:
        time = first + (last - first) * begin / (begin - end)
        for _ in range(3):
            slope = taylor_value(series, time, 2)
            time -= taylor_value(series, time, 1) / slope if slope else 0.0
        if first <= time <= last:
            positions.append(taylor_value(series, time))
    return positions


def range_of_mass(
    structure: Structure,
    ends: tuple[OscillatorOutputs, OscillatorOutputs],
    acceleration: Cubic,
    begin: float,
    h: float,
) -> Range:
    """Return the lowest and the highest x1 within a step, also with an impact."""
    before, after = ends
    positions = [before.x1, after.x1]
    hit = after.impact_time - begin
    impact = after.impact_time != before.impact_time and 0.0 <= hit <= h
    if impact or before.v1 * after.v1 < 0.0:
        last = hit if impact else h
        positions += extrema(taylor_coefficients(structure, before, acceleration), 0.0, last)
        if impact:
            back = taylor_coefficients(structure, after, end_derivatives(acceleration, h))
            positions += extrema(back, hit - h, 0.0)
    return Range(min(positions), max(positions))


def range_of_box(
    before: ShakerOutputs, after: ShakerOutputs, acceleration: Cubic, h: float
) -> Range:
    """Return the lowest and the highest box position within a step."""
    positions = [before.box_position, after.box_position]
    if before.box_velocity * after.box_velocity < 0.0:
        positions += extrema((before.box_position, before.box_velocity, *acceleration), 0.0, h)
    return Range(min(positions), max(positions))


@dataclass
class Revolution:
    """Record the extreme positions during one revolution of the motor."""

    turn: float  # full turns of the motor at its beginning
    # s, and impacts so far, at its beginning
    time: float
    impacts: float
    # extreme positions since, m
    x1_high: float
    x1_low: float
    box_high: float
    box_low: float
    acceleration: float = 0.0  # largest of the box, m/s2

    @classmethod
    def begin(
        cls,
        motion: OscillatorOutputs,
        shaking: ShakerOutputs,
        turn: float = 0.0,
        time: float = 0.0,
        impacts: float = 0.0,
    ) -> Revolution:
        """Start the record of a revolution from both FMUs' present outputs."""
        x, y = motion.x1, shaking.box_position
        return cls(turn, time, impacts, x, x, y, y)

    def add(
        self,
        structure: Structure,
        before: tuple[OscillatorOutputs, ShakerOutputs],
        done: Step,
        begin: float,
        h: float,
    ) -> None:
        """Add the extreme positions and the box acceleration of one step."""
        motion, shaking = before
        x = range_of_mass(structure, (motion, done.motion), done.acceleration, begin, h)
        self.x1_high, self.x1_low = max(self.x1_high, x.high), min(self.x1_low, x.low)
        y = range_of_box(shaking, done.shaking, done.acceleration, h)
        self.box_high, self.box_low = max(self.box_high, y.high), min(self.box_low, y.low)
        self.acceleration = max(self.acceleration, abs(done.shaking.box_acceleration))

    def is_complete(self, turns: float) -> bool:
        """Return whether the motor has made one more full turn, in either direction."""
        return turns >= self.turn + 1.0 or turns <= self.turn - 1.0
