"""Compute many responses by one call of compiled code: the loop of :mod:`.respond` and its rule.

``response_loop.c`` calls the FMU's functions itself, past Python: where the FMU is native and the
library can be had, :func:`response_loop` makes a loop that runs so. The calls and their order are
those of :func:`.respond.respond`, so are the bits.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from ctypes import POINTER, byref, c_bool, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import FmuError
from ..fmu import (
    SAMPLE_SERIES,
    START_PARAMETERS,
    Instance,
    begin,
    function_addresses,
    gap_between,
    last_samples,
    samples_per_step,
)
from ..model.outcomes import REPEATED
from .multiplicity import decide_multiplicity, find_repetition, library, memory_size
from .questions import Point

FUNCTIONS = (  # as Calls of the C source has them
    *("Reset", "EnterInitializationMode", "ExitInitializationMode", "DoStep"),
    *("SetFloat64", "SetBoolean", "SetInt32", "GetFloat64", "GetBoolean", "GetInt32"),
)
READ = (
    *("sample_count", "x_rel_max", "x_rel_max_on", "peaks_on"),
    *("impact_count", "contact_count", "in_contact"),
)
PEAKS = ("x1_max", "x2_max", "a1_max", "a2_max")
COUNTED = ("impacts_before", "contacts_before", "touching", "impacts_after", "contacts_after")
COUNTS = (*COUNTED, "multiplicity", "decided", "later_impacts", "nearly")
NOT_FINITE = -1  # a status that FMI does not have
MIN_EXPONENT = -970  # of two: smaller numbers are not rounded
MAX_PERIODS = 200_000  # of one call, a second's work: between two calls an interrupt is heard
MAX_REALS = 64  # numbers set before a start, for which the C source has room
Floats = NDArray[np.float64]


class Calls(ctypes.Structure):
    """C struct of an instance: addresses of FMI's functions, and references of variables."""

    _fields_ = [
        *((name, c_void_p) for name in ("instance", *FUNCTIONS)),
        *((name, POINTER(c_uint)) for name in ("reals", "booleans", "series", "peaks")),
        *((name, c_size_t) for name in ("real_count", "boolean_count", "start", "capacity")),
        *((name, c_uint) for name in READ),
        ("failed", c_char_p),
        ("status", c_int),
    ]


class Task(ctypes.Structure):
    """C struct of what there is to do: sizes and settings, then addresses of rows."""

    _fields_ = [
        *((name, c_size_t) for name in ("count", "samples", "peak_periods")),
        *((name, c_double) for name in ("tolerance", "loose")),
        *((name, c_bool) for name in ("decides", "is_chain", "has_gap")),
        ("gap", c_double),
        *((name, c_void_p) for name in ("transients", "reals", "booleans", "periods")),
        *((name, c_void_p) for name in ("frequencies", "rests", "starts", "memory", "states")),
        *((name, c_void_p) for name in ("ends", "largest", "deviations", "peaks", "counts")),
        ("series", c_void_p),
    ]


@dataclass(frozen=True, kw_only=True)
class LoopSettings:
    """What is computed of each response, and where it starts."""

    transient: int | Sequence[int]  # periods dropped, of all or of each
    samples: int  # periods kept after them
    tolerance: float = 0.0  # within which states repeat, over the motion's size
    decides: bool = False  # whether the multiplicity is decided, and its periods' impacts counted
    loose: float = 0.0  # a wider tolerance, unless 0: repetitions within both are found
    is_chain: bool = False  # whether each response starts from the end state of the one before
    # gap between unloaded springs that the first start of a chain belongs to, m, where it is known
    chain_gap: float | None = None
    peak_periods: int = 0  # periods looked at for peaks, at most


class Responses(NamedTuple):
    """Results of the loop, a row a response."""

    states: Floats  # stroboscopic states x1, x2, v1, v2, (n, samples, 4)
    ends: Floats  # the last ones, rounded, from which the next responses start
    x_rel_max: Floats  # largest gap over the samples, m
    counts: dict[str, NDArray[np.int32]]  # by `COUNTS`
    # largest deviation of states from those `nearly` periods before, within the loose tolerance
    deviations: Floats
    peaks: Floats  # largest displacements and accelerations as `PEAKS`, where it decides, (n, 4)

    @classmethod
    def empty(cls, count: int, settings: LoopSettings) -> Responses:
        """Return tables for so many responses."""
        counts = np.zeros((len(COUNTS), count), np.int32)
        return cls(
            states=np.empty((count, settings.samples, 4)),
            ends=np.empty((count, 4)),
            x_rel_max=np.empty(count),
            counts=dict(zip(COUNTS, counts, strict=True)),
            deviations=np.zeros(count),
            peaks=np.zeros((count, len(PEAKS))),
        )

    def rows(self, chosen: NDArray[np.intp]) -> Responses:
        """Return the results of chosen responses."""
        return self._replace(
            states=self.states[chosen],
            ends=self.ends[chosen],
            x_rel_max=self.x_rel_max[chosen],
            counts={name: numbers[chosen] for name, numbers in self.counts.items()},
            deviations=self.deviations[chosen],
            peaks=self.peaks[chosen],
        )


def response_loop(instance: Instance) -> ResponseLoop:
    """Return the loop of an FMU instance: compiled where it is native and of FMI 3.0."""
    loop: ResponseLoop | None = instance.cache.get(ResponseLoop)
    if loop is None:
        is_native = instance.is_fmi3 and not instance.description.needs_tool
        has_arrays = f"{SAMPLE_SERIES[0]}[1]" not in instance.description.variables
        compiled = is_native and has_arrays and not instance.EVENTS and library() is not None
        loop = (CompiledResponseLoop if compiled else ResponseLoop)(instance)
        instance.cache[ResponseLoop] = loop
    return loop


class ResponseLoop:
    """Runs responses of one FMU instance, each with its structure and excitation."""

    def __init__(self, instance: Instance) -> None:
        self.instance = instance

    def respond(
        self, points: Sequence[Point], starts: ArrayLike, settings: LoopSettings
    ) -> Responses:
        """Compute responses from their starts, or from the first of a chain."""
        results = Responses.empty(len(points), settings)
        given, gap = np.atleast_2d(np.asarray(starts, dtype=float)), settings.chain_gap
        transients = np.broadcast_to(settings.transient, len(points)).tolist()
        for i, point in enumerate(points):
            start = given[0 if settings.is_chain else i]
            if settings.is_chain:
                start = results.ends[i - 1] if i else start
                offset = point.structure.gap_offset
                if gap is not None and gap != offset and np.any(start):
                    start = np.add(start, (0.0, gap - offset, 0.0, 0.0))
                gap = offset
            begin(self.instance, *point, start)
            self.sample(point, transients[i], settings.samples, results, i)
            self.apply_rules(point, settings, results, i)
            if settings.decides:
                self.run_on(point, transients[i] + settings.samples, settings, results, i)
        return results

    def sample(
        self, point: Point, transient: int, samples: int, results: Responses, i: int
    ) -> None:
        """Run through transient and samples; store states, largest gap, impacts and contacts."""
        instance, period = self.instance, point.excitation.period
        if transient:
            instance.step(0.0, transient * period)
        counts = instance.get("impact_count", "contact_count", "in_contact")
        states, peak = stroboscopic_samples(instance, period, transient, samples)
        counts += instance.get("impact_count", "contact_count")
        for name, count in zip(COUNTED, counts, strict=True):
            results.counts[name][i] = count
        results.states[i], results.x_rel_max[i] = states, peak
        results.ends[i] = round_state(states[-1], point.structure.gap_offset)

    def apply_rules(self, point: Point, settings: LoopSettings, results: Responses, i: int) -> None:
        """Find repetitions within both tolerances, decide the multiplicity, as the settings say."""
        states, counts = results.states[i], results.counts
        size = point.excitation.frequency, float(results.x_rel_max[i])
        if settings.loose:
            both = settings.tolerance, settings.loose
            within = (find_repetition(states, *size, each) for each in both)
            (counts["multiplicity"][i], _), (counts["nearly"][i], results.deviations[i]) = within
        if settings.decides:
            decision = decide_multiplicity(states, *size, settings.tolerance)
            counts["multiplicity"][i], counts["decided"][i] = decision

    def run_on(
        self, point: Point, first: int, settings: LoopSettings, results: Responses, i: int
    ) -> None:
        """Store the peaks, and the impacts after the periods of what repeats."""
        counts, n = results.counts, int(results.counts["multiplicity"][i])
        span = periods_to_sample(n, settings.peak_periods)
        begun, done, end = ((first + count) * point.excitation.period for count in (0, span, n))
        self.instance.set(x_rel_max_on=False, sample_count=0, peaks_on=True)
        self.instance.step(begun, done)
        results.peaks[i] = self.instance.get(*PEAKS)
        self.instance.set(peaks_on=False)
        if counts["decided"][i] == REPEATED:
            if n > span:
                self.instance.step(done, end)
            counts["later_impacts"][i] = self.instance.get("impact_count")[0]


class CompiledResponseLoop(ResponseLoop):
    """The loop in compiled C: same arguments and same results as :class:`ResponseLoop`."""

    def __init__(self, instance: Instance) -> None:
        super().__init__(instance)
        self.run, self.capacity = library().run, samples_per_step(instance)
        self.names: tuple[list[str], list[str]] = ([], [])
        self.last_points: list[Point] = []
        self.last_rows: tuple[NDArray[Any], ...] = ()
        self.calls = Calls()

    def prepare(self, point: Point) -> None:
        """Sort what is set before a start by type, and make the struct of the instance."""
        names = [*point.structure.parameters(), *START_PARAMETERS, *point.excitation.inputs()]
        kinds = {name: self.instance.variable(name).type for name in [*names, "x_rel_max_on"]}
        reals = [name for name, kind in kinds.items() if kind == "Float64"]
        booleans = [name for name, kind in kinds.items() if kind == "Boolean"]
        assert len(reals) + len(booleans) == len(kinds) and len(reals) <= MAX_REALS
        self.names = reals, booleans
        tables = (self.references(some) for some in (*self.names, SAMPLE_SERIES, PEAKS))
        sizes = len(reals), len(booleans), reals.index(START_PARAMETERS[0]), self.capacity
        addresses = function_addresses(self.instance, FUNCTIONS)
        self.calls = Calls(*addresses, *tables, *sizes, *self.references(READ))

    def references(self, names: Sequence[str]) -> Any:
        """Return the value references of variables as a ctypes array."""
        return (c_uint * len(names))(
            *(self.instance.variable(name).valueReference for name in names)
        )

    def respond(
        self, points: Sequence[Point], starts: ArrayLike, settings: LoopSettings
    ) -> Responses:
        """Compute responses in C; same results as :meth:`ResponseLoop.respond`."""
        if not self.names[0]:
            self.prepare(points[0])
        results, chosen = Responses.empty(len(points), settings), settings
        counts = np.zeros((len(points), len(COUNTS)), np.int32)
        series, memory = np.empty(4 * self.capacity), np.empty(memory_size(chosen.samples))
        transients = np.full(len(points), chosen.transient, dtype=np.uint64)
        inputs = (transients, *self.rows(points), np.ascontiguousarray(starts, dtype=float), memory)
        outputs = (*results[:3], results.deviations, results.peaks, counts, series)
        task = Task(
            *(len(points), chosen.samples, chosen.peak_periods),
            *(chosen.tolerance, chosen.loose, chosen.decides),
            *(chosen.is_chain, chosen.chain_gap is not None, chosen.chain_gap or 0.0),
            *(table.ctypes.data for table in (*inputs, *outputs)),
        )
        self.instance._messages.clear()
        pointers, count = (byref(self.calls), byref(task)), len(points)
        step = max(1, int(MAX_PERIODS // (float(transients.max(initial=0)) + chosen.samples)))
        for first in range(0, count, step):
            if self.run(*pointers, first, min(first + step, count)):
                raise self.error(series)
        return results._replace(counts=dict(zip(COUNTS, counts.T, strict=True)))

    def rows(self, points: Sequence[Point]) -> tuple[NDArray[Any], ...]:
        """Return what is set before each start, and of each the period, frequency and rest."""
        if points == self.last_points:
            return self.last_rows
        reals, booleans = self.names
        different = {id(point): point for point in points}  # as of a basin: one for all starts
        index = {key: i for i, key in enumerate(different)}
        chosen = np.array([index[id(point)] for point in points])
        first = dict.fromkeys(START_PARAMETERS, 0.0) | {"x_rel_max_on": False}
        values = [
            {**first, **point.structure.parameters(), **point.excitation.inputs()}
            for point in different.values()
        ]
        tables = (
            np.array([[row[name] for name in reals] for row in values], dtype=float),
            np.array([[row[name] for name in booleans] for row in values], dtype=bool),
            np.array([point.excitation.period for point in different.values()]),
            np.array([point.excitation.frequency for point in different.values()]),
            np.array([rest_of(point) for point in different.values()]),
        )
        self.last_points = list(points)
        self.last_rows = tuple(np.ascontiguousarray(table[chosen]) for table in tables)
        return self.last_rows

    def error(self, series: Floats) -> FmuError:
        """Return the error of the call at which the C loop stopped."""
        status, function = self.calls.status, (self.calls.failed or b"").decode()
        if status != NOT_FINITE:
            return self.instance.refusal(function, status)
        if np.isfinite(series).all():
            return self.instance.not_finite_error(("x_rel_max", *PEAKS), np.array([np.nan]))
        names = [name for name in SAMPLE_SERIES for _ in range(self.capacity)]
        return self.instance.not_finite_error(names, series)


def periods_to_sample(multiplicity: int, max_periods: int) -> int:
    """Return the periods looked at for peaks: the multiplicity, or half of the most if none."""
    return min(multiplicity, max_periods) or (max_periods + 1) // 2


def rest_of(point: Point) -> tuple[float, float, float]:
    """Return the gap between unloaded springs, and the places of rest where it is negative."""
    structure = point.structure
    if structure.gap_offset >= 0.0:
        return structure.gap_offset, 0.0, 0.0
    return (structure.gap_offset, *structure.at_rest)


def stroboscopic_samples(
    instance: Instance, period: float, transient: int, samples: int
) -> tuple[NDArray[np.float64], float]:
    """Run the FMU over some periods; return states at phase 0, and the largest gap."""
    room = samples_per_step(instance)
    states, peak = np.empty((samples, 4)), 0.0
    for done in range(0, samples, room):
        count = min(room, samples - done)
        first = transient + done
        instance.set(x_rel_max_on=True, sample_count=count)
        instance.step(first * period, (first + count) * period)
        states[done : done + count] = last_samples(instance, count)
        peak = max(peak, *instance.get("x_rel_max"))
    return states, peak


def round_state(
    state: NDArray[np.float64], gap_offset: float = 0.0, bits: int = 44
) -> tuple[float, ...]:
    """Round a state to 44 bits (13 digits), so that it hardly depends on its history.

    What converged from two sides differs in its last digits for good: rounded, it is the same, and
    parts of a sweep that are begun elsewhere join it.
    """
    x1, x2, v1, v2 = state.tolist()
    velocities = round_to_bits(v1, v2, bits)
    if gap_offset == 0.0:
        return (*round_to_bits(x1, x2, bits), *velocities)
    face_1, face_2 = round_to_bits(x1, x1 + float(gap_between(state, gap_offset)), bits)
    return (face_1, face_2 - gap_offset, *velocities)


def round_to_bits(first: float, second: float, bits: int) -> tuple[float, float]:
    """Round two numbers to a number of binary digits of the larger one."""
    exponent = math.frexp(max(abs(first), abs(second)))[1]
    if exponent < MIN_EXPONENT:  # too small to have so many digits
        return first, second
    digit = math.ldexp(1.0, exponent - bits)
    return (
        math.copysign(round(first / digit) * digit, first),
        math.copysign(round(second / digit) * digit, second),
    )
