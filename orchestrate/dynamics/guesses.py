"""Initial guesses of periodic orbits for Newton's method, from runs of the FMU or impact times."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..constants import TURN
from ..fmu import EventInstance, Impacts, begin
from ..response.questions import Point
from .closed_form import ClosedForm, Floats
from .families import ACCELERATION
from .periodic_orbit import CLOSING, IMPACT, PHASE, RELEASE, STICK, ImpactSequence, PeriodicOrbit
from .release import contact_durations
from .turning_points import rotate_to_phase_zero

Guess = tuple[ImpactSequence, Floats]


def guess_from_state(
    instance: EventInstance, point: Point, form: ClosedForm, state: Floats, periods: int
) -> Guess:
    """Run the FMU some periods from a state at phase 0; return its impacts as an orbit guess."""
    begin_at_state(instance, point, form, state)
    impacts = instance.impacts(0.0, periods * point.excitation.period)
    return guess_from_impacts(impacts, point, form, periods)


def begin_at_state(instance: EventInstance, point: Point, form: ClosedForm, state: Floats) -> None:
    """Initialise the FMU at a state at phase 0, with the constant box acceleration of ``form``."""
    constant = -float(form.offset[0] * form.stiffness[0])
    push = constant * point.excitation.amplitude * point.excitation.frequency**2
    begin(
        instance, point.structure, point.excitation, state, **({ACCELERATION: push} if push else {})
    )


def guess_from_impacts(impacts: Impacts, point: Point, form: ClosedForm, periods: int) -> Guess:
    """Return an orbit guess (sequence, nodes) from recorded impacts; add the releases between."""
    state, mu = point.faces(impacts.state), form.mu
    phase = point.excitation.frequency * impacts.time
    velocity = (state[:, 2] + mu * state[:, 3]) / (1.0 + mu)
    nodes = np.stack([phase, state[:, 0], velocity, impacts.closing / point.speed], axis=1)
    following = np.append(phase[1:], phase[:1] + TURN * periods)
    kinds: list[int] = []
    rows: list[Floats] = []
    for node, sticks, until in zip(nodes, impacts.sticks, following, strict=True):
        released = release_node(form, node, float(until)) if sticks else None
        kinds.append(IMPACT if released is None else STICK)
        rows.append(node)
        if released is not None:
            kinds.append(RELEASE)
            rows.append(released)
    ordered, first = rotate_to_phase_zero(np.array(rows).reshape(-1, 4), periods)
    return ImpactSequence(periods, tuple(kinds[first:] + kinds[:first])), ordered


def release_node(form: ClosedForm, stick: Floats, until: float) -> Floats | None:
    """Return the node of the release (19) after a sticking impact; None if not before ``until``."""
    phase, position, velocity = stick[PHASE:CLOSING, None]
    span = (until - phase) / form.eta
    duration = contact_durations(form, phase, position, velocity, span)
    if not np.isfinite(duration).all():
        return None
    motion = form.common_motion(duration, phase, position, velocity)
    return np.concatenate([phase + form.eta * duration, *motion, np.zeros(1)])


def guess_from_phases(form: ClosedForm, sequence: ImpactSequence, phases: Floats) -> Guess:
    """Return an orbit guess with impacts at given phases, its other unknowns by least squares."""
    nodes = np.zeros((len(phases), 4))
    nodes[:, PHASE] = phases
    orbit = PeriodicOrbit(sequence, form, nodes)
    others = np.arange(4 * len(phases)) % 4 != PHASE
    solution = np.linalg.lstsq(orbit.jacobian().real[:, others], -orbit.residual(), rcond=None)[0]
    nodes[:, PHASE + 1 :] = solution.reshape(-1, CLOSING)
    return sequence, nodes


def close_returns(
    instance: EventInstance,
    point: Point,
    form: ClosedForm,
    periods: int,
    transient: int,
    max_periods: int,
) -> Iterator[tuple[Floats, float]]:
    """Yield stroboscopic states that nearly repeat after some periods, the closest return first."""
    period = point.excitation.period
    begin_at_state(instance, point, form, np.zeros(4))
    instance.advance(0.0, transient * period)
    states = simulate_stroboscopic_states(instance, point, transient, max_periods)
    scale = np.maximum(np.abs(states).max(axis=0), 1e-300)
    distance = (np.abs(states[periods:] - states[:-periods]) / scale).max(axis=1)
    for i in np.argsort(distance, kind="stable"):
        yield states[i], float(distance[i])


def simulate_stroboscopic_states(
    instance: EventInstance, point: Point, first: int, count: int
) -> Floats:
    """Run the FMU on for ``count`` periods; return the states at phase 0, shape (count, 4)."""
    period = point.excitation.period
    states = np.empty((count, 4))
    for i in range(count):
        instance.advance((first + i) * period, (first + i + 1) * period)
        states[i] = instance.read("x1", "x2", "v1", "v2")
    return states
