"""Solve the oscillator by SciPy's ``solve_ivp`` with events, for comparison of speed."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from orchestrate.model import Structure

Motion = Callable[[float, np.ndarray], list[float]]
Event = Callable[[float, np.ndarray], float]
Acceleration = Callable[[float], float]
APART = 1e-12  # m, put between the masses after an impact, or it is found again
CREEP = 1e-7  # the slowest parting, over omega
SLOW = 1e-4  # closing speed below which contact begins, over omega


def rate_functions(structure: Structure, acceleration: Acceleration) -> tuple[Motion, Motion]:
    """Return functions for the rates (3) to (6) of x1, v1, x2, v2: in flight, in contact."""
    m1, m2, k1, k2, d1, d2 = (getattr(structure, n) for n in ("m1", "m2", "k1", "k2", "d1", "d2"))
    m, k, d = m1 + m2, k1 + k2, d1 + d2

    def flight(t: float, y: np.ndarray) -> list[float]:
        box = acceleration(t)
        one = -box - (d1 * y[1] + k1 * y[0]) / m1
        return [y[1], one, y[3], -box - (d2 * y[3] + k2 * y[2]) / m2]

    def contact(t: float, y: np.ndarray) -> list[float]:
        pull = -acceleration(t) - (d * y[1] + k * y[0]) / m
        return [y[1], pull, y[1], pull]

    return flight, contact


def event_functions(structure: Structure) -> tuple[Event, Event]:
    """Return functions whose roots are an impact and the end of contact (18)."""
    s = structure
    spring, damper = s.m2 * s.k1 - s.m1 * s.k2, s.m2 * s.d1 - s.m1 * s.d2

    def gap(t: float, y: np.ndarray) -> float:
        return float(y[2] - y[0])

    def pressed(t: float, y: np.ndarray) -> float:
        return float(spring * y[0] + damper * y[1])

    for event, direction in ((gap, -1), (pressed, 1)):
        event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
    return gap, pressed


def state_after_event(y: np.ndarray, touching: bool, structure: Structure) -> np.ndarray:
    """Return the state after an event: masses parted by restitution (15), or together."""
    mu, creep = structure.mu, CREEP * structure.omega
    mean = (y[1] + mu * y[3]) / (1.0 + mu)
    parting = 0.0 if touching else max(structure.restitution(y[1] - y[3]) * (y[1] - y[3]), creep)
    apart = 0.0 if touching else APART
    one = mean - mu * parting / (1.0 + mu)
    return np.array([y[0], one, y[0] + apart, one + parting])


def time_simulation_from_rest(
    structure: Structure, acceleration: Acceleration, end: float
) -> float:
    """Return the processor time, s, of a run from rest under an acceleration of the box."""
    flight, contact = rate_functions(structure, acceleration)
    gap, pressed = event_functions(structure)
    begin = time.process_time()
    t, y, touching = 0.0, np.zeros(4), True
    while t < end:
        motion, event = (contact, pressed) if touching else (flight, gap)
        solution = solve_ivp(motion, (t, end), y, events=event, rtol=1e-8, atol=1e-10)
        if not solution.t_events[0].size:
            break
        t, y = solution.t_events[0][0], solution.y_events[0][0].copy()
        slow = structure.restitution(y[1] - y[3]) * (y[1] - y[3]) < SLOW * structure.omega
        touching = not touching and slow and pressed(t, y) < 0.0
        y = state_after_event(y, touching, structure)
    return time.process_time() - begin
