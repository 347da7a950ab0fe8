"""Run the master's communication steps in compiled C code, with bit-identical results.

``compiled.c`` calls the FMUs' functions itself, past Python: where both instances are native, the
drive's acceleration is connected and the library can be had, :func:`create_master` makes a master
that steps so. Structures are those of the C source.
"""

from __future__ import annotations

import ctypes
import functools
from array import array
from collections.abc import Iterable, Sequence
from contextlib import suppress
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p, pointer
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..fmu.c_library import loaded_function
from ..fmu.channel import Channel, SimulationEnded, StepAnswer
from ..fmu.instance import REAL_TYPES, WARNING, Instance
from .connection import MOTOR, Connection, Link
from .master import Master, Scheme
from .record import BOX, Record

SOURCE = Path(__file__).with_suffix(".c")
NOT_FINITE, NOT_WHOLE = -1, -2  # statuses that FMI does not have
MOST_INPUTS = 16  # of the drive, with the force and its derivatives


class FmuSide(ctypes.Structure):
    """Describe one FMU instance to the C library: handles, functions and buffers."""

    _fields_ = [
        *((name, c_void_p) for name in ("instance", "set", "get", "count")),
        *(
            (name, c_void_p)
            for name in ("step", "save", "restore", "real_status", "boolean_status")
        ),
        *((name, POINTER(c_uint)) for name in ("inputs", "outputs", "impacts")),
        *((name, c_size_t) for name in ("input_count", "output_count")),
        ("kept", POINTER(c_void_p)),
        ("answer", POINTER(StepAnswer)),
        ("failed", c_char_p),
        *((name, c_int) for name in ("status", "is_fmi3", "warned")),
    ]


class Links(ctypes.Structure):
    """Describe to the C library which of our variables are connected, and their units in SI."""

    _fields_ = [("count", c_int), ("places", c_int * 4), ("scales", c_double * 4)]

    @classmethod
    def of(cls, links: Sequence[tuple[int, Link]]) -> Links:
        """Describe the connections of one direction."""
        places, scales = (c_int * 4)(*(i for i, _ in links)), (one.scale for _, one in links)
        return cls(len(links), places, (c_double * 4)(*scales))


class Pair(ctypes.Structure):
    """Describe both FMU instances and the step settings to the C library."""

    _fields_ = [
        *((name, FmuSide) for name in ("oscillator", "drive")),
        *((name, c_double) for name in ("tolerance", "easy")),
        *((name, c_int) for name in ("halvings", "first_passes")),
        *((name, Links) for name in ("force", "motion")),
        ("cubic", c_int),
        ("recorded", POINTER(c_uint)),
        ("recorded_count", c_size_t),
        ("table", c_void_p),
    ]


@functools.cache
def load_step_function() -> Any:
    """Load the C function that runs communication steps, once; None if unavailable."""
    run = loaded_function(SOURCE)
    if run is None:
        return None
    run.argtypes = [*[c_void_p] * 5, c_int, c_double]
    return run


def create_master(
    oscillator: Instance,
    drive: Instance,
    scheme: Scheme,
    connection: Connection = MOTOR,
    start_time: float = 0.0,
) -> Master:
    """Create the master for two FMU instances, a compiled one where that is possible."""
    native = not any(one.description.needs_tool for one in (oscillator, drive))
    few = len(connection.links) + len(connection.inputs) <= MOST_INPUTS
    read = (drive.variable(name).type in REAL_TYPES for name in connection.recorded)
    can = native and few and BOX[2] in connection.links and all(read)
    kind = CompiledMaster if can and load_step_function() else Master
    return kind(oscillator, drive, scheme, connection, start_time)


class CompiledMaster(Master):
    """Couple two native FMUs as `Master` does, with steps run in compiled C code."""

    def run(self, inputs: ArrayLike, h: float | None = None) -> Record:
        """Run an interval for each row of the drive's inputs, held constant; return the record."""
        values = np.ascontiguousarray(inputs, dtype=float)
        values = values.reshape(len(values), self.width)
        return self._run_pieces(iter([array("d", values.tobytes())]), len(values), len(values), h)

    def run_controlled(
        self, inputs: Iterable[Sequence[float]], count: int, h: float | None = None
    ) -> Record:
        """Run a number of intervals; the inputs of each are asked for when it begins."""
        return self._run_pieces((array("d", values) for values in inputs), 1, count, h)

    def _run_pieces(
        self, pieces: Iterable[array[float]], size: int, count: int, h: float | None
    ) -> Record:
        """Run pieces of ``size`` intervals each, by the C function, into one record."""
        now, width = array("d", self.row), len(self.row)
        rows = np.empty((1 + self.scheme.most_rows(count), width))
        rows[0], ends, at = self.row, np.zeros(count, dtype=np.intc), 0
        recorded = np.empty((count, len(self.connection.recorded)))
        addresses, pair = (rows.ctypes.data, ends.ctypes.data), self._pair
        run, h = load_step_function(), h or self.scheme.h
        pair.table = recorded.ctypes.data
        intervals = 0
        for values in pieces:
            self.oscillator.begin()
            self.drive.channel.begin()
            into = addresses[0] + at * width * rows.itemsize
            known = now.buffer_info()[0], into, addresses[1] + intervals * ends.itemsize
            done = run(byref(pair), *known, values.buffer_info()[0], size, h)
            self.row = now.tolist()
            self._check(pair)
            ends[intervals : intervals + done] += at
            intervals += done
            at = int(ends[intervals - 1]) if intervals else 0
            if done < size:
                break
        return Record.of_rows(self.names, rows[: at + 1], ends[:intervals], recorded[:intervals])

    @functools.cached_property
    def _pair(self) -> Pair:
        """Describe both FMUs and the scheme in the C structure."""
        pair = Pair(fill_fmu_side(self.oscillator), fill_fmu_side(self.drive.channel))
        impacts = self.oscillator.instance.variable("impact_count").valueReference
        pair.oscillator.impacts = pointer(c_uint(impacts))
        for name in ("tolerance", "easy", "halvings", "first_passes"):
            setattr(pair, name, getattr(self.scheme, name))
        pair.first_passes = self.scheme.first_passes if self.goes_back else 1
        pair.force, pair.motion = Links.of(self.drive.forces), Links.of(self.drive.motions)
        recorded, instance = self.connection.recorded, self.drive.instance
        names = [instance.variable(name).valueReference for name in recorded]
        pair.cubic, pair.recorded = self.connection.cubic, (c_uint * len(names))(*names)
        pair.recorded_count = len(names)
        return pair

    def _check(self, pair: Pair) -> None:
        """Raise what ended the run, keep warnings; an FMU that ended the simulation is no error."""
        sides = (self.oscillator, pair.oscillator), (self.drive.channel, pair.drive)
        for channel, side in sides:
            if side.warned:
                channel.instance.check("the step", WARNING)
                side.warned = 0
            if side.status == NOT_FINITE:
                channel.get()  # it raises
            if side.status in (0, NOT_WHOLE) or side.failed == b"the step":
                with suppress(SimulationEnded):
                    channel.check_step(max(side.status, 0))
            else:
                raise channel.instance.refusal(side.failed.decode(), side.status)


def fill_fmu_side(channel: Channel) -> FmuSide:
    """Fill the C structure of one FMU instance; keep its channel alive while it is used."""
    pointers = channel.pointers()
    is_fmi3 = channel.instance.is_fmi3
    kept, answer = pointer(pointers.saved_state), pointer(pointers.answer)
    return FmuSide(
        *(pointers.instance, *pointers.functions, pointers.inputs, pointers.outputs, None),
        *(len(pointers.inputs), len(pointers.outputs), kept, answer, None, 0, is_fmi3, 0),
    )
