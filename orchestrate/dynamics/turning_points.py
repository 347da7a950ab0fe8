"""Extrema of displacements and gap along an orbit: amplitudes, near misses, stroboscopic states."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from .closed_form import OUTER, Floats
from .periodic_orbit import PHASE, ImpactSequence, PeriodicOrbit

XI_1, XI_2, GAP = range(3)  # quantities that turn, as weights of the two masses
WEIGHTS = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 1.0]])


@dataclass(frozen=True)
class TurningPoints:
    """Extrema of both displacements and the gap inside an orbit's segments, as arrays."""

    segment: NDArray[np.int_]
    quantity: NDArray[np.int_]
    phase: Floats  # rad
    value: Floats
    curvature: Floats  # second derivative of the quantity by tau


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
    spans = orbit.end_phases - orbit.begin_phases
    return segment, orbit.begin_phases[segment] + part * spans[segment]


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
    motion = partial(rate_curvature_and_value, orbit, segment, quantity)
    phases = low + (high - low) * first / (first - last)
    phases = refine_zeros(lambda phase: motion(phase)[:2], phases, (low, high), orbit.form.eta)
    _, curvature, value = motion(phases)
    return TurningPoints(segment, quantity, phases, value, curvature)


def refine_zeros(
    rate_and_slope: Callable[[Floats], Sequence[Floats]],
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


def amplitudes(
    orbit: PeriodicOrbit, turns: TurningPoints | None = None
) -> tuple[float, float, float]:
    """Return the largest distance of both masses and the largest gap over an orbit, in xi."""
    turns = turns or turning_points(orbit)
    origins = np.array([0.0, orbit.form.gap_offset, 0.0])  # of unloaded springs, and no gap
    ends = np.abs(orbit.end_states[:, :2] - origins[:2]).max(axis=0)
    xi_1, xi_2, gap = (
        np.abs(turns.value[turns.quantity == which] - origins[which]).max(initial=0.0)
        for which in (XI_1, XI_2, GAP)
    )
    if orbit.sequence.outer.any() or (orbit.modes == OUTER).any():
        gap = orbit.form.limit
    return max(ends[0], xi_1), max(ends[1], xi_2), float(gap)


def nearest_miss(
    orbit: PeriodicOrbit, turns: TurningPoints | None = None
) -> tuple[float, int, float]:
    """Return the smallest gap to an end in flights without a strike (inf: none), segment, phase."""
    turns = turns or turning_points(orbit)
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
    pressure = partial(contact_pressure_and_derivatives, orbit, segment)
    middle = 0.5 * (low + high)
    phases = refine_zeros(lambda at: pressure(at)[1:], middle, (low, high), orbit.form.eta)
    forces = pressure(phases)[0]
    lowest = forces.argmin()
    return float(forces[lowest]), int(segment[lowest]), float(phases[lowest])


def contact_pressure_and_derivatives(
    orbit: PeriodicOrbit, segment: NDArray[np.int_], phase: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the contact pressure -f (18) and its first two tau derivatives, at phases."""
    form, outer = orbit.form, orbit.modes[segment] == OUTER
    state, rates = orbit.states_and_rates(segment, phase)
    position, velocity, acceleration = state[:, 0], state[:, 2], rates[:, 2]
    jerk = form.drive[2] * form.eta * np.cos(phase) - 2.0 * form.damping[2] * acceleration
    jerk -= form.stiffness[2] * velocity
    first = form.motion_part_of_contact_force(velocity, acceleration, outer)
    first = first + form.eta * form.harmonic_part_of_force(phase + 0.5 * np.pi, outer)
    second = form.motion_part_of_contact_force(acceleration, jerk, outer)
    second = second - form.eta**2 * form.harmonic_part_of_force(phase, outer)
    return -form.contact_force(phase, position, velocity, outer), -first, -second


def stroboscopic_states(orbit: PeriodicOrbit, phase: float = 0.0) -> Floats:
    """Return an orbit's states at one phase in successive periods, shape (periods, 4)."""
    periods, begin = orbit.sequence.periods, orbit.begin_phases[0]
    wanted = phase + TURN * np.arange(periods)
    shifted = begin + np.mod(wanted - begin, TURN * periods)
    segment = np.searchsorted(orbit.begin_phases, shifted, side="right") - 1
    return orbit.states(segment, shifted)


def rotate_to_phase_zero(sequence: ImpactSequence, nodes: Floats) -> tuple[ImpactSequence, Floats]:
    """Return an orbit's impacts and nodes in their order from phase 0 on."""
    phase = np.mod(nodes[:, PHASE], TURN * sequence.periods)
    first = int(phase.argmin()) if len(nodes) else 0
    ordered = np.roll(nodes, -first, axis=0)
    ordered[:, PHASE] = np.roll(phase, -first)
    kinds = (*sequence.kinds[first:], *sequence.kinds[:first])
    return ImpactSequence(sequence.periods, kinds), ordered
