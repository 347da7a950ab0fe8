"""Fast calls on one instance, for co-simulation masters.

Preallocated arrays, one call for many variables, one handle for each state that is kept. Only Real
variables. Both FMI versions; statuses are checked by FMPy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import Array, byref, c_bool, c_double, c_uint, c_void_p, cast
from math import isfinite
from typing import Any, NamedTuple

from ..errors import FmuError
from .instance import Instance


class Pointers(NamedTuple):
    """What compiled code needs to do the same with an FMI 3.0 instance.

    Attributes
    ----------
    instance : int
    functions : tuple of int
        Addresses of ``fmi3SetFloat64``, ``fmi3GetFloat64``, ``fmi3DoStep``, ``fmi3GetFMUState``
        and ``fmi3SetFMUState``.
    inputs, outputs : array of c_uint
        Value references.
    kept : c_void_p
        The place of the state kept; the channel frees it.
    """

    instance: int
    functions: tuple[int, ...]
    inputs: Array[c_uint]
    outputs: Array[c_uint]
    kept: c_void_p


class Channel:
    """What a co-simulation master does with an instance, thousands of times a second.

    Parameters
    ----------
    instance : Instance
        Initialised, or about to be.
    inputs, outputs : sequence of str
        Names of the variables that :meth:`put` sets and :meth:`get` reads, in this order.
    """

    def __init__(self, instance: Instance, inputs: Sequence[str], outputs: Sequence[str]) -> None:
        self.instance = instance
        self._fmu = instance._fmu
        self._states: dict[int, c_void_p] = {}
        self._reused = not instance.description.needs_tool  # pythonfmu makes a new state each time
        functions = self._functions3() if instance.is_fmi3 else self._functions2()
        self._set, self._read, self._step, self._save, self._restore, self._free = functions
        places, count, self._inputs = self._array(inputs)
        self._puts = [self._arguments(places, n, self._inputs) for n in range(count + 1)]
        places, count, self._outputs = self._array(outputs)
        self._names = tuple(outputs)
        self._gets = self._arguments(places, count, self._outputs)

    def _array(self, names: Sequence[str]) -> tuple[Any, int, Any]:
        references = [self.instance.variable(name).valueReference for name in names]
        count = len(references)
        return (c_uint * count)(*references), count, (c_double * count)()

    def _arguments(self, references: Any, count: int, values: Any) -> tuple[Any, ...]:
        """Of the functions that set and get; FMI 3.0 wants the number of values too."""
        sizes = (count,) if self.instance.is_fmi3 else ()
        return (self._fmu.component, references, count, values, *sizes)

    def _functions2(self) -> tuple[Callable[..., int], ...]:
        dll, component = self._fmu.dll, self._fmu.component
        do_step = dll.fmi2DoStep

        def step(time: float, h: float) -> int:
            return int(do_step(component, time, h, 0))

        states = (dll.fmi2GetFMUstate, dll.fmi2SetFMUstate, dll.fmi2FreeFMUstate)
        return dll.fmi2SetReal, dll.fmi2GetReal, step, *states

    def _functions3(self) -> tuple[Callable[..., int], ...]:
        dll, component = self._fmu.dll, self._fmu.component
        do_step = dll.fmi3DoStep
        flags, last = [c_bool() for _ in range(3)], c_double()
        answers = [*map(byref, flags), byref(last)]

        def step(time: float, h: float) -> int:
            return int(do_step(component, time, h, False, *answers))

        states = (dll.fmi3GetFMUState, dll.fmi3SetFMUState, dll.fmi3FreeFMUState)
        return dll.fmi3SetFloat64, dll.fmi3GetFloat64, step, *states

    def _call(self, function: Callable[..., int], *arguments: Any) -> None:
        """Call the FMU itself, past FMPy's wrapper; its message where the status is not OK."""
        self.begin()
        status = function(*arguments)
        if status:
            raise self.failure(getattr(function, "__name__", "a call of the FMU"), status)

    def pointers(self) -> Pointers:
        """For compiled code, of an FMI 3.0 instance whose states are reused."""
        names = ("SetFloat64", "GetFloat64", "DoStep", "GetFMUState", "SetFMUState")
        functions = (getattr(self._fmu.dll, f"fmi3{name}") for name in names)
        addresses = tuple(cast(function, c_void_p).value or 0 for function in functions)
        kept = self._states.setdefault(0, c_void_p())
        return Pointers(self._fmu.component, addresses, self._puts[-1][1], self._gets[1], kept)

    def begin(self) -> None:
        """Forget messages of calls before."""
        self.instance._messages.clear()

    def failure(self, function: str, status: int) -> FmuError:
        """The FMU's message after a call that did not answer OK."""
        return self.instance.failure(f"{function} failed with status {status}")

    def put(self, *values: float) -> None:
        """Set the first of the inputs, as many as values are given."""
        count = len(values)
        self._inputs[:count] = values
        self._call(self._set, *self._puts[count])

    def get(self) -> list[float]:
        """Values of the outputs."""
        self._call(self._read, *self._gets)
        values: list[float] = self._outputs[:]
        if not isfinite(sum(values)) and not all(map(isfinite, values)):
            raise self.instance.no_number(self._names, values)
        return values

    def step(self, time: float, h: float) -> None:
        """One communication step of length ``h`` from ``time``, s."""
        self._call(self._step, time, h)

    def save(self, level: int = 0) -> None:
        """Keep the present state, in a place of its own for each ``level``."""
        handle = self._states.get(level)
        if handle is None:
            handle = self._states[level] = c_void_p()
        elif not self._reused:
            self._call(self._free, self._fmu.component, byref(handle))
        self._call(self._save, self._fmu.component, byref(handle))

    def restore(self, level: int = 0) -> None:
        """Back to the state kept."""
        self._call(self._restore, self._fmu.component, self._states[level])

    def close(self) -> None:
        """Free the states kept."""
        for handle in self._states.values():
            self._call(self._free, self._fmu.component, byref(handle))
        self._states.clear()
