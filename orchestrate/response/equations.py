"""Accelerations of both masses from their states by the equations of motion (6).

Springs, dampers, forces and the other mass make a mass's absolute acceleration. That relative to
the box is the same minus the box's acceleration, which adds ``a Omega^2 sin(phase)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import gaps_of_states, respond_library, traits_for_loops
from ..model import Excitation, Structure
from .questions import Point

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def in_permanent_contact(states: Floats, structure: Structure) -> Flags:
    """Return, for each state, whether it is permanent contact: faces touch at equal velocities."""
    gap, stroke = gaps_of_states(states, structure.gap_offset), structure.stroke
    touching = (gap == 0.0) | ((stroke > 0.0) & np.isclose(gap, stroke, 1e-14, 0.0))
    return np.asarray(touching & (states[:, 2] == states[:, 3]))


def acceleration_of_box(excitation: Excitation, phase: Floats) -> Floats:
    """Return the box's acceleration at phases, m/s2."""
    box: Floats = -excitation.amplitude * excitation.frequency**2 * np.sin(phase)
    return box + excitation.box_acceleration if excitation.box_acceleration else box


def absolute_accelerations_at(
    states: Floats, point: Point, phase: Floats, touching: Flags | None = None
) -> Floats:
    """Return both masses' absolute accelerations, as accelerometers read between impacts."""
    structure, excitation = point
    amplitudes = (excitation.force1, excitation.force2)
    forces = np.outer(np.sin(phase), amplitudes) if any(amplitudes) else None
    box = acceleration_of_box(excitation, phase)
    return absolute_accelerations_by_forces(forces, states, structure, touching, box)


def absolute_accelerations_by_forces(
    forces: Floats | None,
    states: Floats,
    s: Structure,
    touching: Flags | None = None,
    box_acceleration: ArrayLike = 0.0,
) -> Floats:
    """Return the same under forces on both masses in N, with a wall that moves as the box."""
    if forces is None and not (s.wall or s.stroke):
        return absolute_accelerations_unforced(states, s, touching)
    if touching is None:
        touching = in_permanent_contact(states, s)
    loads = (0.0 if forces is None else forces) - states[:, :2] * (s.k1, s.k2)
    loads -= states[:, 2:] * (s.d1, s.d2)
    apart, both = loads / (s.m1, s.m2), loads.sum(axis=1) / (s.m1 + s.m2)
    if s.wall:
        apart[:, 1] = both = box_acceleration
    return np.where(touching[:, None], both[:, None], apart)


def absolute_accelerations_unforced(
    states: Floats, structure: Structure, touching: Flags | None = None
) -> Floats:
    """Return the same without forces, wall or stroke, whatever the excitation."""
    if touching is None:
        touching = in_permanent_contact(states, structure)
    rows, flags = np.ascontiguousarray(states, dtype=float), np.ascontiguousarray(touching)
    accelerations, numbers = np.empty((len(rows), 2)), traits_for_loops(structure)
    addresses = (part.ctypes.data for part in (flags, accelerations))
    respond_library().find_accelerations(rows.ctypes.data, len(rows), numbers, *addresses)
    return accelerations
