"""A motion computed impact by impact, through the events of FMI 3.0.

The FMI 3.0 form returns early from a step at each impact, at its exact time. Between impacts the
motion does not depend on the steps, so states sampled in a second run belong to the same motion to
the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from ctypes import byref, c_bool, c_double
from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..structures import Structure
from .instance import Instance

STATE = ("x1", "x2", "v1", "v2")
EVENT_OUTPUTS = (*STATE, "impact_velocity")


@dataclass(frozen=True)
class Impacts:
    """The impacts of a motion, in order.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s.
    state : ndarray, shape (n, 4)
        x1, x2 in m, v1, v2 in m/s just after each.
    closing : ndarray, shape (n,)
        Closing speed before it, m/s, >= 0.
    sticks : ndarray of bool, shape (n,)
        Whether permanent contact follows (17).
    """

    time: NDArray[np.float64]
    state: NDArray[np.float64]
    closing: NDArray[np.float64]
    sticks: NDArray[np.bool_]

    def before(self, structure: Structure) -> NDArray[np.float64]:
        """Return the states just before the impacts, shape (n, 4), by (15) read backwards."""
        mu = structure.mu
        state, part = self.state.copy(), self.closing / (1.0 + mu)
        common = (state[:, 2] + mu * state[:, 3]) / (1.0 + mu)
        state[:, 2], state[:, 3] = common + mu * part, common - part
        return state

    def impulse(self, structure: Structure) -> NDArray[np.float64]:
        """Return the impulse of each impact on each mass, N s, shape (n,) (15); plastic where
        contact begins.

        Of non-dimensional impacts it is over omega a eta^2, so that its unit is that of a mass.
        """
        m1, m2 = structure.m1, structure.m2
        restitution = np.where(self.sticks, 0.0, structure.e)
        impulse: NDArray[np.float64] = (1.0 + restitution) * m1 * m2 / (m1 + m2) * self.closing
        return impulse


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
        """Return all impacts of (time, target], s.

        The inner loop of all that follows, so it calls the binary itself.
        """
        stuck, step, handle = self.flag("in_contact"), self.stepper(), self.event_handler()
        times, rows, contacts = [], [], []
        while time < target:
            event, time = step(time, target - time)
            if event:
                rows.append(self.read(*EVENT_OUTPUTS).tolist())
                times.append(time)
                contacts.append(stuck())
                handle()
        table = np.array(rows).reshape(-1, len(EVENT_OUTPUTS))
        return Impacts(np.array(times), table[:, :4], table[:, 4], np.array(contacts, dtype=bool))

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
