"""What the masses do between the samples of a history: its smooth parts, exact by (6).

From each sample on the equations of motion are solved by Taylor series, through impacts and
releases, up to the next sample. All that is not known is the excitation between the samples,
unless its pieces are given. How far the solution is from the next sample shows the error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..lazy import xr
from ..model import Structure
from ..response.labels import states_over_time
from .analog_filter import PolynomialSignal
from .pieces import Floats, Pieces
from .record import FORCES

Flags = NDArray[np.bool_]
SHORT = 0.1  # of a cell times the highest natural frequency, rad
ORDER = 7  # derivatives of an acceleration kept: the next is below SHORT^7/7! = 2e-11 of it


@dataclass(frozen=True)
class Motion:
    """Hold a stored motion of the structure as arrays, with the parameters of its equations."""

    structure: Structure
    pieces: Pieces  # of what drives it; their time begins at the first sample
    times: Floats  # s from the first sample
    states: Floats  # x1, x2, v1, v2
    touching: Flags
    # s, N s
    impact_times: Floats
    impulses: Floats
    sticks: Flags
    drives: str = "box_acceleration"  # channel of the pieces
    steady: float = 0.0  # acceleration of the box beside them: gravity, m/s2

    @classmethod
    def from_history(
        cls, history: xr.Dataset, structure: Structure, pieces: Pieces, drives: str
    ) -> Motion:
        """Take the motion from a result of :func:`.shake.shake`."""
        begin, end = float(history.time[0]), float(history.time[-1])
        struck = history.impact_time.values
        kept = (struck > begin) & (struck <= end)  # of a part of a history others too are there
        return cls(
            structure,
            pieces,
            history.time.values - begin,
            states_over_time(history),
            history.in_contact.values.astype(bool),
            struck[kept] - begin,
            history.impulse.values[kept],
            history.sticks.values.astype(bool)[kept],
            drives,
            steady_box_acceleration(history),
        )

    def _driving_series(self, channel: str, times: Floats) -> Floats:
        """Compute a channel of the excitation and its derivatives, shape (ORDER, n)."""
        derivatives = np.zeros((ORDER, len(times)))
        if channel == self.drives:
            derivatives[:4] = self.pieces.derivatives_at(times).T
        return derivatives

    def displacement_series(self, states: Floats, touching: Flags, times: Floats) -> Floats:
        """Compute displacements and their derivatives, shape (ORDER + 2, 2, n), by (6)."""
        series = np.empty((ORDER + 2, 2, len(times)))
        series[:2] = states.T.reshape(2, 2, -1)
        box, forces = self.box_series(times), self.force_series(times)
        for n in range(ORDER):
            accelerations = self.mass_accelerations(series[n], series[n + 1], touching, forces[n])
            series[n + 2] = accelerations - box[n]
        return series

    def box_series(self, times: Floats) -> Floats:
        """Compute the box's acceleration and its derivatives, shape (ORDER, n)."""
        derivatives = self._driving_series("box_acceleration", times)
        derivatives[0] += self.steady
        return derivatives

    def force_series(self, times: Floats) -> Floats:
        """Compute the forces on both masses and their derivatives, shape (ORDER, 2, n)."""
        return np.stack([self._driving_series(name, times) for name in FORCES], axis=1)

    def mass_accelerations(
        self, x: Floats, v: Floats, touching: Flags, forces: ArrayLike = 0.0
    ) -> Floats:
        """Compute the masses' accelerations by (6), or derivatives of them, shape (2, n)."""
        s = self.structure
        springs = np.array([s.k1 * x[0] + s.d1 * v[0], s.k2 * x[1] + s.d2 * v[1]])
        loads = np.asarray(forces) - springs
        both = (loads[0] + loads[1]) / (s.m1 + s.m2)
        return np.where(touching, both, np.stack([loads[0] / s.m1, loads[1] / s.m2]))

    def states_after(
        self, states: Floats, touching: Flags, begins: Floats, durations: Floats
    ) -> Floats:
        """Compute the states after durations, shape (n, 4), each by one Taylor series."""
        series = self.displacement_series(states, touching, begins)
        parts = series, series[1:]
        return np.concatenate([evaluate_taylor(part, durations) for part in parts]).T

    def step_count(self, length: float) -> int:
        """Return the number of equal steps in which Taylor series cover a length of time."""
        s = self.structure
        alone = [(s.m1, s.k1, s.d1), (s.m2, s.k2, s.d2)]
        fastest = max(max(math.sqrt(k / m), d / m) for m, k, d in alone)
        return max(1, math.ceil(fastest * length / SHORT))

    def release_times(self) -> Floats:
        """Compute when permanent contacts end, s: first roots of the contact force (18)."""
        if self.structure.bonded:
            return np.empty(0)
        times = np.concatenate([self.times, self.impact_times])
        touch = np.concatenate([self.touching, self.sticks])
        before = np.concatenate([self.touching, np.zeros(len(self.sticks), bool)])
        hit = np.arange(len(times)) >= len(self.times)
        order = np.lexsort([~hit, times])  # a sample at an impact is after it
        ends = np.flatnonzero(touch[order[:-1]] & ~before[order[1:]])
        return np.array([self._release_time(times[order[i]], times[order[i + 1]]) for i in ends])

    def _release_time(self, begin: float, end: float) -> float:
        """Return when the contact force first falls below 0, s; ``begin`` if it does not."""
        state = self._state_at(begin)
        touching = np.array([True])
        mesh = np.linspace(begin, end, 1 + self.step_count(end - begin))
        nodes = self.pieces.nodes
        mesh = np.union1d(mesh, nodes[(nodes > begin) & (nodes < end)])
        for start, stop in zip(mesh[:-1], mesh[1:], strict=True):
            series = self.displacement_series(state, touching, np.array([start]))[:, :, 0]
            forces = self.force_series(np.array([start]))[:, :, 0]
            force, scale = self._contact_force_and_scale(series, forces)
            root = first_time_below_zero(force, scale, stop - start)
            if root is not None:
                return float(start + root)
            state = self.states_after(state, touching, np.array([start]), np.array([stop - start]))
        return float(begin)

    def _state_at(self, time: float) -> Floats:
        """Return the state at a sample, or after an impact; shape (1, 4)."""
        index = int(np.searchsorted(self.times, time, side="right")) - 1
        now, state = float(self.times[index]), self.states[index : index + 1]
        touching = self.touching[index : index + 1]
        inside = (self.impact_times > now) & (self.impact_times <= time)
        for i in np.flatnonzero(inside):
            count = self.step_count(float(self.times[1]))
            mesh = np.linspace(now, self.impact_times[i], 1 + count)
            for start, stop in zip(mesh[:-1], mesh[1:], strict=True):
                at, length = np.array([start]), np.array([stop - start])
                state = self.states_after(state, touching, at, length)
            state, touching = self.after_impulses(state, self.impulses[[i]]), self.sticks[[i]]
            now = float(self.impact_times[i])
        return state

    def after_impulses(self, states: Floats, impulses: Floats) -> Floats:
        """Return copies of states after impulses (15), which push mass 1 back and mass 2 on."""
        after = states.copy()
        after[:, 2] -= impulses / self.structure.m1
        after[:, 3] += impulses / self.structure.m2
        return after

    def _contact_force_and_scale(self, series: Floats, forces: Floats) -> tuple[Floats, float]:
        """Compute the contact force (18) and its derivatives, and the scale of its terms."""
        s = self.structure
        own = s.k1 * series[:-2, 0] + s.d1 * series[1:-1, 0] - forces[:, 0]
        other = s.k2 * series[:-2, 1] + s.d2 * series[1:-1, 1] - forces[:, 1]
        force: Floats = (s.m1 * other - s.m2 * own) / (s.m1 + s.m2)
        return force, abs(float(own[0])) + abs(float(other[0]))


def steady_box_acceleration(history: xr.Dataset) -> float:
    """Return the constant part of a history's box acceleration, m/s2: gravity."""
    return float(history.attrs.get("box_acceleration", 0.0))


def evaluate_taylor(series: Floats, lengths: Floats) -> Floats:
    """Evaluate Taylor series of two motions at n times after expansion; return shape (2, n)."""
    values = np.zeros(series.shape[1:])
    for n in range(len(series) - 1, -1, -1):
        values = series[n] + values * lengths / (n + 1)
    return values


def first_time_below_zero(derivatives: Floats, scale: float, length: float) -> float | None:
    """Return the first time in [0, length] at which a Taylor series falls below 0, or None."""
    from scipy.optimize import brentq

    factors = derivatives / np.array([math.factorial(n) for n in range(len(derivatives))])
    series = np.polynomial.Polynomial(factors)
    mesh = np.linspace(0.0, length, 1 + 16)
    below = np.flatnonzero(series(mesh) < -1e-13 * scale)
    if not len(below):
        return None
    last = int(below[0])
    if last == 0 or series(mesh[last - 1]) <= 0.0:
        return float(mesh[max(last - 1, 0)])
    return float(brentq(series, mesh[last - 1], mesh[last], xtol=1e-15 * length, rtol=1e-14))


@dataclass(frozen=True)
class SmoothAccelerations:
    """Hold the accelerations of box and masses without gravity and the impulses of impacts."""

    times: Floats  # of the record, s
    drive: PolynomialSignal  # what moves the box, m/s2, or a half, N
    mass1: PolynomialSignal
    mass2: PolynomialSignal
    error: float  # largest distance of a mass's acceleration from the history's next sample, m/s2


def solve_smooth_accelerations(motion: Motion, sample_rate: float) -> SmoothAccelerations:
    """Solve the equations of motion between the samples; return the smooth accelerations."""
    steps = math.floor(float(motion.times[-1]) * sample_rate * (1.0 + 1e-14))
    parts = motion.step_count(1.0 / sample_rate)
    grid = np.arange(steps * parts + 1) / (sample_rate * parts)
    grid = grid[grid <= motion.times[-1]]
    times = grid[::parts]
    releases = motion.release_times()
    event_times = [motion.times, motion.impact_times, releases, motion.pieces.nodes]
    nodes = np.unique(np.concatenate([*event_times, grid]))
    nodes = nodes[(nodes >= 0.0) & (nodes <= times[-1])]
    starts = nodes[:-1]
    states, touching, error = integrate_between_samples(motion, nodes, releases)
    drive = PolynomialSignal(starts, nodes[1:], motion.pieces.derivatives_at(starts))
    series = motion.displacement_series(states, touching, starts)
    forces = [*motion.force_series(starts), 0.0]  # no derivative of the last order
    rows = zip(series[:-1], series[1:], forces, strict=True)
    felt = np.stack([motion.mass_accelerations(x, v, touching, force) for x, v, force in rows])
    felt[0] -= motion.steady
    one, two = (PolynomialSignal(starts, nodes[1:], felt[:, i].T) for i in (0, 1))
    return SmoothAccelerations(times, drive, one, two, error)


def integrate_between_samples(
    motion: Motion, nodes: Floats, releases: Floats
) -> tuple[Floats, Flags, float]:
    """Integrate from sample to sample; return states, contact, and the distance to the samples."""
    count = len(nodes) - 1
    interval = np.searchsorted(motion.times, nodes[:-1], side="right") - 1
    first = np.searchsorted(interval, np.arange(len(motion.times)))
    rank = np.arange(count) - first[interval]
    impulses = np.zeros(count + 1)
    places = np.searchsorted(nodes, motion.impact_times)
    known = places <= count
    np.add.at(impulses, places[known], motion.impulses[known])
    begins, ends = np.zeros(count + 1, bool), np.zeros(count + 1, bool)
    begins[places[known & motion.sticks]] = True
    ends[np.searchsorted(nodes, releases[releases <= nodes[-1]])] = True
    states, touching = motion.states[interval], motion.touching[interval] & ~ends[:-1]
    order = np.argsort(rank, kind="stable")
    bounds = np.searchsorted(rank[order], np.arange(1, rank.max() + 2))
    lengths = np.diff(nodes)
    for low, high in zip(bounds[:-1], bounds[1:], strict=True):
        now = order[low:high]
        last = now - 1
        moved = motion.states_after(states[last], touching[last], nodes[last], lengths[last])
        states[now] = motion.after_impulses(moved, impulses[now])
        touching[now] = (touching[last] | begins[now]) & ~ends[now]
    last = np.append(np.flatnonzero(rank == 0)[1:] - 1, count - 1)
    moved = motion.states_after(states[last], touching[last], nodes[last], lengths[last])
    moved = motion.after_impulses(moved, impulses[last + 1])
    target = np.searchsorted(motion.times, nodes[last + 1])
    exact = np.append(motion.times, np.inf)[target] == nodes[last + 1]
    samples = target[exact]
    x, v = (moved[exact] - motion.states[samples]).T.reshape(2, 2, -1)
    accelerations = motion.mass_accelerations(x, v, motion.touching[samples])
    return states, touching, float(np.abs(accelerations).max(initial=0.0))
