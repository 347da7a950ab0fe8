"""Extrema of displacements and gap along an orbit: amplitudes, near misses, stroboscopic states."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from .closed_form import OUTER, Floats
from .periodic_orbit import PHASE, PeriodicOrbit

XI_1, XI_2, GAP = range(3)  # quantities that turn, as weights of the two masses
WEIGHTS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 1.0]])


@dataclass(frozen=True)
class TurningPoints:
    """Extrema of both displacements and the gap inside an orbit's segments, as arrays."""

    segment: NDArray[np.int_]
    quantity: NDArray[np.int_]
    # phase in rad; value and second derivative of the quantity by tau
    phase: Floats
    value: Floats
    curvature: Floats


def sample_grid(orbit: PeriodicOrbit) -> tuple[NDArray[np.int_], Floats]:
    """Return segment indices and phases of a fine sampling grid along an orbit."""
    counts = 8 + np.ceil(  # of the fastest oscillation 24: extrema lie further apart
        24 * np.abs(orbit.durations) * orbit.form.highest_frequency / TURN
    ).astype(int)
    segment = np.repeat(np.arange(len(counts)), counts)
    number_in_segment = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    part = (number_in_segment + 0.5) / counts[segment]
    if not orbit.node_count:  # a segment that closes: once around, and to the first sample again
        segment, part = np.append(segment, 0), np.append(part, part[0] + 1.0)
    return segment, orbit.begin_phases[segment] + part * (orbit.end_phases - orbit.begin_phases)[
        segment
    ]


def turning_points(orbit: PeriodicOrbit) -> TurningPoints:
    """Return all extrema of both displacements and, in flight, of the gap, by Newton's method."""
    segment, phase = sample_grid(orbit)
    rates = orbit.states(segment, phase)[:, 2:] @ WEIGHTS.T
    same = segment[1:] == segment[:-1]
    turns = (np.sign(rates[1:]) != np.sign(rates[:-1])) & same[:, None]
    turns[:, GAP] &= ~orbit.in_contact[segment[1:]]
    which, quantity = np.nonzero(turns)
    low, high, segment = phase[which], phase[which + 1], segment[which]
    first, last = rates[which, quantity], rates[which + 1, quantity]
    phases = low + (high - low) * first / (first - last)

    def rate_and_slope(phase: Floats) -> tuple[Floats, Floats]:
        return rate_curvature_and_value(orbit, segment, quantity, phase)[:2]

    phases = refine_zeros(rate_and_slope, phases, (low, high), orbit.form.eta)
    _, curvature, value = rate_curvature_and_value(orbit, segment, quantity, phases)
    return TurningPoints(segment, quantity, phases, value, curvature)


def refine_zeros(
    rate_and_slope: Callable[[Floats], tuple[Floats, Floats]],
    phases: Floats,
    brackets: tuple[Floats, Floats],
    eta: float,
) -> Floats:
    """Refine phases, rad, of zeros of rates by Newton's method within their brackets."""
    for _ in range(6):  # each doubles the digits
        rate, slope = rate_and_slope(phases)
        step = np.divide(rate, slope, out=np.zeros_like(rate), where=slope != 0.0)
        phases = np.clip(phases - eta * step, *brackets)
    return phases


def rate_curvature_and_value(
    orbit: PeriodicOrbit, segment: NDArray[np.int_], quantity: NDArray[np.int_], phase: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return first and second tau derivatives, and values, of displacements or the gap."""
    state, field = orbit.states_and_rates(segment, phase)
    weights = WEIGHTS[quantity]
    rate, curvature = (weights * field[:, :2]).sum(axis=1), (weights * field[:, 2:]).sum(axis=1)
    return rate, curvature, (weights * state[:, :2]).sum(axis=1)


@dataclass(frozen=True)
class Amplitudes:
    """Largest displacements of both masses and largest gap over an orbit, in units of a eta^2."""

    # largest absolute displacement of each mass
    xi_1: float
    xi_2: float
    gap: float  # largest gap

    @classmethod
    def from_orbit(cls, orbit: PeriodicOrbit, turns: TurningPoints) -> Amplitudes:
        origins = np.array([0.0, orbit.form.gap_offset, 0.0])  # of unloaded springs, and no gap
        ends = np.abs(orbit.end_states[:, :2] - origins[:2]).max(axis=0)
        inside = [
            np.abs(turns.value[turns.quantity == which] - origins[which]) for which in range(3)
        ]
        largest = [max(values, default=0.0) for values in inside]
        reaches = orbit.sequence.outer.any() or (orbit.modes == OUTER).any()
        gap = orbit.form.limit if reaches else float(largest[GAP])
        return cls(max(ends[0], largest[0]), max(ends[1], largest[1]), gap)


def nearest_miss(orbit: PeriodicOrbit, turns: TurningPoints) -> tuple[float, int, float]:
    """Return the smallest gap to an end in flights without a strike (inf: none), segment, phase."""
    inner = np.where(turns.curvature > 0.0, turns.value, np.inf)
    room = np.where(turns.curvature < 0.0, orbit.form.limit - turns.value, inner)
    room[turns.quantity != GAP] = np.inf
    nearest = int(room.argmin()) if len(room) else -1
    if nearest < 0 or room[nearest] == np.inf:
        return np.inf, -1, 0.0
    return float(room[nearest]), int(turns.segment[nearest]), float(turns.phase[nearest])


def weakest_force(orbit: PeriodicOrbit) -> tuple[float, int, float]:
    """Return the smallest minimum of the contact pressure -f, with its segment and phase."""
    if not orbit.in_contact.any():
        return np.inf, -1, 0.0
    segment, phase = sample_grid(orbit)
    inside = orbit.in_contact[segment]
    segment, phase = segment[inside], phase[inside]
    rate = contact_pressure_and_derivatives(orbit, segment, phase)[1]
    turns = (rate[1:] > 0.0) & (rate[:-1] <= 0.0) & (segment[1:] == segment[:-1])
    if not turns.any():
        return np.inf, -1, 0.0
    low, high, segment = phase[:-1][turns], phase[1:][turns], segment[1:][turns]

    def rate_and_slope(phase: Floats) -> tuple[Floats, Floats]:
        return contact_pressure_and_derivatives(orbit, segment, phase)[1:]

    phases = refine_zeros(rate_and_slope, 0.5 * (low + high), (low, high), orbit.form.eta)
    forces = contact_pressure_and_derivatives(orbit, segment, phases)[0]
    lowest = forces.argmin()
    return float(forces[lowest]), int(segment[lowest]), float(phases[lowest])


def contact_pressure_and_derivatives(
    orbit: PeriodicOrbit, segment: NDArray[np.int_], phase: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the contact pressure -f (18) and its first two tau derivatives, at phases."""
    form, modes, (state, rates) = (
        orbit.form,
        orbit.modes[segment],
        orbit.states_and_rates(segment, phase),
    )
    outer = modes == OUTER
    position, velocity = state[:, 0], state[:, 2]
    acceleration = rates[:, 2]
    jerk = form.drive[2] * form.eta * np.cos(phase) - 2.0 * form.damping[2] * acceleration
    jerk -= form.stiffness[2] * velocity
    first = form.motion_part_of_contact_force(velocity, acceleration, outer)
    first = first + form.eta * form.harmonic_part_of_force(phase + 0.5 * np.pi, outer)
    second = form.motion_part_of_contact_force(
        acceleration, jerk, outer
    ) - form.eta**2 * form.harmonic_part_of_force(phase, outer)
    return -form.contact_force(phase, position, velocity, outer), -first, -second


def stroboscopic_states(orbit: PeriodicOrbit, phase: float = 0.0) -> Floats:
    """Return an orbit's states at one phase in successive periods, shape (periods, 4)."""
    periods, begin = orbit.sequence.periods, orbit.begin_phases[0]
    wanted = phase + TURN * np.arange(periods)
    shifted = begin + np.mod(wanted - begin, TURN * periods)
    segment = np.searchsorted(orbit.begin_phases, shifted, side="right") - 1
    return orbit.states(segment, shifted)


def rotate_to_phase_zero(nodes: Floats, periods: int) -> tuple[Floats, int]:
    """Reorder nodes to begin at phase 0; return them, and the old index of the first one."""
    phase = np.mod(nodes[:, PHASE], TURN * periods)
    first = int(phase.argmin()) if len(nodes) else 0
    ordered = np.roll(nodes, -first, axis=0)
    if len(nodes):
        ordered[:, PHASE] = np.roll(phase, -first)
    return ordered, first
