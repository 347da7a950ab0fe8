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
        self._in = self._array(inputs)
        self._out = self._array(outputs)
        functions = self._functions3() if instance.is_fmi3 else self._functions2()
        self._set, self._get, self._step, self._save, self._restore, self._free = functions
        self._reused = not instance.description.needs_tool  # pythonfmu makes a new state each time
        self._states: dict[int, c_void_p] = {}

    def _array(self, names: Sequence[str]) -> tuple[Any, int, Any]:
        references = [self.instance.variable(name).valueReference for name in names]
        count = len(references)
        return (c_uint * count)(*references), count, (c_double * count)()

    def _functions2(self) -> tuple[Callable[..., Any], ...]:
        fmu, component = self._fmu, self._fmu.component

        def step(time: float, h: float) -> None:
            fmu.fmi2DoStep(component, time, h, 0)

        states = (fmu.fmi2GetFMUstate, fmu.fmi2SetFMUstate, fmu.fmi2FreeFMUstate)
        return fmu.fmi2SetReal, fmu.fmi2GetReal, step, *states

    def _functions3(self) -> tuple[Callable[..., Any], ...]:
        fmu, component = self._fmu, self._fmu.component
        flags, last = [c_bool() for _ in range(3)], c_double()
        answers = [*map(byref, flags), byref(last)]

        def step(time: float, h: float) -> None:
            fmu.fmi3DoStep(component, time, h, False, *answers)

        states = (fmu.fmi3GetFMUState, fmu.fmi3SetFMUState, fmu.fmi3FreeFMUState)
        return fmu.fmi3SetFloat64, fmu.fmi3GetFloat64, step, *states

    def _call(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Call, with the FMU's message where it fails."""
        self.instance._messages.clear()
        try:
            function(*arguments)
        except Exception as error:
            raise self.instance.failure(error) from None

    def _sizes(self, count: int) -> list[int]:
        """FMI 3.0 wants the number of values too."""
        return [count] if self.instance.is_fmi3 else []

    def put(self, *values: float) -> None:
        """Set the first of the inputs, as many as values are given."""
        references, _, array = self._in
        count = len(values)
        array[:count] = values
        component = self._fmu.component
        self._call(self._set, component, references, count, array, *self._sizes(count))

    def get(self) -> list[float]:
        """Values of the outputs."""
        references, count, array = self._out
        component = self._fmu.component
        self._call(self._get, component, references, count, array, *self._sizes(count))
        values: list[float] = array[:]
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
