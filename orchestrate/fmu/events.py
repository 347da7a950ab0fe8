"""A motion computed impact by impact, through the events of FMI 3.0, by compiled code.

The FMI 3.0 form returns early from a step at each impact, at its exact time. Between impacts the
motion does not depend on the steps, so states sampled in a second run belong to the same motion to
the last bit. The loop is ``fmu_src/kernels/loops/play.c``, which calls the FMU's functions itself,
past Python; it sets inputs at nodes, as cubics that run on from there.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import POINTER, byref, c_bool, c_double, c_size_t, c_uint, c_void_p
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import FmuError, InputError
from ..model import Excitation, Structure
from .c_library import load_loop
from .fmi import BROKEN, NOT_FINITE, PAUSED, Fmi, value_references
from .impacts import EVENT_OUTPUTS, Impacts
from .instance import Instance
from .oscillator import REST, start_motion

Floats = NDArray[np.float64]
IMPACT_CAPACITY = 1024  # impacts in the buffer that the loop fills
MAX_STEPS = 200_000  # of one call: between two of them an interrupt is heard
NO_INPUT, NO_TIMES = np.empty((1, 0)), np.empty(0)
BOX = "box_acceleration"
CUBICS = {  # inputs by the quantity that they make a cubic of
    BOX: (BOX, "box_jerk", "box_snap", "box_crackle"),
    **{name: (name, *(f"{name}_{n}" for n in (1, 2, 3))) for name in ("force1", "force2")},
}
PLAYED = ("x1", "x2", "v1", "v2", "x_rel", "v_rel", "contact_force")


class PlayedMotion(NamedTuple):
    """Result of an event loop: outputs and contact flags at the sampling times, and all impacts."""

    rows: Floats  # the outputs at each time
    touching: NDArray[np.bool_]  # whether the masses were in permanent contact
    impacts: Impacts


class PlayerCalls(ctypes.Structure):
    """C struct of an instance, and of the variables that are set and read."""

    _fields_ = [
        ("fmi", Fmi),
        *((name, POINTER(c_uint)) for name in ("inputs", "outputs", "impact_outputs", "contact")),
        *((name, c_size_t) for name in ("input_count", "output_count", "impact_output_count")),
    ]


class PlayTask(ctypes.Structure):
    """C struct of what there is to do: addresses, sizes of input pieces and sample times."""

    _fields_ = [
        *((name, c_void_p) for name in ("nodes", "derivatives", "samples")),
        *((name, c_size_t) for name in ("piece_count", "sample_count")),
        *((name, c_void_p) for name in ("rows", "contacts", "impacts")),
        *((name, c_size_t) for name in ("impact_capacity", "max_steps")),
    ]


class PlayProgress(ctypes.Structure):
    """C struct of what is done: how many pieces, samples and impacts."""

    _fields_ = [
        ("time", c_double),
        *((name, c_size_t) for name in ("piece", "sample", "impact")),
        ("piece_is_set", c_bool),
    ]


class EventLoop:
    """Steps an FMU through its events, setting inputs at nodes; collects samples and impacts."""

    def __init__(
        self, instance: Instance, inputs: Sequence[str] = (), outputs: Sequence[str] = ()
    ) -> None:
        self.instance, self.inputs, self.outputs = instance, tuple(inputs), tuple(outputs)
        self._play = load_loop("play").play
        self._play.argtypes = [c_void_p] * 3
        self._buffer = np.empty((IMPACT_CAPACITY, len(EVENT_OUTPUTS) + 2))
        names = self.inputs, self.outputs, EVENT_OUTPUTS, ("in_contact",)
        self._calls = PlayerCalls(
            Fmi.from_instance(instance),
            *(value_references(instance, group) for group in names),
            *map(len, names[:3]),
        )

    def run(self, nodes: Floats, derivatives: Floats, samples: Floats) -> PlayedMotion:
        """Step from the first node to the last; set inputs at nodes, read outputs at samples."""
        arrays = [np.ascontiguousarray(part, float) for part in (nodes, derivatives, samples)]
        if arrays[1].shape != (len(nodes) - 1, len(self.inputs)):
            raise ValueError(f"derivatives of shape {derivatives.shape} for {len(nodes)} nodes")
        rows = np.empty((len(samples), len(self.outputs)))
        touching = np.empty(len(samples), dtype=bool)
        counts = len(nodes) - 1, len(samples)
        outputs = (part.ctypes.data for part in (rows, touching, self._buffer))
        inputs = (part.ctypes.data for part in arrays)
        task = PlayTask(*inputs, *counts, *outputs, len(self._buffer), MAX_STEPS)
        progress = PlayProgress(time=float(nodes[0]))
        pointers, tables, answer = (byref(self._calls), byref(task), byref(progress)), [], PAUSED
        while answer == PAUSED:
            self.instance._messages.clear()
            answer = self._play(*pointers)
            if answer == BROKEN:
                raise self._failure(rows, progress)
            tables.append(self._buffer[: progress.impact].copy())
        return PlayedMotion(rows, touching, Impacts.from_table(np.concatenate(tables)))

    def _failure(self, rows: Floats, progress: PlayProgress) -> FmuError:
        fmi: Fmi = self._calls.fmi
        if fmi.status != NOT_FINITE:
            return fmi.error_of_failed_call(self.instance)
        read = rows[max(progress.sample - 1, 0) : progress.sample]
        if not np.isfinite(read).all():
            return self.instance.not_finite_error(self.outputs, read[0])
        values = self._buffer[progress.impact, 1:-1]
        return self.instance.not_finite_error(EVENT_OUTPUTS, values)


class EventInstance(Instance):
    """FMI 3.0 FMU instance that stops at each impact, so that all impacts can be read exactly."""

    EVENTS = {"eventModeUsed": True, "earlyReturnAllowed": True}

    def __init__(self, path: str | PathLike[str]) -> None:
        self._loops: dict[tuple[tuple[str, ...], ...], EventLoop] = {}
        super().__init__(path)
        if not self.is_fmi3:
            version = self.description.fmi_version
            self.close()
            raise InputError(f"FMU {path}: is FMI {version}; expected FMI 3.0, which has events")

    def record_impacts(self, time: float, target: float) -> Impacts:
        """Step from a time to another; return the impacts between."""
        return self.event_loop().run(np.array([time, target]), NO_INPUT, NO_TIMES).impacts

    def event_loop(self, inputs: Sequence[str] = (), outputs: Sequence[str] = ()) -> EventLoop:
        """Return the loop of these variables, made once."""
        key = tuple(inputs), tuple(outputs)
        if key not in self._loops:
            self._loops[key] = EventLoop(self, *key)
        return self._loops[key]


class Player(EventInstance):
    """Oscillator FMU instance that simulates motions under inputs given as cubics."""

    def start(
        self, structure: Structure, start: ArrayLike = REST, excitation: Excitation | None = None
    ) -> None:
        """Start a motion at time 0; an excitation acts besides the cubics, by default none."""
        at_rest = Excitation(frequency=structure.omega, amplitude=0.0)
        start_motion(self, structure, excitation or at_rest, start)

    def play(
        self,
        nodes: Floats,
        derivatives: Floats,
        samples: Floats,
        outputs: Sequence[str] = PLAYED,
        driven: Sequence[str] = (BOX,),
    ) -> PlayedMotion:
        """Simulate under consecutive cubics of driven quantities; return samples and impacts."""
        inputs = (*(name for quantity in driven for name in CUBICS[quantity]),)
        return self.event_loop(inputs, tuple(outputs)).run(nodes, derivatives, samples)
