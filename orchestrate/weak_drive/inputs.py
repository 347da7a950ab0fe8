"""The drive's inputs other than the force, step by step: courses over time, and a controlled one.

A drive with inputs for the derivatives of an input (``command_1`` to ``command_3``) takes it as a
cubic over each step: of a course the one with its ends, mean and first moment. Another one holds
its mean; what the first moments of a course lack then is made up for in this step and the next two,
as of the force in :mod:`.master`. A controller gives a cubic.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from ..errors import InputError
from ..fmu.description import Description
from .connection import Link
from .controllers import Controller, ControllerState, InputControl, Measurement
from .master import Master
from .polynomials import end_derivatives, matched_cubics, mean_value
from .schedule import Course, Schedule
from .step_record import Floats, Record

Input = Course | InputControl
MADE_UP = (-1.5, 2.0, -0.5)  # of a first moment over the step's square, in this step and the next


class StepInputs(ABC):
    """What gives a drive's inputs, step by step, and the state of what controls them."""

    state: ControllerState = ()

    @abstractmethod
    def run(self, master: Master, steps: range, h: float, first: int = 0) -> Record:
        """Run both FMUs over some steps of one length, which all have from the first one on."""


class Inputs(StepInputs):
    """The inputs of one drive by name; those with derivatives are last, a controlled one of all."""

    def __init__(self, inputs: Sequence[tuple[str, Input]], drive: Description) -> None:
        whole = {name for name, _ in inputs if all(o in drive.variables for o in cubic_names(name))}
        courses = [(name, one) for name, one in inputs if isinstance(one, Course)]
        controls = [(name, one) for name, one in inputs if isinstance(one, InputControl)]
        self.held = [(name, one) for name, one in courses if name not in whole]
        self.cubics = [(name, one) for name, one in courses if name in whole]
        self.names = [name for name, _ in self.held]
        self.control: InputControl | None = None
        for name, self.control in controls:
            self.controlled = len(self.names) + 4 * len(self.cubics) * (name in whole)
            self.controls_cubic = name in whole
            self.names += [name] * (name not in whole)
        # place of the first cubic, for the master
        self.cubic = len(self.names) if whole else -1
        for name, _ in [*self.cubics, *(one for one in controls if one[0] in whole)]:
            self.names += cubic_names(name)
        self.state = self.control.begin() if self.control else ()

    def start_values(self) -> dict[str, float]:
        """Return the inputs at time 0 by name."""
        values = {name: float(one.at(np.zeros(1))[0]) for name, one in [*self.held, *self.cubics]}
        return {name: values.get(name, 0.0) for name in self.names}

    def rows(self, edges: Floats, width: int = 0, earlier: int = 0) -> Floats:
        """Return the inputs of the steps between edges, but some earlier ones; 0 for a control.

        Where a row has the width for it, they are followed by the inputs at the step's end.
        """
        count = len(self.names)
        h, rows = np.diff(edges), np.zeros((len(edges) - 1, max(width, count)))
        ends = rows[:, count:] if width > count else np.zeros((len(h), count))
        for i, (_, course) in enumerate(self.held):
            _, ends[:, i], rows[:, i], lever = course.over_steps(edges)
            moments = np.append([0.0, 0.0], lever / h**2)
            if np.ptp(h) <= 1e-6 * h[0]:
                for back, share in enumerate(MADE_UP):
                    rows[:, i] += share * moments[2 - back : len(moments) - back]
        for i, (_, course) in enumerate(self.cubics):
            first, last, mean, lever = course.over_steps(edges)
            place = self.cubic + 4 * i
            cubics = matched_cubics(first, last, mean, 0.5 * mean + lever / h**2, h)
            rows[:, place : place + 4] = cubics
            ends[:, place : place + 4] = np.transpose(end_derivatives(tuple(cubics.T), h))
        return rows[earlier:]

    def run(self, master: Master, steps: range, h: float, first: int = 0) -> Record:
        """Run both FMUs, each step under what its courses have over it."""
        earlier = min(2, steps.start - first)  # steps whose first moments are made up for in these
        edges = np.arange(steps.start - earlier, steps.stop + 1, dtype=np.float64) * h
        rows = self.rows(edges, master.width, earlier)
        if self.control is None:
            return master.run(rows, h)
        return master.run_controlled(self._controlled(rows.tolist(), h, master), len(rows), h)

    def _controlled(
        self, rows: list[list[float]], h: float, master: Master
    ) -> Iterator[list[float]]:
        """Yield the rows with what is commanded, from the box's motion as each step begins."""
        assert self.control is not None
        first, count = self.controlled, len(self.names)
        for row in rows:
            seen = master.time, h, master["box_acceleration"], self.state
            cubic, self.state = self.control.update(*seen)
            values = [*cubic] if self.controls_cubic else [mean_value(cubic, h)]
            row[first : first + len(values)] = values
            if len(row) > count:
                ends = [*end_derivatives(cubic, h)] if self.controls_cubic else values
                row[count + first : count + first + len(values)] = ends
            yield row


class MotorVoltage(StepInputs):
    """The voltage of our own motor: of a schedule, or what a controller takes of it.

    It is held over each step: that in its middle, or by the speed at its beginning.
    """

    def __init__(self, schedule: Schedule, controller: Controller | None, speed: float) -> None:
        self.schedule, self.controller = schedule, controller
        self.state = controller.begin(speed) if controller else ()

    def run(self, master: Master, steps: range, h: float, first: int = 0) -> Record:
        """Run both FMUs, each step under its voltage."""
        volts = (self.schedule.voltage((i + 0.5) * h) for i in steps)
        if self.controller is None:
            return master.run([*volts])
        return master.run_controlled(self._taken(volts, h, master), len(steps))

    def _taken(self, volts: Iterable[float], h: float, master: Master) -> Iterator[list[float]]:
        """Yield what the controller takes of the voltages, by the speed as each step begins."""
        assert self.controller is not None
        for available in volts:
            seen = Measurement(master.time, master["speed"], available, h)
            voltage, self.state = self.controller.update(seen, self.state)
            yield [voltage]


def cubic_names(name: str) -> list[str]:
    return [name, *(f"{name}_{order}" for order in (1, 2, 3))]


def check_inputs(inputs: Sequence[tuple[str, Input]], links: Mapping[str, Link]) -> None:
    """Raise unless no input is connected, and one at most controlled by a known acceleration."""
    connected = {link.theirs for link in links.values()}
    for name in [name for name, _ in inputs if name in connected]:
        raise InputError(f"inputs: {name} is connected; expected it in one of connect and inputs")
    controlled = [name for name, one in inputs if isinstance(one, InputControl)]
    if len(controlled) > 1:
        raise InputError(f"inputs: {' and '.join(controlled)} are controlled; expected one of them")
    if controlled and "box_acceleration" not in links:
        raise InputError(f"inputs: {controlled[0]} is controlled; connect box_acceleration for it")
