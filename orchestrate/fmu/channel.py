"""Fast set, get, step and save/restore of one FMU instance, for co-simulation masters.

Preallocated arrays, one call for many variables, one handle for each state that is kept. Only Real
variables. Both FMI versions. What the answers to a step mean:

- OK: the run goes on; after a warning, too, whose message :attr:`Instance.warnings` keeps.
- The FMU ends the simulation (FMI 3.0: ``terminateSimulation``; 2.0: a discarded step, of which
  ``fmi2Terminated`` is true), and logs no error: no step follows; the last one counts if it reached
  its end.
- A discarded step, an early return, which is never allowed here, an error: ``FmuError``, with what
  the FMU logged, or how far the step came.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import Array, Structure, byref, c_bool, c_double, c_int, c_uint, c_void_p
from math import isfinite
from typing import Any, NamedTuple

from ..errors import FmuError
from .instance import DISCARD, ERROR, Instance, function_addresses

FUNCTIONS3 = ("SetFloat64", "GetFloat64", "GetInt32", "DoStep", "GetFMUState", "SetFMUState")
FUNCTIONS2 = (
    *("SetReal", "GetReal", "GetInteger", "DoStep", "GetFMUstate", "SetFMUstate"),
    *("GetRealStatus", "GetBooleanStatus"),
)
LAST_TIME, TERMINATED = 2, 3  # kinds of fmi2GetRealStatus and fmi2GetBooleanStatus
WHOLE = 1e-6  # of a step: a rest that is rounding, its end was reached


class SimulationEnded(FmuError):
    """Raised if an FMU ends the simulation before the end of a step."""


ANSWERS = ("event", "terminate", "early")


class StepAnswer(Structure):
    """What an FMU answered to its last step, by FMI 3.0's names; the C source has the same."""

    _fields_ = (
        *((name, c_double) for name in ("time", "h", "last")),
        *((name, c_bool) for name in ANSWERS),
    )

    time: float
    h: float
    last: float
    terminate: bool
    early: bool

    @property
    def is_whole(self) -> bool:
        """Return whether the step reached its end."""
        return self.last >= self.time + (1.0 - WHOLE) * self.h


class Pointers(NamedTuple):
    """Addresses that compiled code needs to call an instance directly."""

    instance: int
    functions: tuple[int, ...]  # addresses of `FUNCTIONS3`, and 0 for the rest, or `FUNCTIONS2`
    # value references
    inputs: Array[c_uint]
    outputs: Array[c_uint]
    saved_state: c_void_p  # handle of the saved state; the channel frees it
    answer: StepAnswer  # of its last step


class Channel:
    """Fast set, get, step and save/restore of an FMU instance, with fixed lists of variables."""

    def __init__(self, instance: Instance, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.instance = instance
        self.answer = StepAnswer()
        self.ended = ""  # at what time, and why, the FMU ended the simulation
        self._fmu = instance._fmu
        self._states: dict[int, c_void_p] = {}
        self._reused = not instance.description.needs_tool  # pythonfmu makes a new state each time
        functions = self._functions3() if instance.is_fmi3 else self._functions2()
        self._set, self._read, self._step, self._save, self._restore, self._free = functions
        references, count, self._inputs = self._array(inputs)
        self._puts = [self._arguments(references, n, self._inputs) for n in range(count + 1)]
        references, count, self._outputs = self._array(outputs)
        self._names = tuple(outputs)
        self._gets = self._arguments(references, count, self._outputs)

    def _array(self, names: Sequence[str]) -> tuple[Any, int, Any]:
        """Return ctypes arrays for named variables: value references, count, value buffer."""
        references = [self.instance.variable(name).valueReference for name in names]
        count = len(references)
        return (c_uint * count)(*references), count, (c_double * count)()

    def _arguments(self, references: Any, count: int, values: Any) -> tuple[Any, ...]:
        """Return the arguments of a set or get function; for FMI 3.0 with the number of values."""
        sizes = (count,) if self.instance.is_fmi3 else ()
        return (self._fmu.component, references, count, values, *sizes)

    def _functions2(self) -> tuple[Callable[..., int], ...]:
        """Return the FMI 2.0 C functions set, get, step, and get/set/free of a state."""
        dll, component, answer = self._fmu.dll, self._fmu.component, self.answer
        do_step, ended, last = dll.fmi2DoStep, c_int(), self._pointer("last")

        def step(time: float, h: float) -> int:
            answer.time, answer.h, answer.last = time, h, time
            status = int(do_step(component, time, h, 0))
            if status == DISCARD:
                dll.fmi2GetRealStatus(component, LAST_TIME, last)
                dll.fmi2GetBooleanStatus(component, TERMINATED, byref(ended))
                answer.terminate = bool(ended.value)
            return 0 if answer.terminate else status

        states = (dll.fmi2GetFMUstate, dll.fmi2SetFMUstate, dll.fmi2FreeFMUstate)
        return dll.fmi2SetReal, dll.fmi2GetReal, step, *states

    def _functions3(self) -> tuple[Callable[..., int], ...]:
        """Return the FMI 3.0 C functions set, get, step, and get/set/free of a state."""
        dll, component, answer = self._fmu.dll, self._fmu.component, self.answer
        do_step = dll.fmi3DoStep
        answers = [self._pointer(name) for name in (*ANSWERS, "last")]

        def step(time: float, h: float) -> int:
            answer.time, answer.h, answer.last = time, h, time
            return int(do_step(component, time, h, False, *answers))

        states = (dll.fmi3GetFMUState, dll.fmi3SetFMUState, dll.fmi3FreeFMUState)
        return dll.fmi3SetFloat64, dll.fmi3GetFloat64, step, *states

    def _pointer(self, name: str) -> Any:
        """Return a pointer to a field of the answer to a step."""
        kind: Any = c_bool if name in ANSWERS else c_double
        return byref(kind.from_buffer(self.answer, getattr(StepAnswer, name).offset))

    def _call(self, function: Callable[..., int], *arguments: Any) -> None:
        """Call a C function of the FMU directly; raise ``FmuError`` where it refuses."""
        self.begin()
        if status := function(*arguments):
            self.instance.check(getattr(function, "__name__", "a call"), status)

    def pointers(self) -> Pointers:
        """Return C addresses of an instance, its functions and its saved state."""
        names = FUNCTIONS3 if self.instance.is_fmi3 else FUNCTIONS2
        instance, *addresses = function_addresses(self.instance, names)
        addresses += [0] * (len(FUNCTIONS2) - len(addresses))
        saved_state = self._states.setdefault(0, c_void_p())
        inputs, outputs = self._puts[-1][1], self._gets[1]
        return Pointers(instance, tuple(addresses), inputs, outputs, saved_state, self.answer)

    def begin(self) -> None:
        """Clear the FMU's log messages before a new call, so that an error shows only its own."""
        self.instance._messages.clear()

    def put(self, *values: float) -> None:
        """Set the FMU's inputs in the order of the constructor; fewer values: the first ones."""
        count = len(values)
        self._inputs[:count] = values
        self._call(self._set, *self._puts[count])

    def get(self) -> list[float]:
        """Return the values of all outputs of this channel; raise if one is not finite."""
        self._call(self._read, *self._gets)
        values: list[float] = self._outputs[:]
        if not isfinite(sum(values)) and not all(map(isfinite, values)):
            raise self.instance.not_finite_error(self._names, values)
        return values

    def step(self, time: float, h: float) -> None:
        """Do one communication step of length ``h`` from ``time``, s."""
        if self.ended:
            raise SimulationEnded(self.ended)
        self.begin()
        self.check_step(self._step(time, h))

    def check_step(self, status: int) -> None:
        """Take the status of a step and its answer by the rule of this module."""
        answer, name = self.answer, self.instance.description.name
        texts = [self.instance.logged()]
        if answer.terminate and self.instance.logged(ERROR):  # pythonfmu's answer to an exception
            raise self.instance.failure("")
        if answer.terminate:
            texts = [f"the FMU {name} ended the simulation at t = {answer.last:.6g} s", *texts]
            self.ended = ": ".join(filter(None, texts))
        if status == DISCARD or (answer.early and not answer.is_whole):
            span = f"its step from t = {answer.time:.6g} s to {answer.time + answer.h:.6g} s"
            done = f" (it came to {answer.last:.6g} s)" if answer.last > answer.time else ""
            early = f"returned early from {span}{done}, which was not allowed"
            why = f"discarded {span}{done}" if status == DISCARD else early
            unsaid = "it logged no cause; try a shorter step, and the limits of its inputs"
            cause = texts[-1] or (unsaid if status == DISCARD else "expected its end")
            raise FmuError(f"the FMU {name} {why}: {cause}")
        if self.ended and not answer.is_whole:
            raise SimulationEnded(self.ended)
        self.instance.check("the step", status)

    def save(self, level: int = 0) -> None:
        """Save the FMU's whole state in memory under an integer ``level``."""
        handle = self._states.get(level)
        if handle is None:
            handle = self._states[level] = c_void_p()
        elif not self._reused:
            self._call(self._free, self._fmu.component, byref(handle))
        self._call(self._save, self._fmu.component, byref(handle))

    def restore(self, level: int = 0) -> None:
        """Set the FMU back to the state that :meth:`save` stored under this ``level``."""
        self._call(self._restore, self._fmu.component, self._states[level])

    def close(self) -> None:
        """Free all FMU states that are held in memory; an FMU without states is not asked to."""
        for handle in filter(None, self._states.values()):
            self._call(self._free, self._fmu.component, byref(handle))
        self._states.clear()
