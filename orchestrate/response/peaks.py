"""Largest displacements and accelerations of responses, interpolated between samples (Hermite).

Between two samples without an impact, displacement and velocity, acceleration and its rate are
known at both ends by the equations of motion: the extremum between them is one of a cubic. An
interval with an impact is cut in two there: it is where the cubic of the gap vanishes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .equations import Flags, Floats, MotionCoefficients, in_touch
from .questions import Point

POINTS = 200  # states over the periods looked at: as many as the FMU keeps in a step
PEAKS = ("x1_max", "x2_max", "a1_max", "a2_max")
Rows = NDArray[np.intp]


class Motion(NamedTuple):
    """Displacements and accelerations of both masses at some times, with two time derivatives."""

    # displacements of both masses and their absolute accelerations; their time derivatives
    value: Floats
    slope: Floats
    bend: Floats  # accelerations of both masses relative to the box, and their time derivatives

    @classmethod
    def from_states(
        cls, states: Floats, rates: MotionCoefficients, forces: tuple[Floats, Floats]
    ) -> Motion:
        """Return the motion's values and derivatives at states, by the equations of motion."""
        x, v = states[:2], states[2:]
        absolute = rates.acceleration(x, v)
        relative = absolute + forces[0]
        rate = rates.restoring_acceleration(v, relative)
        value, slope = np.concatenate([x, absolute]), np.concatenate([v, rate])
        return cls(value, slope, np.concatenate([relative, rate + forces[1]]))

    def at_index(self, index: tuple[Any, ...]) -> Motion:
        """Return the motion at the times that an index or mask selects."""
        return self.map_arrays(lambda array: array[(slice(None), *index)])

    def map_arrays(self, change: Callable[[Floats], Floats]) -> Motion:
        """Apply a function to all three arrays; return the motion of its results."""
        return Motion(change(self.value), change(self.slope), change(self.bend))


class BoxMotion(NamedTuple):
    """Harmonic motion of the box, a row per point: frequency and acceleration amplitude."""

    frequency: Floats
    amplitude: Floats

    def forcing(self, sine: Floats, cosine: Floats) -> tuple[Floats, Floats]:
        """Return the inertial forcing and its time derivative from the phase's sine and cosine."""
        return self.amplitude * sine, self.amplitude * self.frequency * cosine


def peaks(
    points: Sequence[Point], periods: Sequence[int], states: Floats, jump: float = 1e-3
) -> dict[str, Floats]:
    """Return the largest displacements and accelerations of both masses in each response.

    Intervals of length h are exact to about ``(w h)^4/400``, w the fastest frequency; of several
    impacts in one interval the first is seen alone, an acceleration between them may be missed.
    """
    count = states.shape[1] - 1
    rates = MotionCoefficients.from_structures(point.structure for point in points)
    speed = np.array([[point.excitation.frequency] for point in points])
    drive = BoxMotion(speed, np.array([[p.excitation.amplitude] for p in points]) * speed**2)
    kinds, kind = np.unique(periods, return_inverse=True)
    angles = 2.0 * np.pi * np.outer(kinds, np.arange(count + 1)) / count
    angle = angles[kind]
    width = angle[:, 1:2] / speed
    offsets = np.array([[point.structure.gap_offset] for point in points])
    touching = in_touch(states, offsets)
    columns = np.ascontiguousarray(np.moveaxis(states, -1, 0))
    forces = drive.forcing(np.sin(angles)[kind], np.cos(angles)[kind])
    motion = Motion.from_states(columns, rates.effective(touching), forces)
    left, right = (motion.at_index((slice(None), side)) for side in (np.s_[:-1], np.s_[1:]))
    smooth = is_without_impact(left, right, width, jump * np.abs(columns[2:]).max(axis=(0, 2)))
    largest = np.abs(motion.value).max(axis=2)
    update_maxima_from_cubics(
        largest, np.broadcast_to(smooth, left.value.shape), left, right, width
    )
    index = np.nonzero(~smooth & ~touching[:, :-1])
    sides = left.at_index(index), right.at_index(index)
    rows = index[0]
    cut = ImpactIntervals(rows, *sides, width[rows, 0], angle[index], offsets[rows, 0])
    cut = cut.that_can_exceed(largest)
    if len(cut.row):
        update_maxima_from_impacts(largest, cut, points, rates, drive)
    return dict(zip(PEAKS, largest, strict=True))


def is_without_impact(left: Motion, right: Motion, width: Floats, jump: Floats) -> Flags:
    """Return whether velocities over intervals change as by accelerations alone, (n, k)."""
    change = 0.5 * width * (left.bend[:2] + right.bend[:2])
    change += width * width / 12.0 * (left.bend[2:] - right.bend[2:])
    matches = np.abs(right.slope[:2] - left.slope[:2] - change) <= jump[:, None]
    both: Flags = np.logical_and(matches[0], matches[1])
    return both


def cubic_extrema(left: Motion, right: Motion, width: Floats) -> Floats:
    """Return the extreme values of Hermite cubics whose end slopes have opposite signs."""
    rise, start, end = right.value - left.value, left.slope * width, right.slope * width
    b, c = 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise
    # the slope is start + 2 b u + 3 c u^2, with one root in (0, 1)
    q = -(b + np.copysign(np.sqrt(np.maximum(b * b - 3.0 * c * start, 0.0)), b))
    with np.errstate(divide="ignore", invalid="ignore"):
        first_root, second_root = q / (3.0 * c), start / q
    u = np.where((first_root >= 0.0) & (first_root <= 1.0), first_root, second_root)
    extremum: Floats = left.value + u * (start + u * (b + u * c))
    return extremum


def update_maxima_from_cubics(
    largest: Floats, candidates: Flags, left: Motion, right: Motion, width: Floats
) -> None:
    """Raise maxima in place where the interpolating cubics of intervals exceed them."""
    turns = np.nonzero(candidates & (left.slope * right.slope < 0.0))
    ends = [side.map_arrays(lambda array: array[turns]) for side in (left, right)]
    np.maximum.at(largest, turns[:2], np.abs(cubic_extrema(ends[0], ends[1], width[turns[1], 0])))


class ImpactIntervals(NamedTuple):
    """Sampling intervals that contain an impact: row, both ends, width, phase, clearance."""

    row: Rows
    left: Motion
    right: Motion
    width: Floats
    angle: Floats
    gap_offset: Floats

    def at_index(self, chosen: Flags) -> ImpactIntervals:
        """Return the intervals that a mask selects."""
        row, left, right, *numbers = self
        ends = left.at_index((chosen,)), right.at_index((chosen,))
        return ImpactIntervals(row[chosen], *ends, *(each[chosen] for each in numbers))

    def that_can_exceed(self, largest: Floats) -> ImpactIntervals:
        """Return the intervals whose bound on the motion exceeds the maxima so far."""
        left, right, width = self.left, self.right, self.width
        reach = np.maximum(np.abs(left.value), np.abs(right.value))
        reach += width * (np.abs(left.slope) + np.abs(right.slope))
        return self.at_index(np.any(reach > largest[:, self.row], axis=0))


def update_maxima_from_impacts(
    largest: Floats,
    cut: ImpactIntervals,
    points: Sequence[Point],
    rates: MotionCoefficients,
    drive: BoxMotion,
) -> None:
    """Raise maxima in place by the motion before and after impacts in intervals."""
    time = first_contact_time(cut)
    touches = np.isfinite(time)
    if not touches.any():  # grazing impacts, which the cubics of the gap do not show
        return
    cut, time = cut.at_index(touches), time[touches]
    effective_rates = rates.in_flight(cut.row)
    drive = BoxMotion(drive.frequency[cut.row, 0], drive.amplitude[cut.row, 0])
    angle = cut.angle + drive.frequency * time
    forcing = drive.forcing(np.sin(angle), np.cos(angle))
    before = taylor_step(cut.left, time)
    after = states_after_impacts(before, [points[row] for row in cut.row])
    ends = [Motion.from_states(states, effective_rates, forcing) for states in (before, after)]
    extreme = np.maximum(np.abs(ends[0].value), np.abs(ends[1].value))
    everywhere = np.ones((*extreme.shape, 1), dtype=bool)
    for left, right, width in ((cut.left, ends[0], time), (ends[1], cut.right, cut.width - time)):
        sides = [side.map_arrays(lambda array: array[..., None]) for side in (left, right)]
        update_maxima_from_cubics(extreme, everywhere, sides[0], sides[1], width[:, None])
    for channel, values in enumerate(extreme):
        np.maximum.at(largest[channel], cut.row, values)


def taylor_step(motion: Motion, time: Floats) -> Floats:
    """Return states x1, x2, v1, v2 a time later, by Taylor series up to the third derivative."""
    x, v, a, j = motion.value[:2], motion.slope[:2], motion.bend[:2], motion.bend[2:]
    position = x + time * (v + time * (a / 2.0 + time * j / 6.0))
    return np.concatenate([position, v + time * (a + time * j / 2.0)])


def first_contact_time(cut: ImpactIntervals, iterations: int = 20) -> Floats:
    """Return when the gap first closes in each interval (Newton, bisection); NaN if never."""
    taylor = (cut.left.value[:2], cut.left.slope[:2], cut.left.bend[:2], cut.left.bend[2:])
    g = [part[1] - part[0] for part in taylor]
    g[0] = np.where(cut.gap_offset == 0.0, g[0], g[0] + cut.gap_offset)

    def gap(s: Floats) -> Floats:
        distance: Floats = g[0] + s * (g[1] + s * (g[2] / 2.0 + s * g[3] / 6.0))
        return distance

    low, high, time = np.zeros_like(cut.width), cut.width, 0.5 * cut.width
    for _ in range(iterations):
        is_open = gap(time) > 0.0
        low, high = np.where(is_open, time, low), np.where(is_open, high, time)
        slope = g[1] + time * (g[2] + time * g[3] / 2.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = time - gap(time) / slope
        time = np.where((step > low) & (step < high), step, 0.5 * (low + high))
    return np.where((g[0] > 0.0) & (gap(cut.width) <= 0.0), time, np.nan)


def states_after_impacts(before: Floats, points: Sequence[Point]) -> Floats:
    """Return the states just after impacts (15) from those just before, shape (4, n)."""
    m1, m2 = np.array([(p.structure.m1, p.structure.m2) for p in points]).T
    closing = before[2] - before[3]
    e = np.array([p.structure.restitution(v) for p, v in zip(points, closing, strict=True)])
    impulse = (1.0 + e) * m1 * m2 / (m1 + m2) * closing
    after = before.copy()
    after[2] -= impulse / m1
    after[3] += impulse / m2
    return after
