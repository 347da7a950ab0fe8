"""A motion impact by impact: the FMI 3.0 form returns early from a step at each impact, at its exact time.

Between impacts the motion does not depend on the steps, so states sampled in a second run belong to the same motion to the last bit.
"""

import ctypes
import math
from dataclasses import dataclass

import numpy as np

from .fmu import FmuError, Instance

STATE = ("x1", "x2", "v1", "v2")
SERIES = tuple(f"{name}_sample" for name in STATE)
REST = (0.0, 0.0, 0.0, 0.0)
EVENT_OUTPUTS = (*STATE, "impact_velocity")


def period(eta):
    """T = 2 pi/eta, (22) as it must read."""
    return 2.0 * math.pi / eta


@dataclass(frozen=True)
class Impacts:
    """The impacts of a motion, in order.

    Attributes
    ----------
    time : ndarray, shape (n,)
        tau of each.
    state : ndarray, shape (n, 4)
        xi_1, xi_2, xi_1', xi_2' just after it.
    closing : ndarray, shape (n,)
        Closing velocity before it, >= 0; the impulse over m1 omega a eta^2 is ``mu/(1+mu) (1+e)`` times this (15).
    sticks : ndarray of bool, shape (n,)
        Whether permanent contact follows (17).
    """

    time: np.ndarray
    state: np.ndarray
    closing: np.ndarray
    sticks: np.ndarray

    def before(self, case):
        """States just before the impacts, shape (n, 4), by (15) read backwards."""
        state, part = self.state.copy(), self.closing / (1.0 + case.mu)
        common = (state[:, 2] + case.mu * state[:, 3]) / (1.0 + case.mu)
        state[:, 2], state[:, 3] = common + case.mu * part, common - part
        return state


class EventInstance(Instance):
    """An instance of the FMI 3.0 form that stops at impacts."""

    EVENTS = {"eventModeUsed": True, "earlyReturnAllowed": True}

    def advance(self, time, target):
        """Step to ``target`` past all events."""
        while time < target:
            event, _, _, time = self.call("doStep", time, target - time)
            if event:
                self.handle_event()

    def handle_event(self):
        """Go through event mode, as FMI 3.0 asks of an importer after an event."""
        self._fmu.enterEventMode()
        self._fmu.updateDiscreteStates()
        self._fmu.enterStepMode()

    def impacts(self, time, target):
        """All impacts of (time, target], as :class:`Impacts`; the inner loop of all that follows, so it calls the binary itself."""
        stuck = self.flag("in_contact")
        component, library = ctypes.c_void_p(self._fmu.component), self._fmu.dll
        step, enter = library["fmi3DoStep"], library["fmi3EnterEventMode"]
        update, leave = library["fmi3UpdateDiscreteStates"], library["fmi3EnterStepMode"]
        event, last, flags, numbers = ctypes.c_bool(), ctypes.c_double(time), [ctypes.c_bool() for _ in range(6)], ctypes.c_double()
        answers = [ctypes.byref(event), ctypes.byref(flags[0]), ctypes.byref(flags[1]), ctypes.byref(last)]
        news = [*map(ctypes.byref, flags[1:6]), ctypes.byref(numbers)]
        times, rows, contacts, yes = [], [], [], ctypes.c_bool(True)
        while time < target:
            if step(component, ctypes.c_double(time), ctypes.c_double(target - time), yes, *answers):
                raise FmuError("; ".join(self._messages) or "fmi3DoStep failed")
            time = last.value
            if event:
                rows.append(self.read(*EVENT_OUTPUTS).tolist())
                times.append(time)
                contacts.append(stuck())
                enter(component), update(component, *news), leave(component)
        table = np.array(rows).reshape(-1, len(EVENT_OUTPUTS))
        return Impacts(np.array(times), table[:, :4], table[:, 4], np.array(contacts, dtype=bool))

    def flag(self, name):
        """A fast reader of one Boolean."""
        reference = (ctypes.c_uint * 1)(self.variable(name).valueReference)
        value = (ctypes.c_bool * 1)()

        def read():
            self._fmu.fmi3GetBoolean(self._fmu.component, reference, 1, value, 1)
            return value[0]

        return read


def begin(instance, case, eta, start=REST, **values):
    """Initialise an instance at phase 0 from the state ``start`` (xi_1, xi_2, xi_1', xi_2'), with ``x = xi``."""
    drive = {"box_amplitude": 1.0 / (eta * eta), "box_frequency": eta, "x_rel_max_on": False}
    named = dict(zip(("x1_start", "x2_start", "v1_start", "v2_start"), map(float, start), strict=True))
    instance.reset()
    instance.initialize(**{**case.parameters(), **named, **drive, **values})
    if instance.EVENTS:
        instance.call("enterStepMode")


def sampled(instance, time, target, count):
    """States at ``count`` equal parts of a span, the last at its end, shape (count, 4); taken inside few steps."""
    room = len(instance.read(*SERIES)) // len(SERIES)
    states, width = np.empty((count, len(SERIES))), (target - time) / count
    for done in range(0, count, room):
        size = min(room, count - done)
        instance.set(sample_count=size)
        instance.step(time + done * width, time + (done + size) * width)
        states[done : done + size] = instance.read(*SERIES).reshape(len(SERIES), room)[:, :size].T
    return states
