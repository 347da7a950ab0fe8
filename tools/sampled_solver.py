"""The oscillator by SciPy's ``solve_ivp`` with events: what one writes without a closed form."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

Motion = Callable[[float, np.ndarray], list[float]]
Event = Callable[[float, np.ndarray], float]
APART = 1e-12  # put between the masses after an impact, or it is found again


def motions(eta: float, D: float, kappa: float) -> tuple[Motion, Motion]:
    """Return the equations of motion, (3) to (6): apart, and in contact."""

    def flight(t: float, y: np.ndarray) -> list[float]:
        force = math.sin(eta * t)
        return [y[1], force - 2 * D * y[1] - y[0], y[3], force - 2 * D * y[3] - kappa * y[2]]

    def contact(t: float, y: np.ndarray) -> list[float]:
        pull = math.sin(eta * t) - 2 * D * y[1] - 0.5 * (1 + kappa) * y[0]
        return [y[1], pull, y[1], pull]

    return flight, contact


def events(kappa: float) -> tuple[Event, Event]:
    """Return where the gap closes, and where the contact force vanishes."""

    def gap(t: float, y: np.ndarray) -> float:
        return float(y[2] - y[0])

    def pressed(t: float, y: np.ndarray) -> float:
        return float((1.0 - kappa) * y[0])

    for event, direction in ((gap, -1), (pressed, 1)):
        event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
    return gap, pressed


def after(y: np.ndarray, touching: bool, e: float) -> np.ndarray:
    """Return the state after an event: thrown apart, or together."""
    closing, mean = y[1] - y[3], 0.5 * (y[1] + y[3])
    half = 0.0 if touching else max(0.5 * e * closing, 1e-7)
    return np.array([y[0], mean - half, y[0] + (0.0 if touching else APART), mean + half])


def seconds(eta: float, count: int, e: float = 0.7, D: float = 0.005, kappa: float = 1.2) -> float:
    """Return the seconds that ``count`` periods from rest take."""
    flight, contact = motions(eta, D, kappa)
    gap, pressed = events(kappa)
    begin = time.perf_counter()
    t, stop, y, touching = 0.0, count * 2.0 * math.pi / eta, np.zeros(4), True
    while t < stop:
        motion, event = (contact, pressed) if touching else (flight, gap)
        solution = solve_ivp(motion, (t, stop), y, rtol=1e-8, atol=1e-10, events=event)
        t, y = solution.t[-1], solution.y[:, -1].copy()
        slow = e * (y[1] - y[3]) < 1e-4
        touching = not touching and slow and pressed(t, y) < 0.0
        y = after(y, touching, e)
    return time.perf_counter() - begin
