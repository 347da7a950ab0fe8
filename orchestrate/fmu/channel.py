"""Fast set, get, step and save/restore of one FMU instance, for co-simulation masters.

Preallocated arrays, one call for many variables, one handle for each state that is kept. Only Real
variables. Both FMI versions; statuses are checked by FMPy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import Array, byref, c_bool, c_double, c_uint, c_void_p
from math import isfinite
from typing import Any, NamedTuple

from ..errors import FmuError
from .instance import Instance, function_addresses


class Pointers(NamedTuple):
    """Addresses that compiled code needs to call an instance directly."""

    instance: int
    # addresses of `fmi3SetFloat64`, `fmi3GetFloat64`, `fmi3GetInt32`, `fmi3DoStep`,
    # `fmi3GetFMUState` and `fmi3SetFMUState`
    functions: tuple[int, ...]
    # value references
    inputs: Array[c_uint]
    outputs: Array[c_uint]
    saved_state: c_void_p  # handle of the saved state; the channel frees it


class Channel:
    """Fast set, get, step and save/restore of an FMU instance, with fixed lists of variables."""

    def __init__(self, instance: Instance, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.instance = instance
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
        dll, component = self._fmu.dll, self._fmu.component
        do_step = dll.fmi2DoStep

        def step(time: float, h: float) -> int:
            return int(do_step(component, time, h, 0))

        states = (dll.fmi2GetFMUstate, dll.fmi2SetFMUstate, dll.fmi2FreeFMUstate)
        return dll.fmi2SetReal, dll.fmi2GetReal, step, *states

    def _functions3(self) -> tuple[Callable[..., int], ...]:
        """Return the FMI 3.0 C functions set, get, step, and get/set/free of a state."""
        dll, component = self._fmu.dll, self._fmu.component
        do_step = dll.fmi3DoStep
        flags, last = [c_bool() for _ in range(3)], c_double()
        answers = [*map(byref, flags), byref(last)]

        def step(time: float, h: float) -> int:
            return int(do_step(component, time, h, False, *answers))

        states = (dll.fmi3GetFMUState, dll.fmi3SetFMUState, dll.fmi3FreeFMUState)
        return dll.fmi3SetFloat64, dll.fmi3GetFloat64, step, *states

    def _call(self, function: Callable[..., int], *arguments: Any) -> None:
        """Call a C function of the FMU directly; raise ``FmuError`` unless its status is OK."""
        self.begin()
        status = function(*arguments)
        if status:
            raise self.failure(getattr(function, "__name__", "a call of the FMU"), status)

    def pointers(self) -> Pointers:
        """Return C addresses of an instance, its functions and its saved state."""
        names = ("SetReal", "GetReal", "GetInteger", "DoStep", "GetFMUstate", "SetFMUstate")
        if self.instance.is_fmi3:
            names = ("SetFloat64", "GetFloat64", "GetInt32", "DoStep", "GetFMUState", "SetFMUState")
        instance, *addresses = function_addresses(self.instance, names)
        saved_state = self._states.setdefault(0, c_void_p())
        inputs, outputs = self._puts[-1][1], self._gets[1]
        return Pointers(instance, tuple(addresses), inputs, outputs, saved_state)

    def begin(self) -> None:
        """Clear the FMU's log messages before a new call, so that an error shows only its own."""
        self.instance._messages.clear()

    def failure(self, function: str, status: int) -> FmuError:
        """Return an ``FmuError`` with the FMU's log messages, function name and status."""
        return self.instance.failure(f"{function} failed with status {status}")

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
        self._call(self._step, time, h)

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
        """Free all FMU states that :meth:`save` holds in memory."""
        for handle in self._states.values():
            self._call(self._free, self._fmu.component, byref(handle))
        self._states.clear()
