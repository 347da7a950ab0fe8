"""Convert a coupled run to rows, one per revolution of the motor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from ctypes import c_size_t, c_void_p

import numpy as np

from ..fmu.c_library import load_loop
from ..model.structure import Structure
from ..running.job import Table
from .energy_balance import Energies, EnergyBalance
from .extremes import range_of_box, range_of_mass_1
from .step_record import Floats, Record

COLUMNS = {
    "time": ("s", "time at the revolution's end"),
    "voltage": ("V", "voltage of the motor at the revolution's end"),
    "speed": ("rad/s", "mean speed of the motor over the revolution"),
    "amplitude": ("m", "half the range of x1 over the revolution"),
    "box_amplitude": ("m", "half the range of the box's position over the revolution"),
    "impacts": ("1", "impacts in the revolution"),
    "box_acceleration": (
        "m/s2",
        "largest acceleration of the box at the revolution's communication points",
    ),
    "motor": ("J", "work of the motor since the start"),
    "box_damper": ("J", "energy lost in the damper of the box since the start"),
    "impact_loss": ("J", "energy lost in impacts since the start"),
    "stored": ("J", "energy stored since the start"),
    "dampers": ("J", "energy lost in the dampers of the masses since the start"),
    "missing": ("J", "motor less all others: what the coupling has lost (negative: fed in)"),
    "defect": (
        "J",
        "sum of the steps' defects: work taken by the box less work given by the masses",
    ),
    "defect_sizes": ("J", "sum of the sizes of the steps' defects"),
}
NOTHING = -math.inf  # largest values before the first step


class Revolutions:
    """Collect a run's records into rows, one per revolution of the motor."""

    def __init__(self, structure: Structure) -> None:
        self.structure, self.balance = structure, EnergyBalance(structure)
        self.last = np.zeros(3)  # full turns, s, and impacts, at the beginning of the revolution
        # largest since: x1, -x1, position of the box, its negative, and its acceleration's size
        self.largest = np.full(5, NOTHING)

    def add_record(self, record: Record) -> tuple[Table, Energies]:
        energies = self.balance.add_record(record)
        of_mass, of_box = range_of_mass_1(self.structure, record), range_of_box(record)
        shaken = np.abs(record.after["box_acceleration"])
        largest = np.stack([of_mass.high, -of_mass.low, of_box.high, -of_box.low, shaken])
        voltage, x1, y = record["voltage"], record["x1"], record["box_position"]
        rows, begin = [], 0
        for position, time, speed, impacts in self.complete_revolutions(record).tolist():
            end = int(position)
            self._raise_largest(largest[:, begin:end])
            x_high, x_low, y_high, y_low, acceleration = self.largest.tolist()
            ranges = 0.5 * (x_high + x_low), 0.5 * (y_high + y_low)
            row = (time, voltage[end], speed, *ranges, impacts, acceleration)
            rows.append((*row, *(account[end] for account in energies)))
            self.largest, begin = np.array([x1[end], -x1[end], y[end], -y[end], 0.0]), end
        self._raise_largest(largest[:, begin:])
        table = np.array(rows, dtype=float).reshape(-1, len(COLUMNS))
        return dict(zip(COLUMNS, table.T.copy(), strict=True)), energies

    def complete_revolutions(self, record: Record) -> Floats:
        """Return where a record completes revolutions: place, time, mean speed, and impacts."""
        table, ends = record.columns, record.ends.astype(np.intc)
        completed = np.empty((len(ends), 4))
        across, along = (c_size_t(stride // table.itemsize) for stride in table.strides)
        values, end_positions, last, rows = (
            c_void_p(one.ctypes.data) for one in (table, ends, self.last, completed)
        )
        find = load_loop("couple").find_revolutions
        return completed[: find(values, along, across, end_positions, len(ends), last, rows)]

    def _raise_largest(self, largest: Floats) -> None:
        self.largest = np.maximum(self.largest, largest.max(axis=1, initial=NOTHING))

    def numbers_to_resume(self) -> list[float]:
        return [*self.last.tolist(), *self.largest.tolist()]

    def resume_from(self, numbers: Sequence[float]) -> None:
        self.last, self.largest = np.array(numbers[:3]), np.array(numbers[3:])
