"""An oscillator FMU: its start, and the compiled loop that drives it without Python.

The loop is ``fmu_src/kernels/loops/respond.c``; this module has its structures for ctypes.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Sequence
from ctypes import POINTER, byref, c_bool, c_double, c_size_t, c_uint, c_void_p
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import NOT_NUMBERS, FmuError, InputError
from ..model import Excitation, Structure
from .c_library import load_loop
from .fmi import NOT_FINITE, Fmi, value_references
from .impacts import STATE
from .instance import Instance

Floats = NDArray[np.float64]
REST = (0.0, 0.0, 0.0, 0.0)
START_PARAMETERS = tuple(f"{name}_start" for name in STATE)
SAMPLE_SERIES = tuple(f"{name}_sample" for name in STATE)
READ_VARIABLES = (
    *("sample_count", "x_rel_max", "x_rel_max_on", "peaks_on"),
    *("impact_count", "contact_count", "in_contact"),
)
PEAKS = ("x1_max", "x2_max", "a1_max", "a2_max")
# of a structure, and what follows from them
TRAITS = ("m1", "m2", "k1", "k2", "d1", "d2", "clearance", "bonded", "wall", "stroke")
DERIVED_TRAITS = ("gap_offset", "rest_1", "rest_2", "threshold", "must_impact")
TRAIT_NAMES = (*TRAITS, "omega", "frequency", "amplitude", "pushed", *DERIVED_TRAITS)
DEVIATING = (  # of deviations' growth
    *(*TRAITS[:6], "e", "gamma", "bonded"),
    *("wall", "clearance", "stroke", "e_slope"),
)
COUNTED = ("impacts_before", "contacts_before", "touching", "impacts_after", "contacts_after")
COUNTS = (*COUNTED, "multiplicity", "decided", "nearly", "reached")
START_VALUES = {  # before each start, with first values
    **Structure().parameters(),
    **dict.fromkeys(START_PARAMETERS, 0.0),
    **Excitation(frequency=1.0, amplitude=1.0).inputs(),
    "x_rel_max_on": False,
}


class OscillatorCalls(ctypes.Structure):
    """C struct of an instance, and of the variables that are set before a start or read."""

    _fields_ = [
        ("fmi", Fmi),
        *((name, POINTER(c_uint)) for name in ("reals", "booleans", "series", "peaks")),
        *((name, c_size_t) for name in ("real_count", "boolean_count", "start")),
        *((name, c_size_t) for name in ("series_count", "capacity")),
        *((name, c_uint) for name in READ_VARIABLES),
        ("kept", c_void_p),
    ]


class KnownMotions(ctypes.Structure):
    """C struct of periodic motions, with which responses are compared: addresses of rows."""

    _fields_ = [
        ("count", c_size_t),
        ("state", POINTER(c_uint)),
        *((name, c_void_p) for name in ("states", "gaps", "periods")),
        ("within", c_double),
    ]


class ResponseTask(ctypes.Structure):
    """C struct of responses to compute: sizes and settings, then addresses of rows."""

    _fields_ = [
        *((name, c_size_t) for name in ("count", "samples", "peak_periods", "piece")),
        *((name, c_double) for name in ("tolerance", "loose", "gap")),
        *((name, c_bool) for name in ("decides", "is_chain", "has_gap")),
        *((name, c_void_p) for name in ("transients", "reals", "booleans", "periods", "traits")),
        *((name, c_void_p) for name in ("starts", "memory", "states")),
        *((name, c_void_p) for name in ("ends", "largest", "impacts", "deviations", "peaks")),
        *(("counts", c_void_p), ("known", POINTER(KnownMotions))),
    ]


class ResponseProgress(ctypes.Structure):
    """C struct of how far responses are computed."""

    _fields_ = [
        *((name, c_size_t) for name in ("response", "period")),
        *((name, c_double) for name in ("time", "away")),
        ("is_begun", c_bool),
    ]


@functools.cache
def respond_library() -> Any:
    """Return the compiled loop of responses, with the types of its functions."""
    loaded = load_loop("respond")
    loaded.respond.argtypes = [c_void_p, c_void_p, c_void_p, c_size_t]
    loaded.sample_evenly.argtypes = [c_void_p, c_double, c_double, c_size_t, c_void_p]
    periods = [c_double, c_size_t, c_size_t]
    loaded.sample_periods.argtypes = [c_void_p, *periods, c_void_p, c_void_p]
    loaded.to_rest.argtypes = [c_void_p, c_void_p, c_void_p]
    loaded.find_gaps.argtypes = [c_void_p, c_size_t, c_void_p, c_bool, c_void_p]
    loaded.find_accelerations.argtypes = [c_void_p, c_size_t, *[c_void_p] * 3]
    loaded.find_gaps.restype = loaded.find_accelerations.restype = None
    loaded.to_rest.restype = None
    loaded.sample_evenly.restype = loaded.sample_periods.restype = c_bool
    loaded.nearest_state.argtypes = [c_void_p, c_size_t, c_double, c_double, c_void_p, c_void_p]
    loaded.nearest_state.restype = c_double
    for name in ("decide_multiplicity", "find_repetition", "rest_and_threshold"):
        getattr(loaded, name).argtypes = [c_void_p]
    return loaded


class Oscillator:
    """An oscillator FMU instance with what its loops need, made once."""

    def __init__(self, instance: Instance) -> None:
        self.instance = instance
        kinds = {name: instance.variable(name).type for name in START_VALUES}
        self.booleans = [name for name, kind in kinds.items() if kind == "Boolean"]
        self.reals = [name for name in kinds if name not in self.booleans]
        parts = [part for name in SAMPLE_SERIES for part in instance.elements(name)]
        self.capacity = sum(size for _, size in parts) // len(SAMPLE_SERIES)
        self.kept = np.zeros((len(SAMPLE_SERIES), self.capacity))
        series = (c_uint * len(parts))(*(variable.valueReference for variable, _ in parts))
        self.calls = OscillatorCalls(
            Fmi.from_instance(instance),
            *(value_references(instance, names) for names in (self.reals, self.booleans)),
            *(series, value_references(instance, PEAKS), len(self.reals), len(self.booleans)),
            *(self.reals.index(START_PARAMETERS[0]), len(parts), self.capacity),
            *(*value_references(instance, READ_VARIABLES), self.kept.ctypes.data),
        )

    @classmethod
    def from_instance(cls, instance: Instance) -> Oscillator:
        """Return the oscillator of an instance, made once."""
        oscillator: Oscillator | None = instance.cache.get(cls)
        if oscillator is None:
            oscillator = instance.cache[cls] = cls(instance)
        return oscillator

    def call_loop(self, name: str, *arguments: Any) -> Any:
        self.instance._messages.clear()
        return getattr(respond_library(), name)(byref(self.calls), *arguments)

    def error_of_last_call(self) -> FmuError:
        """Return the error at which a loop has stopped."""
        fmi: Fmi = self.calls.fmi
        if fmi.status != NOT_FINITE:
            return fmi.error_of_failed_call(self.instance)
        if np.isfinite(self.kept).all():
            return self.instance.not_finite_error(("x_rel_max", *PEAKS), np.array([np.nan]))
        names = [name for name in SAMPLE_SERIES for _ in range(self.capacity)]
        return self.instance.not_finite_error(names, self.kept)


def sample_evenly(instance: Instance, time: float, target: float, count: int) -> Floats:
    """Step to ``target``; return states at ``count`` equally spaced times, the last one there."""
    oscillator, states = Oscillator.from_instance(instance), np.empty((count, len(STATE)))
    if not oscillator.call_loop("sample_evenly", time, target, count, states.ctypes.data):
        raise oscillator.error_of_last_call()
    return states


def sample_stroboscopically(
    instance: Instance, period: float, transient: int, samples: int
) -> tuple[Floats, float]:
    """Run on by whole periods; return the states after each one kept, and the largest gap, m."""
    oscillator, peak = Oscillator.from_instance(instance), c_double()
    states = np.empty((samples, len(STATE)))
    addresses = states.ctypes.data, byref(peak)
    if not oscillator.call_loop("sample_periods", period, transient, samples, *addresses):
        raise oscillator.error_of_last_call()
    return states, peak.value


def traits_for_loops(
    structure: Structure, frequency: float = 1.0, amplitude: float = 0.0, pushed: bool = False
) -> Any:
    """Return what a structure under an excitation is for the loops: numbers in C.

    They end with the gap between unloaded springs, the places of rest x1 and x2, the amplitude at
    which the linear response opens or touches, and whether it does: then every motion impacts. That
    is not known with a wall, a stroke, or with loads other than the box's harmonic motion.
    """
    numbers = (getattr(structure, name) for name in TRAITS)
    memory = (c_double * len(TRAIT_NAMES))(*numbers, structure.omega, frequency, amplitude, pushed)
    respond_library().rest_and_threshold(memory)
    return memory


def start_motion(
    instance: Instance,
    structure: Structure,
    excitation: Excitation,
    start: ArrayLike = REST,
    **values: float,
) -> None:
    """Reset an oscillator FMU; initialise it at time 0 by structure, excitation and start state."""
    start_state = relative_to_rest(structure, checked_four_numbers(start))
    state = dict(zip(START_PARAMETERS, start_state, strict=True))
    start_values = {**structure.parameters(), **state, **excitation.inputs(), "x_rel_max_on": False}
    instance.reset()
    instance.initialize(**{**start_values, **values})


def gaps_of_states(states: NDArray[np.float64], gap_offset: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Return the gap x2 - x1 + offset of states (..., 4); rounding at an offset is 0."""
    rows, offsets = (np.ascontiguousarray(part, dtype=float) for part in (states, gap_offset))
    gaps = np.empty(rows.shape[:-1])
    addresses = rows.ctypes.data, gaps.size, offsets.ctypes.data, offsets.size == 1
    respond_library().find_gaps(*addresses, gaps.ctypes.data)
    return gaps


def checked_four_numbers(start: ArrayLike) -> list[float]:
    """Return a start state as a list; raise unless it is four numbers."""
    try:
        state = np.asarray(start, dtype=float)
    except NOT_NUMBERS:
        state = np.empty(0)
    if state.shape != (len(START_PARAMETERS),):
        raise InputError(f"start = {start!r}: expected 4 numbers, x1, x2, v1, v2")
    numbers: list[float] = state.tolist()
    return numbers


def relative_to_rest(structure: Structure, state: Sequence[float]) -> list[float]:
    """Convert a start state from unloaded springs to the FMU's, from rest; all zeros mean rest."""
    numbers, start = (c_double * 4)(*state), (c_double * 4)()
    respond_library().to_rest(numbers, traits_for_loops(structure), start)
    return list(start)
