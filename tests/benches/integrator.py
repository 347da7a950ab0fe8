"""Integrate a :class:`.system.ModalSystem` in time by compiled steps (``integrator.c``)."""

from __future__ import annotations

import ctypes
import functools
from ctypes import POINTER, byref, c_double, c_int, c_long
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from orchestrate.fmu.c_library import load_library

from .system import LAWS, Floats, ModalSystem, Motion

SOURCE = Path(__file__).with_suffix(".c")
NUMBERS = POINTER(c_double)
COUNTS = ("modes", "contacts", "springs", "frictions", "outputs", "law")
ARRAYS = (
    *("stiffness", "damping", "participation"),
    *("contact_rows", "clearance", "contact_stiffness", "contact_damping"),
    *("spring_rows", "cubic", "offset"),
    *("friction_rows", "friction_force", "friction_coefficient", "friction_speed"),
    "output_rows",
)
SETTLED = 40.0  # radians of the slowest mode after which a critically damped motion is at rest


class UnboundedMotionError(ArithmeticError):
    """Raised if a motion grows without bounds: a softening spring, or a step too long."""


class CSystem(ctypes.Structure):
    """C structure of a modal system, as the compiled library reads it."""

    _fields_ = [*((name, c_int) for name in COUNTS), *((name, NUMBERS) for name in ARRAYS)]


@functools.cache
def integration_function() -> Any:
    """Return the compiled library's integration function; compile it once per process."""
    run = load_library(SOURCE).run
    run.argtypes = [POINTER(CSystem), c_long, c_double, *[NUMBERS] * 5]
    run.restype = c_long
    return run


def pointer_to(values: Floats) -> Any:
    """Return the C address of a contiguous array of numbers."""
    return values.ctypes.data_as(NUMBERS)


def integrate(
    system: ModalSystem,
    base: Floats,
    step: float,
    position: Floats | None = None,
    velocity: Floats | None = None,
) -> Motion:
    """Integrate a system's motion over a base acceleration with equal steps; return it."""
    if position is None:
        position = equilibrium(system)
    base = np.ascontiguousarray(base, dtype=float)
    q = np.array(position, dtype=float)
    v = np.zeros(system.modes) if velocity is None else np.array(velocity, dtype=float)
    steps = (len(base) - 1) // 2
    out = np.empty((steps + 1, len(system.output_rows)))
    largest = np.zeros((len(system.contacts.rows), 2))  # gap and force
    largest[:, 0] = -np.inf
    keep_alive, passed = to_c_system(system)
    pointers = [pointer_to(array) for array in (base, q, v, out, largest)]
    done = integration_function()(byref(passed), steps, step, *pointers)
    del keep_alive
    if done != steps:
        raise UnboundedMotionError(f"after {done * step:.4g} s")
    return Motion(out.T + base[::2], q, v, *largest.T)


def to_c_system(system: ModalSystem) -> tuple[list[Floats], CSystem]:
    """Return the C structure of a system, and the arrays that it points at."""
    contacts, springs, frictions = system.contacts, system.springs, system.frictions
    w = system.frequency
    arrays = [
        *(w * w, 2.0 * system.damping_ratio * w, system.participation),
        *(contacts.rows, contacts.clearance, contacts.stiffness, contacts.damping),
        *(springs.rows, springs.stiffness, springs.offset),
        *(frictions.rows, frictions.force, frictions.coefficient, frictions.speed),
        system.output_rows,
    ]
    arrays = [np.ascontiguousarray(array, dtype=float) for array in arrays]
    sizes = (len(part.rows) for part in (contacts, springs, frictions))
    counts = (system.modes, *sizes, len(system.output_rows), LAWS.index(contacts.law))
    return arrays, CSystem(*counts, *(pointer_to(array) for array in arrays))


def equilibrium(system: ModalSystem) -> Floats:
    """Return the modes' positions at rest, by a critically damped motion; 0 without contact."""
    start = np.zeros(system.modes)
    if (system.contacts.clearance >= 0.0).all():
        return start
    critical, none = np.ones(system.modes), np.zeros((0, system.modes))
    damped = replace(system, damping_ratio=critical, output_rows=none, frictions=None)
    stiffest = float(np.sqrt(highest_stiffness(damped)))
    step = 0.05 / stiffest
    steps = int(SETTLED / float(system.frequency.min()) / step) + 1
    return integrate(damped, np.zeros(2 * steps + 1), step, start).position


def highest_stiffness(system: ModalSystem) -> float:
    """Return a bound of the largest squared angular frequency, all contacts closed."""
    contacts = system.contacts
    stiffness = contacts.stiffness * (np.sqrt(1e-3) if contacts.law == "hertz" else 1.0)
    weighted = contacts.rows * np.sqrt(stiffness)[:, np.newaxis]
    closed = weighted.T @ weighted + np.diag(system.frequency**2)
    return float(np.linalg.eigvalsh(closed)[-1])
