"""FMI 3.0 instance that is stepped from event to event, with fast prepared calls for loops."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import byref, c_bool, c_double

from .instance import Instance


class SteppingInstance(Instance):
    """FMI 3.0 instance with event mode: a step returns early at an impact."""

    def advance(self, time: float, target: float) -> None:
        """Step the FMU from ``time`` to ``target``, s, handling every event on the way."""
        while time < target:
            event, _, _, time = self.call("doStep", time, target - time)
            if event:
                self.handle_event()

    def handle_event(self) -> None:
        """Take the FMU through FMI 3.0's event mode and back to step mode after an event."""
        self.call("enterEventMode")
        self.call("updateDiscreteStates")
        self.call("enterStepMode")

    def stepper(self) -> Callable[[float, float], tuple[bool, float]]:
        """Return a fast ``fmi3DoStep(time, length)`` that gives (event happened, time reached)."""
        event, last = c_bool(), c_double()
        results = byref(event), byref(c_bool()), byref(c_bool()), byref(last)
        do_step = self.prepared("fmi3DoStep", self._time, self._length, c_bool(True), *results)

        def step(time: float, length: float) -> tuple[bool, float]:
            self._time.value, self._length.value = time, length
            do_step()
            return event.value, last.value

        return step

    def event_handler(self) -> Callable[[], None]:
        """Return a fast callable of :meth:`handle_event`, by C calls without FMPy's wrapper."""
        results = [*(byref(c_bool()) for _ in range(5)), byref(c_double())]
        enter, leave = self.prepared("fmi3EnterEventMode"), self.prepared("fmi3EnterStepMode")
        update = self.prepared("fmi3UpdateDiscreteStates", *results)

        def handle() -> None:
            enter()
            update()
            leave()

        return handle

    def flag(self, name: str) -> Callable[[], bool]:
        """Return a fast callable that reads one Boolean variable of the FMU, given by name."""
        call, values, _ = self._transfer("Get", "Boolean", [(self.variable(name), 1)], [0])

        def read() -> bool:
            call()
            return bool(values[0])

        return read
