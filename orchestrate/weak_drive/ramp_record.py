"""Read in the record of a ramp where it shows a jump that held voltages have found.

There the slip falls: the no-load speed less the speed, both over omega, which is the torque that
the vibration takes. The ramp shows the jump late, where the fall of the slip between the speeds
held before and after it is half done; it begins and ends where a tenth is done, or left.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..model.drive import sense_of_rotation
from ..response.labels import Variable, variable
from ..running.job import Table
from .run import MotorJob

COLUMNS_SHOWN = ("time", "voltage", "speed", "amplitude")
DONE = (0.1, 0.5, 0.9)  # of the slip's fall: where a jump begins, is, and ends
SMOOTH = 0.5  # rotor times 1/b over which the slip is averaged


@dataclass(frozen=True)
class RampRecord:
    """Read the revolutions of a run in one direction of the voltage."""

    job: MotorJob  # what was run
    table: Table  # its revolutions, a row each
    up: bool

    @property
    def rotation_sense(self) -> float:
        return sense_of_rotation(self.table["voltage"])

    @property
    def voltage_direction(self) -> float:
        """Return the direction of the voltage's size: 1 or -1."""
        return 1.0 if self.up else -1.0

    def forward_table(self) -> Table:
        """Return the table of the mirror image of the run, in which the motor turns forward."""
        signed = ("voltage", "speed")
        return {**self.table, **{name: self.rotation_sense * self.table[name] for name in signed}}

    def rows_by_leg(self) -> list[np.ndarray]:
        """Return rows of revolutions in which the size of the voltage rises (or falls), by legs."""
        voltage = self.rotation_sense * self.table["voltage"]
        trend = self.job.schedule.trend(self.table["time"])
        moves = self.rotation_sense * self.voltage_direction * trend > 0.0
        rows = np.flatnonzero(moves & (voltage > 0.0))
        return np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if rows.size else []

    def eta0(self, rows: Any) -> Any:
        """Return the voltage over K omega at the ends of revolutions."""
        volts = self.job.drive.volts(self.job.structure)
        return self.rotation_sense * self.table["voltage"][rows] / volts

    def step_of_row(self, row: int) -> int:
        step = math.ceil(self.table["time"][row] / self.job.scheme.h)
        return min(step, self.job.step_count() - 1)

    def row_positions_of_jump(
        self, low: float, high: float, before: float, after: float
    ) -> list[float]:
        """Return where, in rows, a jump begins, is half done and ends; NaN where it does not."""
        # the jump is from a voltage and the speed before to another one and the speed after
        first, fall = low - before, (low - before) - (high - after)
        for leg in self.rows_by_leg():
            turn = np.median(np.diff(self.table["time"][leg])) if len(leg) > 1 else math.inf
            b, omega = self.job.drive.b(self.job.structure), self.job.structure.omega
            width = max(4, math.ceil(SMOOTH / (b * omega * turn)))
            past = self.voltage_direction * self.eta0(leg) >= self.voltage_direction * low
            slips = self.eta0(leg) - np.abs(self.table["speed"][leg]) / omega
            if not past.any() or len(leg) < width:
                continue
            done = np.convolve((first - slips) / fall, np.full(width, 1.0 / width), "valid")
            past, rows = past[len(leg) - len(done) :], []
            for part in DONE[1:]:
                there = np.flatnonzero(past & (done >= part))
                rows.append(float(there[0]) if there.size else math.nan)
            if math.isnan(rows[0]):
                continue
            lead = np.where(past, np.minimum(done, 1.0), math.inf)[: int(rows[0]) + 1]
            begun = lead.min() + DONE[0] * (1.0 - lead.min())  # the slip grows on before it falls
            begin = float(np.flatnonzero(lead <= begun)[-1])
            return [leg[0] + 0.5 * (width - 1) + row for row in (begin, *rows)]
        return [math.nan] * len(DONE)


def time_stays_above(time: np.ndarray, Omega: np.ndarray, threshold: float) -> float:
    """Return the time from which the speed stays above a threshold; NaN if it does not."""
    below = np.flatnonzero(Omega <= threshold)
    if not len(Omega) or Omega[-1] <= threshold:
        return math.nan
    return float(time[below[-1] + 1]) if below.size else float(time[0])


def ramp_jump_variables(
    table: Table, rows_by_jump: Sequence[Sequence[float]]
) -> dict[str, Variable]:
    """Build the variables of what a record shows at jumps; NaN where a row is NaN."""
    rows = np.array(rows_by_jump, dtype=float).reshape(-1, len(DONE)).T
    numbers = np.arange(len(table["time"]))
    before, here, after = (
        {name: np.interp(at, numbers, table[name]) for name in COLUMNS_SHOWN} for at in rows
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        rate = (after["voltage"] - before["voltage"]) / (after["time"] - before["time"])
    texts = {
        "ramp_voltage": (here["voltage"], "V", "voltage at which the speed jumps on the ramp"),
        "jump_time": (here["time"], "s", "time of that voltage"),
        "jump_speed": (here["speed"], "rad/s", "mean speed of that revolution"),
        "jump_speed_before": (before["speed"], "rad/s", "mean speed before the jump"),
        "jump_speed_after": (after["speed"], "rad/s", "mean speed after the jump"),
        "jump_amplitude_before": (before["amplitude"], "m", "amplitude before the jump"),
        "jump_amplitude_after": (after["amplitude"], "m", "amplitude after the jump"),
        "jump_rate": (rate, "V/s", "change of the voltage per time during the jump"),
    }
    return {name: variable("jump", *parts) for name, parts in texts.items()}
