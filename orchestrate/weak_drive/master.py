"""Step the oscillator and its drive together, by the compiled loop ``couple.c``.

What is exchanged, and in which order, stands there; here an instance of each is described to it,
and its answers are read.
"""

from __future__ import annotations

import ctypes
import functools
import math
from collections.abc import Iterable, Sequence
from contextlib import suppress
from ctypes import POINTER, byref, c_double, c_int, c_size_t, c_uint, c_void_p, pointer
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..fmu.c_library import load_loop
from ..fmu.channel import Channel, SimulationEnded, StepAnswer
from ..fmu.events import CUBICS
from ..fmu.fmi import NOT_FINITE, Fmi, value_references
from ..fmu.instance import REAL_TYPES, WARNING, Instance, function_addresses
from ..model.ranges import checked_range
from .connection import FORCE, MOTOR, PUSHES, Connection, Link
from .step_record import BOX, LEADING, PLACE, OscillatorOutputs, Record

CUBIC = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
TIME = PLACE["time"]
MOTION, DRIVE = PLACE["x1"], PLACE[BOX[0]]
END = DRIVE + len(BOX)
FORCE_PLACE = OscillatorOutputs._fields.index("box_force")
PAST = 4  # points that are remembered where acceleration and velocity are not both connected
MEMORY = {"inverse_mass": 2, "held": 1, "owed": 2}  # of the force, between steps
PUSH_MEMORY = {"push_count": 1, "push_points": (PAST - 1) * (1 + len(PUSHES))}
MEMORY |= PUSH_MEMORY  # of the drive's forces on the halves
NOT_WHOLE = -2  # a status that FMI does not have
MAX_STEPS = 1e9  # of a run: more is a typing error, it would run for weeks
MAX_STEPS_KEPT = 10_000_000  # of a run of which every step is kept in memory


@dataclass(frozen=True)
class Scheme:
    """Set the communication step and its error control."""

    # communication interval, s: the longest step, and all of them without `tolerance`
    h: float = 0.1
    tolerance: float = 0.0  # of the step control; 0: all steps are `h`
    halvings: int = 6  # how often `h` is halved at most
    easy: float = 1.0 / 64.0  # part of the tolerance
    first_passes: int = 3  # of the first step, where the drive can go back
    halves_discarded: bool = False  # a step that the drive discards, where it can go back

    def __post_init__(self) -> None:
        checked_range("step", self.h, "s", low=0.0, open_low=True)
        checked_range("tolerance", self.tolerance, "(0 leaves steps as they are)", low=0.0)


STATES: dict[int, tuple[str, ...]] = {3: ("GetFMUState", "SetFMUState", "FreeFMUState")}
STATES[2] = ("GetFMUstate", "SetFMUstate", "FreeFMUstate", "GetRealStatus", "GetBooleanStatus")


class Side(ctypes.Structure):
    """C struct of one FMU instance: functions, variables and buffers."""

    _fields_ = [
        ("fmi", Fmi),
        *((name, c_void_p) for name in ("save", "restore", "release")),
        *((name, c_void_p) for name in ("real_status", "boolean_status")),
        *((name, POINTER(c_uint)) for name in ("inputs", "outputs", "impacts")),
        *((name, c_size_t) for name in ("input_count", "output_count")),
        ("kept", POINTER(c_void_p)),
        ("answer", POINTER(StepAnswer)),
        ("keeps_anew", c_int),
    ]

    @classmethod
    def from_channel(cls, channel: Channel, impacts: Sequence[str] = ()) -> Side:
        """Describe the instance of a channel; the channel frees the state that is kept."""
        instance = channel.instance
        fmi = Fmi.from_instance(instance)
        _, *states = function_addresses(instance, STATES[fmi.version])
        rest = [None] * (len(STATES[2]) - len(states))
        inputs, outputs = channel.input_and_output_references()
        buffers = (pointer(channel.kept), pointer(channel.answer))
        counts = (len(inputs), len(outputs))
        names = (inputs, outputs, value_references(instance, impacts))
        return cls(fmi, *states, *rest, *names, *counts, *buffers, instance.description.needs_tool)


class Links(ctypes.Structure):
    """C struct of our variables that are connected, with the size of their units in SI."""

    _fields_ = [("count", c_int), ("places", c_int * 4), ("scales", c_double * 4)]

    @classmethod
    def from_numbered(cls, links: Sequence[tuple[int, Link]]) -> Links:
        places, scales = (c_int * 4)(*(i for i, _ in links)), (one.scale for _, one in links)
        return cls(len(links), places, (c_double * 4)(*scales))


class Pair(ctypes.Structure):
    """C struct of both FMU instances, the scheme and what is remembered between steps."""

    _fields_ = [
        *((name, Side) for name in ("oscillator", "drive")),
        *((name, c_double) for name in ("tolerance", "easy")),
        *((name, c_int) for name in ("halvings", "first_passes", "halves_discarded")),
        *((name, Links) for name in ("force", "motion", "pushes")),
        ("cubic", c_int),
        ("recorded", POINTER(c_uint)),
        ("recorded_count", c_size_t),
        ("table", c_void_p),
        ("stride", c_size_t),
        ("scratch", POINTER(c_double)),
        ("points", c_double * (2 * PAST)),
        ("point_count", c_int),
        *((name, c_double * count) for name, count in MEMORY.items()),
    ]


@functools.cache
def load_couple_loop() -> Any:
    library = load_loop("couple")
    sizes = (c_uint * 4).in_dll(library, "sizes_of_couple")
    assert [*sizes] == [ctypes.sizeof(Pair), MOTION, DRIVE, END + MOTOR.outputs.index("angle")]
    library.couple.argtypes = [*[c_void_p] * 5, c_int, c_double]
    return library.couple


class DriveSide:
    """The drive's FMU: what is set and read, by our names and in SI."""

    def __init__(self, instance: Instance, connection: Connection) -> None:
        links, self.instance = connection.links, instance
        self.forces = [(i, links[name]) for i, name in enumerate(FORCE) if name in links]
        self.motions = [(i, links[name]) for i, name in enumerate(BOX) if name in links]
        self.pushes = [(i, links[name]) for i, name in enumerate(PUSHES) if name in links]
        forces = (*self.motions, *self.pushes)
        self.channel = Channel(
            instance,
            (*(link.theirs for _, link in self.forces), *connection.inputs),
            (*(link.theirs for _, link in forces), *connection.outputs),
        )

    def set_inputs(self, force: Sequence[float], inputs: Sequence[float]) -> None:
        self.channel.set_inputs(*(force[i] / link.scale for i, link in self.forces), *inputs)

    def read_outputs(self) -> list[float]:
        """Return the box's motion, NaN for what is not connected, forces, and other outputs."""
        values = self.channel.get_outputs()
        box = [math.nan] * len(BOX)
        for (i, link), value in zip(self.motions, values, strict=False):
            box[i] = link.scale * value
        rest = values[len(self.motions) :]
        forces = [link.scale * x for (_, link), x in zip(self.pushes, rest, strict=False)]
        return [*box, *forces, *rest[len(forces) :]]


class Master:
    """Step two initialised FMU instances together and exchange force and acceleration."""

    def __init__(
        self,
        oscillator: Instance,
        drive: Instance,
        scheme: Scheme,
        connection: Connection = MOTOR,
        inverse_mass: float = 0.0,
    ) -> None:
        """Begin a run; ``inverse_mass`` (1/kg) is of a drive that takes a held force only."""
        pushes = connection.connected_pushes
        cubics = (*(name for push in pushes for name in CUBICS[push]),)
        self.oscillator = Channel(oscillator, (*CUBIC, *cubics), OscillatorOutputs._fields)
        self.drive, self.scheme = DriveSide(drive, connection), scheme
        self.connection = connection
        then = (*(f"{name}_then" for name in cubics),)
        self.names = (*LEADING, *pushes, *connection.outputs, *then, *connection.inputs)
        self.inputs = slice(len(self.names) - len(connection.inputs), len(self.names))
        self.pair, holds_force = self._make_pair(), len(self.drive.forces) < len(FORCE)
        self.inverse_mass = inverse_mass if holds_force else 0.0
        self.reset()

    def reset(self) -> None:
        """Begin anew at the state that both instances are in."""
        unknown = [math.nan] * len(self.connection.inputs)
        step, motion = [0.0] * (MOTION - TIME), self.oscillator.get_outputs()
        # its acceleration follows the force
        self.drive.set_inputs((motion[FORCE_PLACE], 0.0, 0.0, 0.0), ())
        then = [0.0] * (4 * len(self.connection.connected_pushes))
        self.row = [*step, *motion, *self.drive.read_outputs(), *then, *unknown]
        for name, count in MEMORY.items():
            getattr(self.pair, name)[:] = [self.inverse_mass * (name == "inverse_mass")] * count
        self.pair.point_count = 0

    @property
    def time(self) -> float:
        """Return the time reached, s."""
        return self.row[TIME]

    @property
    def motion(self) -> OscillatorOutputs:
        return OscillatorOutputs._make(self.row[MOTION:DRIVE])

    def __getitem__(self, name: str) -> float:
        """Return a value at the present time, by the name of its column in a record."""
        return self.row[self.names.index(name)]

    def step(self, *inputs: float) -> Record:
        """Run one communication interval with constant inputs of the drive."""
        return self.run([inputs])

    def run(self, inputs: ArrayLike, h: float | None = None) -> Record:
        """Run an interval for each row of the drive's inputs, held constant; return the record."""
        values = np.ascontiguousarray(inputs, dtype=float)
        rows = values.reshape(len(values), self.input_width)
        size = 1 if self._reads_recorded_in_python else max(1, len(rows))
        pieces = (rows[i : i + size] for i in range(0, len(rows), size))
        return self._run_pieces(pieces, len(rows), h)

    def run_controlled(
        self, inputs: Iterable[Sequence[float]], count: int, h: float | None = None
    ) -> Record:
        """Run intervals whose inputs are asked for as each begins; fewer if an FMU ends the run."""
        return self._run_pieces((np.array([row], dtype=float) for row in inputs), count, h)

    def _run_pieces(
        self, pieces: Iterable[NDArray[np.float64]], count: int, h: float | None
    ) -> Record:
        now, halves = np.array(self.row), self.scheme.tolerance or self.scheme.halves_discarded
        max_steps = count << self.scheme.halvings if halves else count
        rows = np.empty((1 + max_steps, len(now)))
        rows[0], ends, at, intervals = self.row, np.zeros(count, dtype=np.intc), 0, 0
        recorded = np.empty((count, len(self.connection.recorded)))
        self.pair.table = recorded.ctypes.data
        for values in pieces:
            self.oscillator.clear_messages()
            self.drive.channel.clear_messages()
            buffers = (now, rows[at:], ends[intervals:], values)
            addresses = (one.ctypes.data for one in buffers)
            done = load_couple_loop()(byref(self.pair), *addresses, len(values), h or self.scheme.h)
            self.row = now.tolist()
            self._check_answers()
            ends[intervals : intervals + done] += at
            if done and self._reads_recorded_in_python:
                own = len(self.connection.inputs)
                recorded[intervals] = self.read_recorded(values[0, own:].tolist())
            intervals += done
            at = int(ends[intervals - 1]) if intervals else 0
            if done < len(values) or self.end_reason:
                break
        columns = np.ascontiguousarray(rows[: at + 1].T)
        return Record(self.names, columns, ends[:intervals].astype(np.intp), recorded[:intervals])

    @functools.cached_property
    def _reads_recorded_in_python(self) -> bool:
        """Whether something is recorded that is no real number: the loop does not read that."""
        kinds = (self.drive.instance.variable(n).type for n in self.connection.recorded)
        return not all(kind in REAL_TYPES for kind in kinds)

    @property
    def end_reason(self) -> str:
        """Return at what time, and why, an FMU ended the simulation; empty if none did."""
        return self.drive.channel.ended or self.oscillator.ended

    @property
    def input_width(self) -> int:
        """Return how many inputs of the drive a row of :meth:`run` has."""
        return len(self.connection.inputs) * (2 if self.connection.recorded else 1)

    def read_recorded(self, inputs: Sequence[float]) -> list[float]:
        self.drive.set_inputs((self.row[MOTION + FORCE_PLACE], 0.0, 0.0, 0.0), inputs)
        return [float(value) for value in self.drive.instance.get(*self.connection.recorded)]

    def _make_pair(self) -> Pair:
        connection, drive = self.connection, self.drive
        oscillator = Side.from_channel(self.oscillator, ["impact_count"])
        pair = Pair(oscillator, Side.from_channel(drive.channel))
        for name in ("tolerance", "easy", "halvings"):
            setattr(pair, name, getattr(self.scheme, name))
        goes_back = drive.instance.description.has_states
        pair.first_passes = self.scheme.first_passes if goes_back else 1
        pair.halves_discarded = self.scheme.halves_discarded and goes_back
        pair.force, pair.motion, pair.pushes = map(
            Links.from_numbered, (drive.forces, drive.motions, drive.pushes)
        )
        names = () if self._reads_recorded_in_python else connection.recorded
        pair.cubic, pair.recorded = connection.first_cubic, value_references(drive.instance, names)
        pair.recorded_count, pair.stride = len(names), self.input_width
        pair.scratch = (c_double * (2 * pair.drive.input_count))()
        return pair

    def _check_answers(self) -> None:
        """Raise what ended the run, keep warnings; an FMU that ended the simulation is no error."""
        sides = (self.pair.oscillator.fmi, self.pair.drive.fmi)
        for channel, side in zip((self.oscillator, self.drive.channel), sides, strict=True):
            if not (side.status or side.warned or channel.answer.terminate):
                continue
            if side.warned:
                channel.instance.check_status("the step", WARNING)
                side.warned = 0
            if side.status == NOT_FINITE:
                channel.get_outputs()  # it raises
            if side.status in (0, NOT_WHOLE) or side.failed == b"the step":
                with suppress(SimulationEnded):
                    channel.check_step(max(side.status, 0), side.status != NOT_WHOLE)
            else:
                raise side.error_of_failed_call(channel.instance)

    # -- to go on elsewhere --

    def numbers_to_resume(self) -> list[float]:
        """Return all that goes on besides both FMUs' states; :meth:`resume_from` takes it."""
        known = 2 * self.pair.point_count
        memory = [x for name in MEMORY for x in getattr(self.pair, name)]
        return [*self.row, *memory, *self.pair.points[:known], *[math.nan] * (2 * PAST - known)]

    def resume_from(self, numbers: Sequence[float]) -> None:
        rest = iter(numbers)
        self.row = [next(rest) for _ in self.names]
        for name, count in MEMORY.items():
            getattr(self.pair, name)[:] = [next(rest) for _ in range(count)]
        points = [x for x in rest if x == x]
        self.pair.points[: len(points)], self.pair.point_count = points, len(points) // 2

    def close(self) -> None:
        """Free the FMU states saved to go back."""
        self.oscillator.close()
        self.drive.channel.close()
