"""The drive's inputs other than the force, step by step: courses over time, and a controlled one.

A drive with inputs for the derivatives of an input (``command_1`` to ``command_3``) takes it as a
cubic over each step: of a course the one with its ends, mean and first moment. Another one holds
its mean; what the first moments of a course lack then is made up for in this step and the next two,
as of the force in :mod:`.master`. A controller gives a cubic, or what it takes of a supply.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..fmu.description import Description
from .connection import Link
from .controllers import Controller, ControllerState, InputControl, Measurement
from .master import Master
from .polynomials import end_derivatives, matched_cubics, mean_value
from .schedule import Course
from .step_record import Floats, Record

MADE_UP = (-1.5, 2.0, -0.5)  # of a first moment over the step's square, in this step and the next


class Supply(NamedTuple):
    """Voltage of a source, of which a controller takes a part by the speed as each step begins."""

    course: Course
    controller: Controller
    speed: float  # at the start, rad/s

    def begin(self) -> ControllerState:
        return self.controller.begin(self.speed)


Input = Course | InputControl | Supply


class Inputs:
    """The inputs of one drive by name; those with derivatives are last, a controlled one of all."""

    def __init__(self, inputs: Sequence[tuple[str, Input]], drive: Description) -> None:
        whole = {
            name for name, _ in inputs if all(o in drive.variables for o in cubic_input_names(name))
        }
        courses = [(name, one) for name, one in inputs if isinstance(one, Course)]
        controls = [(name, one) for name, one in inputs if not isinstance(one, Course)]
        self.held = [(name, one) for name, one in courses if name not in whole]
        self.cubics = [(name, one) for name, one in courses if name in whole]
        self.names = [name for name, _ in self.held]
        self.control: InputControl | Supply | None = None
        for name, self.control in controls:
            self.controlled = len(self.names) + 4 * len(self.cubics) * (name in whole)
            self.controls_cubic = name in whole
            self.names += [name] * (name not in whole)
        # place of the first cubic, for the master
        self.first_cubic = len(self.names) if whole else -1
        for name, _ in [*self.cubics, *(one for one in controls if one[0] in whole)]:
            self.names += cubic_input_names(name)
        self.state: ControllerState = self.control.begin() if self.control else ()

    def start_values(self) -> dict[str, float]:
        values = {name: one.voltage(0.0) for name, one in [*self.held, *self.cubics]}
        return {name: values.get(name, 0.0) for name in self.names}

    def rows_over_steps(self, edges: Floats, width: int = 0, skipped: int = 0) -> Floats:
        """Return inputs of steps between edges but the first ones, with ends if ``width``.

        Of a supply it is the mean of what there is.
        """
        count = len(self.names)
        h, rows = np.diff(edges), np.zeros((len(edges) - 1, max(width, count)))
        ends = rows[:, count:] if width > count else np.zeros((len(h), count))
        for i, (_, course) in enumerate(self.held):
            _, ends[:, i], rows[:, i], lever = course.ends_means_and_moments(edges)
            moments = np.append([0.0, 0.0], lever / h**2)
            if not len(h) or np.ptp(h) <= 1e-6 * h[0]:
                for back, share in enumerate(MADE_UP):
                    rows[:, i] += share * moments[2 - back : len(moments) - back]
        for i, (_, course) in enumerate(self.cubics):
            first, last, mean, lever = course.ends_means_and_moments(edges)
            place = self.first_cubic + 4 * i
            cubics = matched_cubics(first, last, mean, 0.5 * mean + lever / h**2, h)
            rows[:, place : place + 4] = cubics
            ends[:, place : place + 4] = np.transpose(end_derivatives(tuple(cubics.T), h))
        if isinstance(self.control, Supply):
            rows[:, self.controlled] = self.control.course.ends_means_and_moments(edges)[2]
        return rows[skipped:]

    def run_master(self, master: Master, steps: range, h: float, equal_from: int = 0) -> Record:
        """Run both FMUs over some steps of one length, which all have from `equal_from` on."""
        # steps before whose first moments are made up for in these
        earlier = min(2, steps.start - equal_from)
        edges = np.arange(steps.start - earlier, steps.stop + 1, dtype=np.float64) * h
        rows = self.rows_over_steps(edges, master.input_width, earlier)
        if self.control is None:
            return master.run(rows, h)
        return master.run_controlled(self._controlled_rows(rows.tolist(), h, master), len(rows), h)

    def _controlled_rows(
        self, rows: list[list[float]], h: float, master: Master
    ) -> Iterator[list[float]]:
        first, count = self.controlled, len(self.names)
        for row in rows:
            values, ends = self._update_control(row[first], h, master)
            row[first : first + len(values)] = values
            if len(row) > count:
                row[count + first : count + first + len(values)] = ends
            yield row

    def _update_control(
        self, available: float, h: float, master: Master
    ) -> tuple[Sequence[float], Sequence[float]]:
        """Return what a control says of its input over a step, and at the step's end."""
        if isinstance(self.control, Supply):
            seen = Measurement(master.time, master["speed"], available, h)
            voltage, self.state = self.control.controller.update(seen, self.state)
            return [voltage], [voltage]
        assert self.control is not None
        acceleration = master["box_acceleration"]
        cubic, self.state = self.control.update(master.time, h, acceleration, self.state)
        if self.controls_cubic:
            return cubic, end_derivatives(cubic, h)
        mean = [mean_value(cubic, h)]
        return mean, mean


def cubic_input_names(name: str) -> list[str]:
    return [name, *(f"{name}_{order}" for order in (1, 2, 3))]


def check_input_connections(inputs: Sequence[tuple[str, Input]], links: Mapping[str, Link]) -> None:
    """Raise unless no input is connected, and one at most controlled by a known acceleration."""
    connected = {link.theirs for link in links.values()}
    for name in [name for name, _ in inputs if name in connected]:
        raise InputError(f"inputs: {name} is connected; expected it in one of connect and inputs")
    controlled = [name for name, one in inputs if isinstance(one, InputControl)]
    if len(controlled) > 1:
        raise InputError(f"inputs: {' and '.join(controlled)} are controlled; expected one of them")
    if controlled and "box_acceleration" not in links:
        raise InputError(f"inputs: {controlled[0]} is controlled; connect box_acceleration for it")
