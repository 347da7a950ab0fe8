"""Steps of one instance that end at its events, and fast calls for loops over them."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import byref, c_bool, c_double

from .instance import Instance


class SteppingInstance(Instance):
    """Instance of the FMI 3.0 form that is stepped from event to event."""

    def advance(self, time: float, target: float) -> None:
        """Step to ``target``, through all events."""
        while time < target:
            event, _, _, time = self.call("doStep", time, target - time)
            if event:
                self.handle_event()

    def handle_event(self) -> None:
        """Go through event mode, as FMI 3.0 asks of an importer after an event."""
        self.call("enterEventMode")
        self.call("updateDiscreteStates")
        self.call("enterStepMode")

    def stepper(self) -> Callable[[float, float], tuple[bool, float]]:
        """Return a fast ``fmi3DoStep``; it returns whether there was an event, and its time."""
        event, last = c_bool(), c_double()
        results = byref(event), byref(c_bool()), byref(c_bool()), byref(last)
        do_step = self.prepared("fmi3DoStep", self._time, self._length, c_bool(True), *results)

        def step(time: float, length: float) -> tuple[bool, float]:
            self._time.value, self._length.value = time, length
            do_step()
            return event.value, last.value

        return step

    def event_handler(self) -> Callable[[], None]:
        """Return a fast :meth:`handle_event`, without FMPy's wrapper."""
        results = [*(byref(c_bool()) for _ in range(5)), byref(c_double())]
        enter, leave = self.prepared("fmi3EnterEventMode"), self.prepared("fmi3EnterStepMode")
        update = self.prepared("fmi3UpdateDiscreteStates", *results)

        def handle() -> None:
            enter()
            update()
            leave()

        return handle

    def flag(self, name: str) -> Callable[[], bool]:
        """Return a fast reader of one Boolean variable."""
        call, values, _ = self._transfer("Get", "Boolean", [(self.variable(name), 1)], [0])

        def read() -> bool:
            call()
            return bool(values[0])

        return read
