"""Run the master's communication steps in compiled C code, with bit-identical results.

``compiled.c`` calls the FMUs' functions itself, past Python: where two FMI 3.0 instances are native
and the library can be had, :func:`create_master` makes a master that steps so. Structures are those
of the C source.
"""

from __future__ import annotations

import ctypes
import functools
import logging
from array import array
from collections.abc import Sequence
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p, pointer
from pathlib import Path
from typing import Any

import numpy as np

from ..access.c_library import loaded_function
from ..access.channel import Channel
from ..access.instance import Instance
from ..errors import FmuError
from ..structures.structure import Structure
from .extremes import Revolution, position_in_balance
from .master import ALGORITHMS, Master, Scheme

log = logging.getLogger(__name__)
SOURCE = Path(__file__).with_suffix(".c")
PLACES = tuple(Revolution.__dataclass_fields__)


class FmuSide(ctypes.Structure):
    """Describe one FMU instance to the C library: handles, functions and buffers."""

    _fields_ = [
        *((name, c_void_p) for name in ("instance", "set", "get", "step", "save", "restore")),
        *((name, POINTER(c_uint)) for name in ("inputs", "outputs")),
        *((name, c_size_t) for name in ("input_count", "output_count")),
        ("kept", POINTER(c_void_p)),
        ("failed", c_char_p),
        ("status", c_int),
    ]


class Pair(ctypes.Structure):
    """Describe both FMU instances, the structure and the step settings to the C library."""

    _fields_ = [
        ("oscillator", FmuSide),
        ("shaker", FmuSide),
        *((name, c_double) for name in ("m1", "m2", "k1", "k2", "d1", "d2")),
        *((name, c_double) for name in ("preload", "rest_1", "rest_2", "balance")),
        *((name, c_double) for name in ("tolerance", "easy", "converged")),
        *((name, c_int) for name in ("passes", "terms", "iterations", "matched", "halvings")),
        ("part_count", c_int),
        ("parts", POINTER(c_int)),
    ]


@functools.cache
def load_step_function() -> Any:
    """Load the C function that runs communication steps, once; None if unavailable."""
    run = loaded_function(SOURCE)
    if run is None:
        return None
    run.argtypes = [*[c_void_p] * 4, c_int, c_int, c_double, c_void_p]
    return run


def create_master(
    oscillator: Instance,
    shaker: Instance,
    structure: Structure,
    scheme: Scheme,
    start_time: float = 0.0,
) -> Master:
    """Create the master for two FMU instances, a compiled one where that is possible."""
    native = all(
        channel.is_fmi3 and not channel.description.needs_tool for channel in (oscillator, shaker)
    )
    kind = CompiledMaster if native and load_step_function() else Master
    return kind(oscillator, shaker, structure, scheme, start_time)


class CompiledMaster(Master):
    """Couple two native FMUs as `Master` does, with steps run in compiled C code."""

    def __init__(
        self,
        oscillator: Instance,
        shaker: Instance,
        structure: Structure,
        scheme: Scheme,
        start_time: float = 0.0,
    ) -> None:
        """Prepare the buffers that the C library reads and writes."""
        super().__init__(oscillator, shaker, structure, scheme, start_time)
        self._run = load_step_function()
        self._pair = fill_pair(self.oscillator, self.shaker, structure, scheme)
        self._memory = array("d", self.get_state())
        self._seen = array("d", bytes(8 * len(PLACES)))

    def step(self, voltage: float, h: float | None = None) -> None:
        """Run one communication interval at a constant voltage, V."""
        self.run(array("d", (voltage,)), 0, h)

    def run(
        self,
        voltages: Sequence[float],
        first: int = 0,
        h: float | None = None,
        kept: np.ndarray | None = None,
    ) -> int:
        """Run communication intervals until a revolution ends; return the next index."""
        buffer = voltages if isinstance(voltages, array) else array("d", voltages)
        if kept is not None:
            rows = len(buffer), len(self._memory)
            assert kept.shape == rows and kept.flags.c_contiguous and kept.dtype == np.float64
        revolution = self.revolution
        if revolution:
            self._seen[:] = array("d", (getattr(revolution, name) for name in PLACES))
        self.oscillator.begin()
        self.shaker.begin()
        done = self._run(
            *(byref(self._pair), buffer_address(self._memory)),
            *(buffer_address(self._seen) if revolution else None, buffer_address(buffer)),
            *(first, len(buffer), h or self.scheme.h),
            None if kept is None else kept.ctypes.data,
        )
        if done < 0:
            raise self._failure()
        super().set_state(self._memory.tolist())
        if revolution:
            for name, value in zip(PLACES, self._seen, strict=True):
                setattr(revolution, name, value)
        return int(done)

    def _failure(self) -> FmuError:
        """Build the error for the FMU instance whose step failed."""
        pair = self._pair
        for channel, side in ((self.oscillator, pair.oscillator), (self.shaker, pair.shaker)):
            if side.status:
                return channel.failure(side.failed.decode(), side.status)
        raise AssertionError("a step failed, and none of both sides")

    def set_state(self, numbers: Sequence[float]) -> None:
        """Restore the master's state, also in the C library's buffer."""
        super().set_state(numbers)
        self._memory[:] = array("d", numbers)


def buffer_address(numbers: array[float]) -> int:
    """Return the memory address of an array's first number."""
    return numbers.buffer_info()[0]


def fill_pair(oscillator: Channel, shaker: Channel, structure: Structure, scheme: Scheme) -> Pair:
    """Fill the C structure with both FMU instances, the structure and the step settings."""
    pair = Pair(fill_fmu_side(oscillator), fill_fmu_side(shaker))
    for name in ("m1", "m2", "k1", "k2", "d1", "d2", "preload"):
        setattr(pair, name, getattr(structure, name))
    pair.rest_1, pair.rest_2 = structure.at_rest
    pair.balance = position_in_balance(structure)
    for name in ("tolerance", "easy", "converged", "passes", "matched", "halvings"):
        setattr(pair, name, getattr(scheme, name))
    pair.terms = ALGORITHMS[scheme.algorithm].terms
    pair.iterations = ALGORITHMS["iterated"].passes
    pair.part_count = len(scheme.beginning)
    pair.parts = (c_int * len(scheme.beginning))(*scheme.beginning)
    return pair


def fill_fmu_side(channel: Channel) -> FmuSide:
    """Fill the C structure of one FMU instance; keep its channel alive while it is used."""
    pointers = channel.pointers()
    counts = len(pointers.inputs), len(pointers.outputs)
    return FmuSide(
        *(pointers.instance, *pointers.functions),
        *(pointers.inputs, pointers.outputs),
        *(*counts, pointer(pointers.saved_state)),
    )
