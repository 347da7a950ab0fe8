"""Compute many steady-state responses by one call of compiled code.

The loop is ``fmu_src/kernels/loops/respond.c``, which calls the FMU's functions itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import byref, pointer
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu import START_VALUES, Instance, Oscillator, traits_for_loops
from ..fmu.fmi import BROKEN, PAUSED, value_references
from ..fmu.impacts import STATE
from ..fmu.oscillator import COUNTS, PEAKS, KnownMotions, ResponseProgress, ResponseTask
from .multiplicity import memory_size
from .questions import Point

MAX_WORK = 200_000  # periods and impacts of one call: between two calls an interrupt is heard
Floats = NDArray[np.float64]


class PeriodicMotion(Protocol):
    """A motion that repeats: its states at phase 0, (periods, 4), and its largest gap, m."""

    @property
    def states(self) -> Floats: ...

    @property
    def gap(self) -> float: ...


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
    # periodic motions of the one point that all responses have: a response is not run on that
    # comes within `same` of one, over its size, and is nearer still `compared` periods later;
    # `reached` is the number, from 1, of the nearest of all their states
    known: Sequence[PeriodicMotion] = ()
    same: float = 0.0
    compared: int = 16


class Responses(NamedTuple):
    """Results of the loop, a row a response."""

    states: Floats  # stroboscopic states x1, x2, v1, v2, (n, samples, 4)
    ends: Floats  # the last ones, rounded, from which the next responses start
    x_rel_max: Floats  # largest gap over the samples, m
    impacts: Floats  # a period: exact where the response repeats and that is decided, else a mean
    # largest deviation of states from those `nearly` periods before, within the loose tolerance
    deviations: Floats
    peaks: Floats  # largest displacements and accelerations as `PEAKS`, where it decides, (n, 4)
    counts: dict[str, NDArray[np.int32]]  # by `COUNTS`
    must_impact: NDArray[np.bool_]  # whether no motion without impacts exists

    @property
    def permanent_contact(self) -> NDArray[np.bool_]:
        """Whether any occurred in the samples' periods."""
        names = "touching", "contacts_before", "contacts_after"
        touching, before, after = (self.counts[name] for name in names)
        return (touching != 0) | (after > before)

    def select(self, indices: NDArray[np.intp]) -> Responses:
        counts = {name: numbers[indices] for name, numbers in self.counts.items()}
        parts = (counts if isinstance(part, dict) else part[indices] for part in self)
        return Responses._make(parts)


class PointRows(NamedTuple):
    """Of each operating point: what is set before its start, its period and its traits."""

    reals: Floats
    booleans: NDArray[np.bool_]
    periods: Floats
    traits: Floats  # as :func:`..fmu.oscillator.traits_for_loops` has them


def response_loop(instance: Instance) -> ResponseLoop:
    """Return the loop of an instance, made once."""
    loop: ResponseLoop | None = instance.cache.get(ResponseLoop)
    if loop is None:
        loop = instance.cache[ResponseLoop] = ResponseLoop(instance)
    return loop


class ResponseLoop:
    """Runs responses of one FMU instance, each with its structure and excitation."""

    def __init__(self, instance: Instance) -> None:
        self.oscillator = Oscillator.from_instance(instance)
        self.last_points: list[Point] = []
        self.last_rows: PointRows | None = None

    def simulate(
        self, points: Sequence[Point], starts: ArrayLike, settings: LoopSettings
    ) -> Responses:
        """Run a response at each point, from a start of each; of a chain from the first one's."""
        count, rows = len(points), self.point_rows(points)
        counts = np.zeros((count, len(COUNTS)), np.int32)
        results = Responses(
            states=np.empty((count, settings.samples, 4)),
            ends=np.empty((count, 4)),
            x_rel_max=np.empty(count),
            impacts=np.empty(count),
            deviations=np.zeros(count),
            peaks=np.zeros((count, len(PEAKS))),
            counts=dict(zip(COUNTS, counts.T, strict=True)),
            must_impact=rows.traits[:, -1] != 0.0,
        )
        piece = settings.compared if settings.known else MAX_WORK
        lengths = np.array([len(motion.states) for motion in settings.known], np.uintp)
        memory = np.empty(memory_size(max(settings.samples, *lengths.tolist(), 1)))
        transients = np.full(count, settings.transient, dtype=np.uint64)
        inputs = (transients, *rows, np.ascontiguousarray(starts, dtype=float), memory)
        task = ResponseTask(
            *(count, settings.samples, settings.peak_periods, piece),
            *(settings.tolerance, settings.loose, settings.chain_gap or 0.0),
            *(settings.decides, settings.is_chain, settings.chain_gap is not None),
            *(table.ctypes.data for table in (*inputs, *results[:6], counts)),
        )
        if settings.known:
            states = np.concatenate([motion.states for motion in settings.known])
            gaps = np.array([motion.gap for motion in settings.known])
            tables = (table.ctypes.data for table in (states, gaps, lengths))
            state = value_references(self.oscillator.instance, STATE)
            task.known = pointer(KnownMotions(len(gaps), state, *tables, settings.same))
        self.run_task(task)
        return results

    def run_task(self, task: ResponseTask) -> None:
        """Call the compiled loop until the task is done; it writes into the task's arrays."""
        progress, answer = ResponseProgress(), PAUSED
        while answer == PAUSED:
            answer = self.oscillator.call_loop("respond", byref(task), byref(progress), MAX_WORK)
        if answer == BROKEN:
            raise self.oscillator.error_of_last_call()

    def point_rows(self, points: Sequence[Point]) -> PointRows:
        """Return the rows of points, those of the last call if the points are the same."""
        if self.last_rows is not None and points == self.last_points:
            return self.last_rows
        different = {id(point): point for point in points}  # as of a basin: one for all starts
        index = {key: i for i, key in enumerate(different)}
        indices = np.array([index[id(point)] for point in points])
        names = self.oscillator.reals, self.oscillator.booleans
        sets = [
            {**START_VALUES, **point.structure.parameters(), **point.excitation.inputs()}
            for point in different.values()
        ]
        tables = (
            *(
                np.array([[row[name] for name in group] for row in sets], dtype=kind)
                for group, kind in zip(names, (float, bool), strict=True)
            ),
            np.array([point.excitation.period for point in different.values()]),
            np.array([traits_of_point(point) for point in different.values()]),
        )
        self.last_points = list(points)
        self.last_rows = PointRows(*(np.ascontiguousarray(table[indices]) for table in tables))
        return self.last_rows


def traits_of_point(point: Point) -> Any:
    excitation, pushed = point.excitation, any(point.excitation.pushes)
    return traits_for_loops(point.structure, excitation.frequency, excitation.amplitude, pushed)
