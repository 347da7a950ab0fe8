"""Find the extreme displacements of mass 1 and box within each communication step.

Between impacts the first mass follows m x'' + d x' + k x = -m y'' with the cubic y'' that it was
told: its Taylor series is known from a state at either end of the step. Before an impact the series
from the beginning holds, after it the one from the end, so the turning points are as exact as the
states at the communication points. Of several impacts in one step only the last is resolved.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..model.structure import Structure
from .polynomials import Cubic, end_derivatives
from .step_record import Floats, OscillatorOutputs, Record


def gap_acceleration(structure: Structure, motion: OscillatorOutputs) -> Any:
    """Return the acceleration of the gap by springs and dampers, m/s2, were the masses free."""
    s = structure
    first = (s.k1 * motion.x1 + s.d1 * motion.v1) / s.m1
    return first - (s.k2 * motion.x2 + s.d2 * motion.v2) / s.m2


class Range(NamedTuple):
    """Store the lowest and the highest position over each step, m."""

    low: Floats
    high: Floats

    def widen(self, steps: Any, positions: Sequence[Floats]) -> Range:
        """Widen the range, in place, by positions in some steps; NaN counts as none; return it."""
        for position in positions:
            self.low[steps] = np.fmin(self.low[steps], position)
            self.high[steps] = np.fmax(self.high[steps], position)
        return self


def taylor_value(series: Sequence[Any], time: Any, order: int = 0) -> Any:
    """Evaluate a Taylor series, or one of its derivatives, at a time from its centre."""
    total = 0.0
    for power in range(len(series) - 1 - order, -1, -1):
        total = series[power + order] + total * time / (power + 1)
    return total


def derivatives_of_x1(
    structure: Structure, motion: OscillatorOutputs, acceleration: Cubic
) -> list[Any]:
    """Return the derivatives of x1 at states, given the box's acceleration."""
    s = structure
    contact = (motion.x_rel == 0.0) & (motion.v1 == motion.v2)
    mass, stiffness, damping = (
        np.where(contact, first + second, first)
        for first, second in ((s.m1, s.m2), (s.k1, s.k2), (s.d1, s.d2))
    )
    # in contact the springs balance elsewhere
    balance = np.where(contact, s.gap_offset * s.k2 / (s.k1 + s.k2), 0.0)
    series = [motion.x1 - balance, motion.v1]
    for order in range(7):  # a step of 0.2/omega leaves 1e-11 of the amplitude
        pull = (damping * series[-1] + stiffness * series[-2]) / mass
        series.append(-pull - (acceleration[order] if order < len(acceleration) else 0.0))
    return [motion.x1, *series[1:]]


def extrema(series: Sequence[Any], first: Any, last: Any) -> list[Any]:
    """Return the positions at the ends of time spans, and at a turning point between, or NaN."""
    begin, end = taylor_value(series, first, 1), taylor_value(series, last, 1)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        time = first + (last - first) * begin / (begin - end)
        for _ in range(3):
            time = time - taylor_value(series, time, 1) / taylor_value(series, time, 2)
        turns = (begin * end < 0.0) & (first <= time) & (time <= last)
        between = np.where(turns, taylor_value(series, time), np.nan)
    return [taylor_value(series, first), taylor_value(series, last), between]


def range_of_mass_1(structure: Structure, record: Record) -> Range:
    """Return the lowest and the highest x1, of mass 1, within each step, by its turning points."""
    before, after = record.before.motion(), record.after.motion()
    cubic = record.after.acceleration_cubics()
    h = record.after["h"]
    hit = after.impact_time - record.before["time"]
    impact = (after.impact_time != before.impact_time) & (hit >= 0.0) & (hit <= h)
    reached = Range(np.minimum(before.x1, after.x1), np.maximum(before.x1, after.x1))
    turning = np.flatnonzero(impact | (before.v1 * after.v1 < 0.0))
    last = np.where(impact, hit, h)[turning]
    begin = (select_steps(columns, turning) for columns in (before, cubic))
    reached.widen(turning, extrema(derivatives_of_x1(structure, *begin), 0.0 * last, last))
    struck = np.flatnonzero(impact)
    end = end_derivatives(select_steps(cubic, struck), h[struck])
    back = derivatives_of_x1(structure, select_steps(after, struck), end)
    return reached.widen(struck, extrema(back, (hit - h)[struck], 0.0 * h[struck]))


def range_of_box(record: Record) -> Range:
    position, velocity = record["box_position"], record["box_velocity"]
    ends = position[:-1], position[1:]
    reached = Range(np.minimum(*ends), np.maximum(*ends))
    turning = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)
    cubic = select_steps(record.after.acceleration_cubics(), turning)
    h = record.after["h"][turning]
    series = (position[turning], velocity[turning], *cubic)
    return reached.widen(turning, extrema(series, 0.0 * h, h))


def select_steps(values: Any, steps: Any) -> Any:
    """Return a named tuple of arrays, or a plain one, at some steps."""
    chosen = (column[steps] for column in values)
    return type(values)._make(chosen) if hasattr(values, "_make") else tuple(chosen)
