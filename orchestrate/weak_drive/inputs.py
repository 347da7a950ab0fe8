"""The drive's inputs other than the force, step by step: courses over time, and a controlled one.

A course is held over a step at its value in the middle. A controller gives a cubic: a drive with
inputs for its derivatives (``command_1`` to ``command_3``) takes it whole, another one its mean.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..errors import InputError
from ..fmu.description import Description
from .connection import Link
from .controllers import InputControl
from .master import Master
from .polynomials import end_derivatives, mean_value
from .record import Floats, Record
from .schedule import Course

Input = Course | InputControl


class Inputs:
    """The inputs of one drive by name; a controlled one is the last, with its derivatives."""

    def __init__(self, inputs: Sequence[tuple[str, Input]], drive: Description) -> None:
        courses = [(name, one) for name, one in inputs if isinstance(one, Course)]
        controls = [(name, one) for name, one in inputs if isinstance(one, InputControl)]
        self.names, self.courses = [name for name, _ in courses], [one for _, one in courses]
        self.control: InputControl | None = None
        self.own: list[str] = []  # names of what is controlled
        for name, self.control in controls:
            cubic = [name, *(f"{name}_{order}" for order in (1, 2, 3))]
            self.own = cubic if all(one in drive.variables for one in cubic) else [name]
        self.names += self.own
        self.cubic = len(courses) if len(self.own) > 1 else -1  # place of a cubic, for the master
        self.state = self.control.begin() if self.control else ()

    def at(self, times: Floats) -> Floats:
        """Return the inputs at some times, a row for each; 0 for what is controlled."""
        rows = np.zeros((len(times), len(self.names)))
        for column, course in zip(rows.T, self.courses, strict=False):
            column[:] = course.at(times)
        return rows

    def run(self, master: Master, steps: range, h: float) -> Record:
        """Run both FMUs over some steps of one length."""
        numbers = np.arange(steps.start, steps.stop, dtype=np.float64)
        rows = self.at((numbers + 0.5) * h)
        if master.connection.recorded:
            rows = np.hstack([rows, self.at((numbers + 1.0) * h)])
        if self.control is None:
            return master.run(rows, h)
        return master.run_controlled(self._controlled(rows.tolist(), h, master), len(rows), h)

    def _controlled(
        self, rows: list[list[float]], h: float, master: Master
    ) -> Iterator[list[float]]:
        """Yield the rows with what is commanded, from the box's motion as each step begins."""
        assert self.control is not None
        first, last = len(self.courses), len(self.names)
        for row in rows:
            seen = master.time, h, master["box_acceleration"], self.state
            cubic, self.state = self.control.update(*seen)
            whole = self.cubic >= 0
            row[first:last] = cubic if whole else [mean_value(cubic, h)]
            if len(row) > last:
                row[last + first :] = end_derivatives(cubic, h) if whole else row[first:last]
            yield row


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
