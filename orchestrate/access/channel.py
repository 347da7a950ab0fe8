"""Fast calls on one instance, for co-simulation masters.

Preallocated arrays, one call for many variables, one handle for each state that is kept. Only Real
variables. Both FMI versions; statuses are checked by FMPy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import byref, c_bool, c_double, c_uint, c_void_p
from typing import Any

from .instance import Instance


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
        self.instance._messages.clear()
        status = function(*arguments)
        if status:
            name = getattr(function, "__name__", "a call of the FMU")
            raise self.instance.failure(f"{name} failed with status {status}")

    def put(self, *values: float) -> None:
        """Set the first of the inputs, as many as values are given."""
        count = len(values)
        self._inputs[:count] = values
        self._call(self._set, *self._puts[count])

    def get(self) -> list[float]:
        """Values of the outputs."""
        self._call(self._read, *self._gets)
        values: list[float] = self._outputs[:]
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
