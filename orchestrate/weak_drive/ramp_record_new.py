"""Find in the record of a ramp where it may have lost a motion: where the slip falls.

The slip is the no-load speed less the speed, both over omega: the torque that the vibration takes.
Where the speed gains on the voltage, on the way up, or loses against it, on the way down, by more
than `shown`, the record suggests a jump. A resonance without a jump does so too: held voltages tell
(:mod:`.hysteresis`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..running.job import Table
from .run import CoupledRun

APART = 12  # widths of the mean: falls of the slip that are closer are one
SHARE = 0.1  # of a fall of the slip before and after its steep part


class Suspect(NamedTuple):
    """Store the rows of a run between which it may have lost a motion, and where most likely."""

    first: int  # of the ramp
    before: int
    row: float  # where half of the slip's fall is done, between two rows
    after: int


@dataclass(frozen=True)
class RampRecord:
    """Search the revolutions of a run for suspected jumps, in one direction of the voltage."""

    job: CoupledRun  # what was run
    table: Table  # its revolutions, a row each
    up: bool

    @property
    def sense(self) -> float:
        """Return the sense of rotation: -1 where the motor turns backward, else 1."""
        voltage = self.table["voltage"]
        return -1.0 if -voltage.min(initial=0.0) > voltage.max(initial=0.0) else 1.0

    @property
    def sign(self) -> float:
        """Return the direction of the voltage's size: 1 or -1."""
        return 1.0 if self.up else -1.0

    def rows(self) -> np.ndarray:
        """Return the rows of the revolutions in which the size of the voltage rises (or falls)."""
        voltage = self.sense * self.table["voltage"]
        trend = self.sense * self.sign * self.job.schedule.trend(self.table["time"])
        return np.flatnonzero((trend > 0.0) & (voltage > 0.0))

    def legs(self) -> list[np.ndarray]:
        """Return the rows of each ramp in this direction."""
        rows = self.rows()
        return np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if rows.size else []

    def eta0(self, rows: Any) -> Any:
        """Return the voltage over K omega at the ends of revolutions."""
        return self.sense * self.table["voltage"][rows] / self.job.drive.volts(self.job.structure)

    def speed(self, rows: Any) -> Any:
        """Return the mean speed over omega of revolutions."""
        return np.abs(self.table["speed"][rows]) / self.job.structure.omega

    def slip(self, rows: Any) -> Any:
        """Return by how much the no-load speed exceeds the speed, over omega, by its direction."""
        return self.sign * (self.eta0(rows) - self.speed(rows))

    def step(self, row: int) -> int:
        """Return the communication step at the end of a revolution."""
        return min(math.ceil(self.table["time"][row] / self.job.scheme.h), self.job.steps() - 1)

    def row_earlier(self, row: int, rotor_times: float) -> int:
        """Return the row that is earlier by some of the rotor's times 1/b, within its ramp."""
        structure, time = self.job.structure, self.table["time"]
        earlier = time[row] - rotor_times / (self.job.drive.b(structure) * structure.omega)
        leg = next(leg for leg in self.legs() if leg[0] <= row <= leg[-1])
        return max(int(np.searchsorted(time, earlier)), int(leg[0]))

    def within_ramp(self, eta0: float, row: int) -> float:
        """Return a voltage over K omega, at most the last one of the ramp of a row."""
        leg = next(leg for leg in self.legs() if leg[0] <= row <= leg[-1])
        last = float(self.eta0(leg[-1]))
        return min(eta0, last) if self.up else max(eta0, last)

    def suspects(self, shown: float) -> list[Suspect]:
        """Return the stretches over which the slip falls by at least `shown`, in their order."""
        return [suspect for leg in self.legs() for suspect in self.suspects_on_leg(leg, shown)]

    def suspects_on_leg(self, leg: np.ndarray, shown: float) -> list[Suspect]:
        """Return the stretches of one ramp over which the slip falls by at least `shown`."""
        b, omega = self.job.drive.b(self.job.structure), self.job.structure.omega
        turn = float(np.median(np.diff(self.table["time"][leg]))) if len(leg) > 1 else math.inf
        width = max(4, math.ceil(0.5 / (b * omega * turn)))
        apart = APART * width
        if len(leg) < 2 * width:
            return []
        slip = np.convolve(self.slip(leg), np.full(width, 1.0 / width), "valid")
        falls: list[tuple[int, int]] = []
        for high, low in find_falls(slip, shown):
            if falls and high - falls[-1][1] < apart:
                falls[-1] = falls[-1][0], low
            else:
                falls.append((high, low))
        return [self.suspect(leg, slip[high : low + 1], high, width) for high, low in falls]

    def suspect(self, leg: np.ndarray, slip: np.ndarray, high: int, width: int) -> Suspect:
        """Return the rows of a ramp between which the mean slip does most of its fall."""
        done = (slip.max() - slip) / np.ptp(slip)
        rows = [int(np.argmax(done >= part)) + high for part in (SHARE, 0.5, 1.0 - SHARE)]
        first = int(leg[0])
        return Suspect(
            first, first + rows[0], first + rows[1] + 0.5 * width, first + rows[2] + width - 1
        )


def find_falls(values: np.ndarray, least: float) -> list[tuple[int, int]]:
    """Find the spans from a maximum to the next minimum that fall by at least `least`."""
    spans, high, low, falling = [], 0, 0, False
    for i, value in enumerate(values.tolist()):
        if falling:
            low = i if value < values[low] else low
            if value >= values[low] + least:
                spans.append((high, low))
                high, falling = i, False
        elif value > values[high]:
            high = i
        elif value <= values[high] - least:
            low, falling = i, True
    return [*spans, (high, low)] if falling else spans
