"""Where Newton's method begins: sequences of impacts of the FMU, and close returns."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..access import EventInstance, Impacts, begin
from ..constants import TURN
from ..response.questions import Point
from .closed_form import ClosedForm, Floats
from .families import ACCELERATION
from .periodic_orbit import CLOSING, IMPACT, PHASE, RELEASE, STICK, ImpactSequence, PeriodicOrbit
from .release import contact_durations
from .turning_points import from_phase_zero

Guess = tuple[ImpactSequence, Floats]


def from_state(
    instance: EventInstance, point: Point, form: ClosedForm, state: Floats, periods: int
) -> Guess:
    """Return the sequence that the FMU runs through from a state at phase 0.

    Parameters
    ----------
    instance : EventInstance
    point : Point
    form : ClosedForm
        Of the same structure and excitation.
    state : ndarray, shape (4,)
        x1, x2 in m, v1, v2 in m/s.
    periods : int
    """
    start(instance, point, form, state)
    impacts = instance.impacts(0.0, periods * point.excitation.period)
    return from_impacts(impacts, point, form, periods)


def start(instance: EventInstance, point: Point, form: ClosedForm, state: Floats) -> None:
    """Begin at a state at phase 0."""
    constant = -float(form.offset[0] * form.stiffness[0])
    push = constant * point.excitation.amplitude * point.excitation.frequency**2
    begin(
        instance, point.structure, point.excitation, state, **({ACCELERATION: push} if push else {})
    )


def from_impacts(impacts: Impacts, point: Point, form: ClosedForm, periods: int) -> Guess:
    """Return the nodes of impacts, with the releases between them."""
    state, mu = point.faces(impacts.state), form.mu
    phase = point.excitation.frequency * impacts.time
    velocity = (state[:, 2] + mu * state[:, 3]) / (1.0 + mu)
    nodes = np.stack([phase, state[:, 0], velocity, impacts.closing / point.speed], axis=1)
    following = np.append(phase[1:], phase[:1] + TURN * periods)
    kinds: list[int] = []
    rows: list[Floats] = []
    for node, sticks, until in zip(nodes, impacts.sticks, following, strict=True):
        released = release(form, node, float(until)) if sticks else None
        kinds.append(IMPACT if released is None else STICK)
        rows.append(node)
        if released is not None:
            kinds.append(RELEASE)
            rows.append(released)
    ordered, first = from_phase_zero(np.array(rows).reshape(-1, 4), periods)
    return ImpactSequence(periods, tuple(kinds[first:] + kinds[:first])), ordered


def release(form: ClosedForm, stick: Floats, until: float) -> Floats | None:
    """Return the node where permanent contact ends (19), before a phase; None where it does not."""
    phase, position, velocity = stick[PHASE:CLOSING, None]
    span = (until - phase) / form.eta
    duration = contact_durations(form, phase, position, velocity, span)
    if not np.isfinite(duration).all():
        return None
    motion = form.common_motion(duration, phase, position, velocity)
    return np.concatenate([phase + form.eta * duration, *motion, np.zeros(1)])


def from_phases(form: ClosedForm, sequence: ImpactSequence, phases: Floats) -> Guess:
    """Return nodes at given phases that solve the other equations, which are linear, best."""
    nodes = np.zeros((len(phases), 4))
    nodes[:, PHASE] = phases
    orbit = PeriodicOrbit(sequence, form, nodes)
    others = np.arange(4 * len(phases)) % 4 != PHASE
    found = np.linalg.lstsq(orbit.jacobian().real[:, others], -orbit.residual(), rcond=None)[0]
    nodes[:, PHASE + 1 :] = found.reshape(-1, CLOSING)
    return sequence, nodes


def close_returns(
    instance: EventInstance, point: Point, form: ClosedForm, periods: int, transient: int, most: int
) -> Iterator[tuple[Floats, float]]:
    """Yield states of the response from rest that come back after some periods, closest first.

    Parameters
    ----------
    instance : EventInstance
    point, form
        What responds.
    periods : int
        After which they come back.
    transient, most : int
        Periods dropped, and searched.

    Yields
    ------
    state : ndarray, shape (4,)
        x1, x2 in m, v1, v2 in m/s.
    distance : float
        Largest deviation of a co-ordinate, over its largest absolute value.
    """
    period = point.excitation.period
    start(instance, point, form, np.zeros(4))
    instance.advance(0.0, transient * period)
    states = stroboscopic_states(instance, point, transient, most)
    scale = np.maximum(np.abs(states).max(axis=0), 1e-300)
    distance = (np.abs(states[periods:] - states[:-periods]) / scale).max(axis=1)
    for i in np.argsort(distance, kind="stable"):
        yield states[i], float(distance[i])


def stroboscopic_states(instance: EventInstance, point: Point, first: int, count: int) -> Floats:
    """Return states at phase 0 of successive periods, shape (count, 4)."""
    period = point.excitation.period
    states = np.empty((count, 4))
    for i in range(count):
        instance.advance((first + i) * period, (first + i + 1) * period)
        states[i] = instance.read("x1", "x2", "v1", "v2")
    return states
