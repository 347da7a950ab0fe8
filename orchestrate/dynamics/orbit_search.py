"""Solve for periodic orbits by Newton's method from guesses, and run them in the FMU as a check."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from ..constants import TURN
from ..fmu import EventInstance, Impacts, start_motion
from ..response.questions import Point
from .closed_form import INNER, OUTER, ClosedForm, Floats
from .continuation import SOLVER_ERRORS, NoConvergenceError, Root, newton_correct, unit_vector
from .families import Family, Setting
from .periodic_orbit import (
    AT_OUTER_END,
    CLOSING,
    IMPACT,
    PHASE,
    RELEASE,
    STICK,
    ImpactSequence,
    PeriodicOrbit,
)
from .turning_points import nearest_miss, rotate_to_phase_zero, stroboscopic_states, weakest_force
from .variational import contact_durations

Guess = tuple[ImpactSequence, Floats]


def simulate_guess(
    instance: EventInstance, point: Point, form: ClosedForm, state: Floats, periods: int
) -> Guess:
    """Run the FMU from a state at phase 0 over some periods; return an orbit guess of them."""
    start_motion(instance, *point, state)
    impacts = instance.record_impacts(0.0, periods * point.excitation.period)
    return guess_from_impacts(impacts, point, form, periods)


def guess_from_impacts(impacts: Impacts, point: Point, form: ClosedForm, periods: int) -> Guess:
    """Return an orbit guess (sequence, nodes) from recorded impacts; add the releases between."""
    state = point.faces_from_states(impacts.state)
    phase = point.excitation.frequency * impacts.time
    velocity = state[:, 2:] @ form.shares
    ends = AT_OUTER_END * (2.0 * (state[:, 1] - state[:, 0]) > form.limit)
    nodes = np.stack([phase, state[:, 0], velocity, impacts.closing / point.velocity_unit], axis=1)
    following = np.append(phase[1:], phase[:1] + TURN * periods)
    kinds: list[int] = []
    rows: list[Floats] = []
    for node, end, sticks, until in zip(nodes, ends, impacts.sticks, following, strict=True):
        released = release_node(form, node, float(until), end > 0) if sticks else None
        kinds.append(int(end) + (IMPACT if released is None else STICK))
        rows.append(node)
        if released is not None:
            kinds.append(int(end) + RELEASE)
            rows.append(released)
    sequence = ImpactSequence(periods, tuple(kinds))
    return rotate_to_phase_zero(sequence, np.array(rows).reshape(-1, 4))


def release_node(form: ClosedForm, stick: Floats, until: float, outer: bool) -> Floats | None:
    """Return the node of the release (19) after a sticking impact; None if not before ``until``."""
    phase, position, velocity = stick[PHASE:CLOSING, None]
    span = (until - phase) / form.eta
    end = np.array([outer])
    start = np.column_stack([position, position + form.gap_at_end(end), velocity, velocity])
    duration = contact_durations(form, phase, start, span)
    if not np.isfinite(duration).all():
        return None
    mode, released = np.where(end, OUTER, INNER), phase + form.eta * duration
    free = start - form.steady_response(phase, mode)
    state = form.flow_matrices(duration, mode)[0] @ free[0]
    state = state + form.steady_response(released, mode)[0]
    return np.array([float(released[0]), state[0], state[2], 0.0])


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
    instance: EventInstance, point: Point, periods: int, transient: int, max_periods: int
) -> Iterator[tuple[Floats, float]]:
    """Yield stroboscopic states that nearly repeat after some periods, the closest return first."""
    period = point.excitation.period
    start_motion(instance, *point, np.zeros(4))
    instance.record_impacts(0.0, transient * period)
    states = np.empty((max_periods, 4))
    for i, state in enumerate(states):
        instance.record_impacts((transient + i) * period, (transient + i + 1) * period)
        state[:] = instance.read("x1", "x2", "v1", "v2")
    scale = np.maximum(np.abs(states).max(axis=0), 1e-300)
    distance = (np.abs(states[periods:] - states[:-periods]) / scale).max(axis=1)
    for i in np.argsort(distance, kind="stable"):
        yield states[i], float(distance[i])


def solve_orbit(
    setting: Setting,
    guess: Guess,
    values: Floats,
    *,
    max_iterations: int = 25,
    max_distance: float = 100.0,
) -> tuple[Family, Root]:
    """Solve by Newton's method for the orbit at fixed parameters near a guess."""
    sequence, nodes = guess
    family = Family.from_nodes(setting, sequence, nodes)
    unknowns = np.append(nodes.ravel(), values)
    normal = unit_vector(len(unknowns), family.node_unknowns)
    fixed = Family(setting, sequence, family.scale, fixed=True)
    return family, newton_correct(
        fixed, unknowns, normal, max_iterations=max_iterations, max_distance=max_distance
    )


def why_no_motion(orbit: PeriodicOrbit) -> str:
    """Return why a solved orbit is no possible motion (masses overlap ...); empty if it is one."""
    if (orbit.durations <= 0.0).any():
        return "its impacts are out of order"
    if not (orbit.nodes[~orbit.sequence.releases, CLOSING] > 0.0).all():
        return "an impact has no closing speed"
    if nearest_miss(orbit)[0] < 0.0:
        return "the masses would go through each other"
    if weakest_force(orbit)[0] < 0.0:
        return "the contact would pull"
    return ""


def least_periods(orbit: PeriodicOrbit, within: float = 1e-6) -> int:
    """Return the orbit's least period in excitation periods, by comparing shifted nodes."""
    periods, count = orbit.sequence.periods, orbit.node_count
    kinds, span = np.array(orbit.sequence.kinds), TURN * orbit.sequence.periods
    size = float(np.abs(orbit.nodes[:, 1:]).max(initial=0.0)) or 1.0
    for part in range(1, periods):
        if periods % part or count * part % periods:
            continue
        shift = count * part // periods
        away = np.roll(orbit.nodes, -shift, axis=0) - orbit.nodes
        away[:, PHASE] -= TURN * part
        away[:, PHASE] -= span * np.round(away[:, PHASE] / span)
        away[:, 1:] /= size
        same = (np.roll(kinds, -shift) == kinds).all()
        if same and np.abs(away).max(initial=0.0) < within:
            return part
    return periods


def compare_with_fmu(
    instance: EventInstance, setting: Setting, values: Floats, orbit: PeriodicOrbit
) -> tuple[bool, float]:
    """Run an orbit's period in the FMU; return whether impacts are the same, and the return's miss.

    The miss is how far from its first state the FMU returns, over a eta^2.
    """
    point = setting.point(values)
    state = stroboscopic_states(orbit)[0]
    start_motion(instance, *point, point.states_from_faces(state))
    end = orbit.sequence.periods * point.excitation.period
    observed = instance.record_impacts(0.0, end)
    after = point.faces_from_states(instance.read("x1", "x2", "v1", "v2"))
    away = float(np.abs(after - state).max())
    sequence, nodes = rotate_to_phase_zero(orbit.sequence, orbit.nodes)
    is_expected, is_observed = ~sequence.releases, np.ones(len(observed.time), dtype=bool)
    if is_observed.sum() != is_expected.sum():
        # of the motion's speed the square root of a gap's rounding is 1e-8
        grazing = 1e-6 * float(np.abs(orbit.end_states[:, 2:]).max())
        is_observed = observed.closing / point.velocity_unit > grazing
        is_expected &= nodes[:, CLOSING] > grazing
    if is_observed.sum() != is_expected.sum():
        return False, away
    phases = point.excitation.frequency * observed.time[is_observed]
    near = np.abs(phases - nodes[is_expected, PHASE]).max(initial=0.0) < 1e-6  # rad
    sticks = sequence.sticks[is_expected]
    return bool(near and (observed.sticks[is_observed] == sticks).all()), away


def first_possible_orbit(
    setting: Setting, guesses: Iterable[Guess], values: Floats, *, prefer_stable: bool = False
) -> tuple[Family, Root]:
    """Return the first orbit of the guesses that is a possible motion, of full period.

    With ``prefer_stable`` the first stable one, if there is any.
    """
    reason, unstable = "", None
    for guess in guesses:
        try:
            family, root = solve_orbit(setting, guess, values)
        except SOLVER_ERRORS as error:
            reason = reason or str(error)
            continue
        orbit = family.orbit(root.unknowns)
        why = why_no_motion(orbit)
        if not why and least_periods(orbit) < guess[0].periods:
            why = f"the orbit found repeats after {least_periods(orbit)} already"
        if not why and (not prefer_stable or orbit.stable):
            return family, root
        unstable = unstable or (None if why else (family, root))
        reason = reason or why
    if unstable:
        return unstable
    raise NoConvergenceError(reason or "there is no impact to begin with")


def single_impact_guesses(form: ClosedForm, periods: int) -> Iterator[Guess]:
    """Yield orbit guesses with a single impact at an end, at phases spaced around the circle."""
    for kind in (IMPACT, IMPACT + AT_OUTER_END)[: 1 + (form.limit < np.inf)]:
        sequence = ImpactSequence(periods, (kind,))
        for phase in np.arange(24) * TURN / 24:
            yield guess_from_phases(form, sequence, np.array([phase]))
