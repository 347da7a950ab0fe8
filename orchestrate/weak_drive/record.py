"""Store what a coupled run leaves of its steps: a row for each, with names for the columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .polynomials import Cubic

Floats = NDArray[np.float64]
BOX = ("box_position", "box_velocity", "box_acceleration")


class OscillatorOutputs(NamedTuple):
    """Store the outputs of the structure FMU at a communication point, SI units.

    Displacements count from the unloaded springs; the gap ``x_rel`` is 0 in contact.
    """

    x1: float
    x2: float
    v1: float
    v2: float
    box_force: float
    box_impulse: float
    box_impulse_moment: float
    impact_energy: float
    impact_time: float
    x_rel: float


STEP = (  # of the step that ends here: its length, how often that was halved, its cubic
    *("time", "h", "level", "acceleration_then", "jerk_then", "snap_then", "crackle_then"),
    "impacts",  # since the start
)
LEADING = (*STEP, *OscillatorOutputs._fields, *BOX)  # then come the drive's outputs and inputs
PLACE = {name: i for i, name in enumerate(LEADING)}


@dataclass(frozen=True)
class Record:
    """Hold the rows of a run: the state before it, then one for the end of each step."""

    names: tuple[str, ...]  # of the columns
    rows: Floats
    ends: NDArray[np.integer[Any]]  # rows at which communication intervals end

    @property
    def before(self) -> Record:
        """Return the rows at which the steps begin."""
        return replace(self, rows=self.rows[:-1])

    @property
    def after(self) -> Record:
        """Return the rows at which the steps end."""
        return replace(self, rows=self.rows[1:])

    def at_ends(self) -> Record:
        """Return the rows at the ends of communication intervals only."""
        return replace(self, rows=self.rows[self.ends])

    def __getitem__(self, name: str) -> Floats:
        """Return a column."""
        return self.rows[:, self.names.index(name)]

    def motion(self) -> OscillatorOutputs:
        """Return the oscillator's outputs, an array for each."""
        return OscillatorOutputs._make(self[name] for name in OscillatorOutputs._fields)  # type: ignore[arg-type]

    def acceleration(self) -> Cubic:
        """Return the box acceleration over the steps that end at the rows, as cubics."""
        first = PLACE["acceleration_then"]
        return tuple(self.rows[:, first : first + 4].T)


def joined(records: Sequence[Record]) -> Record:
    """Join the records of runs that follow each other."""
    starts = np.cumsum([0, *(len(record.rows) - 1 for record in records)])
    rows = [records[0].rows[:1], *(record.rows[1:] for record in records)]
    ends = [start + record.ends for start, record in zip(starts, records, strict=False)]
    return Record(records[0].names, np.concatenate(rows), np.concatenate(ends))
