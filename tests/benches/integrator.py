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

from .system import LAWS, Floats, Frictions, ModalSystem, Motion, empty_contacts, empty_springs

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
KEPT = 8  # numbers of a contact
SETTLED = 40.0  # radians of the slowest mode after which a critically damped motion is at rest


class UnboundedMotionError(ArithmeticError):
    """Raised if a motion grows without bounds: a softening spring, or a step too long."""


class CSystem(ctypes.Structure):
    """C structure of a modal system, as the compiled library reads it."""

    _fields_ = [
        *((name, c_int) for name in COUNTS),
        *((name, NUMBERS) for name in ARRAYS),
        ("longest_impact", c_double),
    ]


@functools.cache
def integration_function() -> Any:
    """Return the compiled library's integration function; compile it once per process."""
    run = load_library(SOURCE).run
    run.argtypes = [POINTER(CSystem), c_long, c_double, *[NUMBERS] * 6]
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
    contacts = system.contacts or empty_contacts(system.modes)
    springs = system.springs or empty_springs(system.modes)
    steps, outputs = (len(base) - 1) // 2, len(system.output_rows)
    out = np.empty((steps + 1, outputs))
    kept, peaks = np.zeros((len(contacts.rows), KEPT)), np.zeros(len(springs.rows))
    kept[:, 0] = -np.inf
    keep_alive, passed = to_c_system(system)
    pointers = [pointer_to(array) for array in (base, q, v, out, kept, peaks)]
    done = integration_function()(byref(passed), steps, step, *pointers)
    del keep_alive
    if done != steps:
        raise UnboundedMotionError(f"after {done * step:.4g} s")
    count, speed_in, speed_out = kept[:, 3], kept[:, 4], kept[:, 5]
    with np.errstate(invalid="ignore", divide="ignore"):
        restitution, closing = speed_out / speed_in, speed_in / count
    gap, force, opened = kept[:, 0], kept[:, 1], kept[:, 2]
    acceleration = out.T + base[::2]
    return Motion(acceleration, q, v, gap, force, opened, count, restitution, closing, peaks)


def to_c_system(system: ModalSystem) -> tuple[list[Floats], CSystem]:
    """Return the C structure of a system, and the arrays that it points at."""
    n, empty = system.modes, np.zeros(0)
    contacts = system.contacts or empty_contacts(n)
    springs = system.springs or empty_springs(n)
    frictions = system.frictions or Frictions(np.zeros((0, n)), empty, empty, empty)
    w = system.frequency
    arrays = [
        *(w * w, 2.0 * system.damping_ratio * w, system.participation),
        *(contacts.rows, contacts.clearance, contacts.stiffness, contacts.damping),
        *(springs.rows, springs.stiffness, springs.offset),
        *(frictions.rows, frictions.force, frictions.coefficient, frictions.speed),
        system.output_rows,
    ]
    arrays = [np.ascontiguousarray(array, dtype=float) for array in arrays]
    sizes = (n, *(len(part.rows) for part in (contacts, springs, frictions)))
    counts = (*sizes, len(system.output_rows), LAWS.index(contacts.law))
    pointers = [pointer_to(array) for array in arrays]
    return arrays, CSystem(*counts, *pointers, contacts.longest_impact)


def equilibrium(system: ModalSystem) -> Floats:
    """Return the modes' positions at rest, by a critically damped motion; 0 without contact."""
    contacts = system.contacts
    start = np.zeros(system.modes)
    if contacts is None or (contacts.clearance >= 0.0).all():
        return start
    damped = replace(
        system, damping_ratio=np.ones(system.modes), output_rows=np.zeros((0, system.modes))
    )
    damped = replace(damped, frictions=None)
    stiffest = float(np.sqrt(highest_stiffness(damped)))
    step = 0.05 / stiffest
    steps = int(SETTLED / float(system.frequency.min()) / step) + 1
    return integrate(damped, np.zeros(2 * steps + 1), step, start).position


def highest_stiffness(system: ModalSystem) -> float:
    """Return a bound of the largest squared angular frequency, all contacts closed."""
    contacts = system.contacts or empty_contacts(system.modes)
    stiffness = contacts.stiffness * (np.sqrt(1e-3) if contacts.law == "hertz" else 1.0)
    weighted = contacts.rows * np.sqrt(stiffness)[:, np.newaxis]
    closed = weighted.T @ weighted + np.diag(system.frequency**2)
    return float(np.linalg.eigvalsh(closed)[-1])
