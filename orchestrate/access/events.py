"""A motion computed impact by impact, through the events of FMI 3.0.

The FMI 3.0 form returns early from a step at each impact, at its exact time. Between impacts the
motion does not depend on the steps, so states sampled in a second run belong to the same motion to
the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import byref, c_bool, c_double
from os import PathLike

import numpy as np

from ..errors import InputError
from .event_loop import EventLoop, event_loop_of
from .impacts import Impacts
from .instance import Instance

NO_INPUT, NO_TIMES = np.empty((1, 0)), np.empty(0)


class EventInstance(Instance):
    """Instance of the FMI 3.0 form that stops at impacts.

    Parameters
    ----------
    path : path-like
    name : str
        Instance name.

    Raises
    ------
    InputError
        Also where the FMU is not FMI 3.0: 2.0 knows no events.
    """

    EVENTS = {"eventModeUsed": True, "earlyReturnAllowed": True}

    def __init__(self, path: str | PathLike[str], name: str = "instance") -> None:
        self._loops: dict[tuple[tuple[str, ...], ...], EventLoop] = {}
        super().__init__(path, name)
        if not self.is_fmi3:
            version = self.description.fmi_version
            self.close()
            raise InputError(f"FMU {path}: is FMI {version}; expected FMI 3.0, which has events")

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

    def impacts(self, time: float, target: float) -> Impacts:
        """Return all impacts of (time, target], s."""
        return self.event_loop().run(np.array([time, target]), NO_INPUT, NO_TIMES).impacts

    def event_loop(self, inputs: Sequence[str] = (), outputs: Sequence[str] = ()) -> EventLoop:
        """Return the loop through events with these inputs and outputs, made once."""
        key = tuple(inputs), tuple(outputs)
        if key not in self._loops:
            self._loops[key] = event_loop_of(self, *key)
        return self._loops[key]

    def stepper(self) -> Callable[[float, float], tuple[bool, float]]:
        """Return a fast ``fmi3DoStep``: from time and step length to whether there was an event,
        and its time.
        """
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
