"""Linearised motion (variational equations): how deviations of a motion grow through impacts.

Non-dimensional, as in :mod:`.closed_form`. The rules are :mod:`fmu_src.kernels.deviations`,
compiled for Python and the explorer alike.
"""

from __future__ import annotations

import functools
import math
from ctypes import c_bool, c_double, c_int, c_size_t, c_void_p
from typing import Any

import numpy as np

from ..fmu import Impacts
from ..fmu.c_library import load_loop
from ..fmu.oscillator import DEVIATING
from ..response.questions import Point
from .closed_form import ClosedForm, Floats


@functools.cache
def exponent_library() -> Any:
    """Return the compiled loop of deviations and exponents, with the types of its functions."""
    loaded, table = load_loop("exponent"), [c_void_p, c_size_t]
    loaded.exponent_size.argtypes, loaded.exponent_size.restype = [c_size_t], c_size_t
    span = [c_void_p, *table, c_double]
    loaded.find_deviations.argtypes, loaded.find_deviations.restype = [*span, c_void_p], c_size_t
    loaded.find_growth.argtypes = [*table, c_size_t, c_size_t, c_void_p]
    loaded.find_average.argtypes = [c_void_p, *table, c_size_t, c_void_p]
    loaded.largest_exponent.argtypes = [*span, c_size_t, c_size_t, c_void_p, c_void_p]
    loaded.find_average.restype = loaded.largest_exponent.restype = None
    loaded.find_growth.restype, loaded.wander_floor.restype = c_bool, c_double
    loaded.wander_floor.argtypes = [c_double, c_double]
    loaded.classify_exponent.argtypes, loaded.classify_exponent.restype = [c_double] * 4, c_int
    return loaded


def library_arguments(impacts: Impacts, end: float, point: Point) -> tuple[Any, ...]:
    """Return a call's arguments about non-dimensional impacts up to an end in tau, and memory."""
    structure, excitation = point
    values = [float(getattr(structure, name)) for name in DEVIATING]
    box = excitation.amplitude, excitation.frequency
    numbers = np.array([*values, *box, *excitation.pushes])
    states, omega = point.states_from_faces(impacts.state), structure.omega
    columns = impacts.time / omega, states, impacts.closing * point.velocity_unit, impacts.sticks
    rows, count = np.column_stack(columns).astype(float), len(impacts.time)
    memory = np.empty(exponent_library().exponent_size(count))
    return numbers.ctypes, rows.ctypes, count, end / omega, memory  # arrays stay while these do


def period_in_tau(eta: float) -> float:
    """Return the excitation period 2 pi/eta in units of tau, (22) as it must read."""
    return 2.0 * math.pi / eta


def deviation_matrices_and_contacts(
    impacts: Impacts, end: float, point: Point
) -> tuple[Floats, Floats]:
    """Return matrices (n, 4, 4) from before an impact to before the next; contacts in tau."""
    *arguments, memory = library_arguments(impacts, end, point)
    count = len(impacts.time)
    first = exponent_library().find_deviations(*arguments, memory.ctypes)
    last = first + 16 * count
    return memory[first:last].reshape(count, 4, 4), memory[last : last + count]


def contact_durations(form: ClosedForm, phase: Floats, states: Floats, spans: Floats) -> Floats:
    """Return how long permanent contacts last, in tau; infinite if not released in the span."""
    mu = 1.0 if form.wall else float(form.shares[1] / form.shares[0])
    dampers, eta = (2.0 * form.damping[0], 2.0 * form.damping[1] * mu), form.eta
    half = 1.0, mu, 1.0, mu * form.stiffness[1], *dampers, form.e, 1.0, 0.0
    stroke = form.limit if form.limit < np.inf else 0.0
    gaps = float(form.wall), form.gap_offset, stroke
    forces = (form.drive[:2] - 1.0) * [1.0, 0.0 if form.wall else mu]  # beside a shaken box
    numbers = np.array([*half, *gaps, 0.0, eta**-2.0, eta, -form.push[0], *forces])
    durations, memory = np.empty(len(spans)), np.empty(exponent_library().exponent_size(1))
    from_unloaded = states - [0.0, form.gap_offset, 0.0, 0.0]
    columns = phase / eta, from_unloaded, 0.0 * phase, 1.0 + 0.0 * phase
    for i, row in enumerate(np.column_stack(columns)):
        arguments = numbers.ctypes.data, row.ctypes.data, 1, row[0] + 1.5 * spans[i]
        first = exponent_library().find_deviations(*arguments, memory.ctypes.data)
        durations[i] = memory[first + 16]
    return np.where(durations <= spans, durations, np.inf)


def nondimensional_impacts(impacts: Impacts, point: Point) -> Impacts:
    """Convert impacts from SI to the paper's units, displacements to those of the faces."""
    tau, closing = point.structure.omega * impacts.time, impacts.closing / point.velocity_unit
    return Impacts(tau, point.faces_from_states(impacts.state), closing, impacts.sticks)
