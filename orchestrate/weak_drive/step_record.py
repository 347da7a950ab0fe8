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
    """Store the outputs of the structure FMU at a communication point, SI units."""

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
    "given",  # work that the masses do on the box in the step
)
LEADING = (*STEP, *OscillatorOutputs._fields, *BOX)  # then come the drive's outputs and inputs
PLACE = {name: i for i, name in enumerate(LEADING)}


@dataclass(frozen=True)
class Record:
    """Hold the columns of a run: the state before it, then one value for the end of each step."""

    names: tuple[str, ...]
    columns: Floats  # (names, 1 + steps)
    ends: NDArray[np.integer[Any]]  # places in a column at which communication intervals end
    recorded: Floats  # of the drive there, (ends, names)

    @property
    def before(self) -> Record:
        return replace(self, columns=self.columns[:, :-1])

    @property
    def after(self) -> Record:
        return replace(self, columns=self.columns[:, 1:])

    def __getitem__(self, name: str) -> Floats:
        return self.columns[self.names.index(name)]

    def motion(self) -> OscillatorOutputs:
        first = PLACE["x1"]
        return OscillatorOutputs._make(self.columns[first : first + len(OscillatorOutputs._fields)])

    def input_cubics(self) -> Cubic:
        """Return the box acceleration as :meth:`acceleration_cubics`, then forces on the halves."""
        pushes = (name for name in self.names[len(LEADING) :] if name.endswith("_then"))
        return *self.acceleration_cubics(), *map(self.__getitem__, pushes)

    def acceleration_cubics(self) -> Cubic:
        """Return the box acceleration over the steps that end here, as cubics."""
        first = PLACE["acceleration_then"]
        return tuple(self.columns[first : first + 4])


def join_records(records: Sequence[Record]) -> Record:
    starts = np.cumsum([0, *(record.columns.shape[1] - 1 for record in records)])
    columns = [records[0].columns[:, :1], *(record.after.columns for record in records)]
    ends = [start + record.ends for start, record in zip(starts, records, strict=False)]
    recorded = np.concatenate([record.recorded for record in records])
    return Record(records[0].names, np.concatenate(columns, axis=1), np.concatenate(ends), recorded)
