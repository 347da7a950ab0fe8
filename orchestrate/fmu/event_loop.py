"""The loop that steps an FMU through its events under piecewise inputs: samples and impacts.

``event_loop.c`` calls the FMU's functions itself, past Python: where the FMU is native and the
library can be had, :func:`event_loop_of` makes a loop that runs so. The calls and their order are
the same, so are the bits.
"""

from __future__ import annotations

import ctypes
import functools
import logging
from collections.abc import Sequence
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import FmuError
from .c_library import loaded_function
from .channel import Channel
from .impacts import EVENT_OUTPUTS, Impacts
from .instance import function_addresses
from .stepping import SteppingInstance

log = logging.getLogger(__name__)
Floats = NDArray[np.float64]
SOURCE = Path(__file__).with_suffix(".c")
FUNCTIONS = (  # as Calls of the C source has them
    *("SetFloat64", "GetFloat64", "GetBoolean", "DoStep"),
    *("EnterEventMode", "UpdateDiscreteStates", "EnterStepMode"),
)
FAILED, DONE = -1, 0
OUTPUTS_NOT_FINITE, IMPACT_NOT_FINITE = -1, -2  # statuses that FMI does not have
IMPACT_CAPACITY = 1024  # impacts in the buffer that the compiled loop fills
MAX_STEPS = 200_000  # of one call: between two of them an interrupt is heard


class Played(NamedTuple):
    """Result of an event loop: outputs and contact flags at the sampling times, and all impacts."""

    rows: Floats  # the outputs at each time
    touching: NDArray[np.bool_]  # whether the masses were in permanent contact
    impacts: Impacts


class Calls(ctypes.Structure):
    """C struct for the compiled event loop: FMI function addresses and buffers of an instance."""

    _fields_ = [
        *((name, c_void_p) for name in ("instance", *FUNCTIONS)),
        *((name, POINTER(c_uint)) for name in ("inputs", "outputs", "impact_outputs", "contact")),
        *((name, c_size_t) for name in ("input_count", "output_count", "impact_output_count")),
        ("failed", c_char_p),
        ("status", c_int),
    ]


class Task(ctypes.Structure):
    """C struct for the compiled event loop: addresses, sizes of input pieces and sample times."""

    _fields_ = [
        *((name, c_void_p) for name in ("nodes", "derivatives", "samples")),
        *((name, c_size_t) for name in ("piece_count", "sample_count")),
        *((name, c_void_p) for name in ("rows", "contacts", "impacts")),
        *((name, c_size_t) for name in ("impact_capacity", "max_steps")),
    ]


class Progress(ctypes.Structure):
    """C struct of the compiled event loop: how many pieces, samples and impacts are done."""

    _fields_ = [
        ("time", c_double),
        *((name, c_size_t) for name in ("piece", "sample", "impact")),
        ("piece_is_set", c_int),
    ]


@functools.cache
def run_function() -> Any:
    """Load the event loop's C function by ctypes, types set; return None without a library."""
    run = loaded_function(SOURCE)
    if run is None:
        return None
    run.argtypes = [c_void_p] * 3
    return run


def event_loop_of(
    instance: SteppingInstance, inputs: Sequence[str] = (), outputs: Sequence[str] = ()
) -> EventLoop:
    """Return an event loop for an FMU instance: compiled C where possible, else Python."""
    native = not instance.description.needs_tool
    kind = CompiledEventLoop if native and run_function() else EventLoop
    return kind(instance, inputs, outputs)


class EventLoop:
    """Steps an FMU through its events, setting inputs at nodes; collects samples and impacts."""

    def __init__(
        self, instance: SteppingInstance, inputs: Sequence[str] = (), outputs: Sequence[str] = ()
    ) -> None:
        self.instance, self.inputs, self.outputs = instance, tuple(inputs), tuple(outputs)
        self.channel = Channel(instance, inputs, outputs)
        self.events = Channel(instance, (), EVENT_OUTPUTS)

    def run(self, nodes: Floats, derivatives: Floats, samples: Floats) -> Played:
        """Simulate under inputs given at nodes; return outputs at the samples, and impacts."""
        step, handle = self.instance.stepper(), self.instance.event_handler()
        touch = self.instance.flag("in_contact")
        rows, touching = self._tables(samples)
        table: list[list[float]] = []

        def advance(time: float, target: float) -> float:
            while time < target:
                event, time = step(time, target - time)
                if event:
                    table.append([time, *self.events.get(), touch()])
                    handle()
            return time

        def read(index: int) -> None:
            if self.outputs:
                rows[index] = self.channel.get()
            touching[index] = touch()

        time, done = float(nodes[0]), 0
        ends = np.searchsorted(samples, nodes[1:], side="left").tolist()
        for values, target, last in zip(
            derivatives.tolist(), nodes[1:].tolist(), ends, strict=True
        ):
            if self.inputs:
                self.channel.put(*values)
            for index in range(done, last):
                time = advance(time, float(samples[index]))
                read(index)
            time, done = advance(time, target), last
        for index in range(done, len(samples)):  # at the last node
            read(index)
        return Played(rows, touching, Impacts.from_table(np.array(table)))

    def _tables(self, samples: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Return two empty result arrays: outputs (samples, outputs), contact flags."""
        return np.empty((len(samples), len(self.outputs))), np.empty(len(samples), dtype=bool)


class CompiledEventLoop(EventLoop):
    """The event loop in compiled C: same arguments and same results as :class:`EventLoop`."""

    def __init__(
        self, instance: SteppingInstance, inputs: Sequence[str] = (), outputs: Sequence[str] = ()
    ) -> None:
        super().__init__(instance, inputs, outputs)
        self._run = run_function()
        self._buffer = np.empty((IMPACT_CAPACITY, len(EVENT_OUTPUTS) + 2))
        names = self.inputs, self.outputs, EVENT_OUTPUTS, ("in_contact",)
        self._calls = Calls(
            *function_addresses(instance, FUNCTIONS),
            *(references(instance, some) for some in names),
            *map(len, names[:3]),
        )

    def run(self, nodes: Floats, derivatives: Floats, samples: Floats) -> Played:
        """Simulate under inputs given at nodes, in C; same results as :meth:`EventLoop.run`."""
        arrays = [np.ascontiguousarray(part, float) for part in (nodes, derivatives, samples)]
        if arrays[1].shape != (len(nodes) - 1, len(self.inputs)):
            raise ValueError(f"derivatives of shape {derivatives.shape} for {len(nodes)} nodes")
        rows, touching = self._tables(samples)
        counts = len(nodes) - 1, len(samples)
        outputs = (part.ctypes.data for part in (rows, touching, self._buffer))
        inputs = (part.ctypes.data for part in arrays)
        task = Task(*inputs, *counts, *outputs, len(self._buffer), MAX_STEPS)
        progress = Progress(time=float(nodes[0]))
        pointers, tables, answer = (byref(self._calls), byref(task), byref(progress)), [], 1
        while answer != DONE:
            self.channel.begin()
            answer = self._run(*pointers)
            if answer == FAILED:
                raise self._failure(rows, progress)
            tables.append(self._buffer[: progress.impact].copy())
        return Played(rows, touching, Impacts.from_table(np.concatenate(tables)))

    def _failure(self, rows: Floats, progress: Progress) -> FmuError:
        """Return the ``FmuError`` for the status at which the C loop stopped."""
        status = self._calls.status
        if status == OUTPUTS_NOT_FINITE:
            return self.instance.not_finite_error(self.outputs, rows[progress.sample - 1])
        if status == IMPACT_NOT_FINITE:
            values = self._buffer[progress.impact, 1:-1]
            return self.instance.not_finite_error(EVENT_OUTPUTS, values)
        return self.instance.refusal(self._calls.failed.decode(), status)


def references(instance: SteppingInstance, names: Sequence[str]) -> Any:
    """Return the FMI value references of variables, given by name, as a ctypes array."""
    return (c_uint * len(names))(*(instance.variable(name).valueReference for name in names))
