"""The impacts of a motion as arrays: times, states, closing velocities, impulses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model import Structure

STATE = ("x1", "x2", "v1", "v2")
EVENT_OUTPUTS = (*STATE, "impact_velocity")


@dataclass(frozen=True)
class Impacts:
    """The impacts of a motion in time order, as arrays: time, state, closing velocity, sticking."""

    time: NDArray[np.float64]  # s
    state: NDArray[np.float64]  # x1, x2 in m, v1, v2 in m/s just after each
    closing: NDArray[np.float64]  # closing speed before it, m/s, >= 0
    sticks: NDArray[np.bool_]  # whether permanent contact follows (17)

    @classmethod
    def from_table(cls, table: NDArray[np.float64]) -> Impacts:
        """Return impacts from table rows: time, the FMU's ``EVENT_OUTPUTS``, a flag of sticking."""
        table = table.reshape(-1, len(EVENT_OUTPUTS) + 2)
        return cls(table[:, 0], table[:, 1:5], table[:, 5], table[:, 6] != 0.0)

    def impulse(self, structure: Structure, speed_unit: float = 1.0) -> NDArray[np.float64]:
        """Return each impact's impulse on each mass (15), (n,): plastic if contact begins.

        In N s; of non-dimensional impacts, whose unit of speed is needed, in N s over that unit.
        """
        m1, m2 = structure.m1, structure.m2
        restitution = np.where(self.sticks, 0.0, structure.restitution(speed_unit * self.closing))
        if structure.wall:
            return np.asarray((1.0 + restitution) * m1 * self.closing)
        impulse: NDArray[np.float64] = (1.0 + restitution) * m1 * m2 / (m1 + m2) * self.closing
        return impulse
