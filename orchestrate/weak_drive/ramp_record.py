"""Find in the record of a ramp where it may have lost a motion: where the slip falls.

The slip is the no-load speed less the speed, both over omega: the torque that the vibration takes.
Where the speed gains on the voltage, on the way up, or loses against it, on the way down, by more
than `shown`, the record suggests a jump. A resonance without a jump does so too: held voltages tell
(:mod:`.hysteresis`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..model.drive import sense_of
from ..response.labels import Variable, variable
from ..running.job import Table
from .run import CoupledRun

COLUMNS_SHOWN = ("time", "voltage", "speed", "amplitude")


class Suspect(NamedTuple):
    """Store the rows of a run between which it may have lost a motion, and where most likely."""

    before: int
    row: float  # where half of the slip's fall is done, between two rows
    after: int


NOT_SHOWN = Suspect(math.nan, math.nan, math.nan)  # type: ignore[arg-type]


@dataclass(frozen=True)
class RampRecord:
    """Search the revolutions of a run for suspected jumps, in one direction of the voltage."""

    job: CoupledRun  # what was run
    table: Table  # its revolutions, a row each
    up: bool

    @property
    def sense(self) -> float:
        """Return the sense of rotation of the run."""
        return sense_of(self.table["voltage"])

    @property
    def sign(self) -> float:
        """Return the direction of the voltage's size: 1 or -1."""
        return 1.0 if self.up else -1.0

    def forward(self) -> Table:
        """Return the table of the mirror image of the run, in which the motor turns forward."""
        signed = ("voltage", "speed")
        return {**self.table, **{name: self.sense * self.table[name] for name in signed}}

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

    def row_earlier(self, row: int, rotor_times: float, leg: np.ndarray) -> int:
        """Return the row that is earlier by some of the rotor's times 1/b, within its ramp."""
        structure, time = self.job.structure, self.table["time"]
        earlier = time[row] - rotor_times / (self.job.drive.b(structure) * structure.omega)
        return max(int(np.searchsorted(time, earlier)), int(leg[0]))

    def suspect_at(self, eta0: float, leg: np.ndarray) -> Suspect:
        """Return where a ramp reaches a voltage, as a suspected jump of no length."""
        row = float(np.interp(self.sign * eta0, self.sign * self.eta0(leg), leg))
        return Suspect(math.floor(row), row, math.ceil(row))

    def suspects(self, leg: np.ndarray, shown: float, share: float, apart: float) -> list[Suspect]:
        """Return the stretches of one ramp over which the slip falls by at least `shown`."""
        b, omega = self.job.drive.b(self.job.structure), self.job.structure.omega
        turn = float(np.median(np.diff(self.table["time"][leg]))) if len(leg) > 1 else math.inf
        width = max(4, math.ceil(0.5 / (b * omega * turn)))
        if len(leg) < 2 * width:
            return []
        slip = np.convolve(self.slip(leg), np.full(width, 1.0 / width), "valid")
        groups: list[list[tuple[int, int]]] = []
        for fall in find_falls(slip, shown):
            if groups and fall[0] - groups[-1][-1][1] < apart * width:
                groups[-1].append(fall)
            else:
                groups.append([fall])
        first, middle = int(leg[0]), 0.5 * (width - 1)
        suspects = []
        for group in groups:
            largest = max(group, key=lambda fall: slip[fall[0]] - slip[fall[1]])
            before = first + row_where_done(slip, group[0], share)
            half = first + row_where_done(slip, largest, 0.5) + middle
            after = first + row_where_done(slip, group[-1], 1.0 - share) + width - 1
            suspects.append(Suspect(before, half, after))
        return suspects


def row_where_done(slip: np.ndarray, fall: tuple[int, int], part: float) -> int:
    """Return the first row at which a part of a fall is done."""
    high, low = fall
    done = (slip[high] - slip[high : low + 1]) / (slip[high] - slip[low])
    return high + int(np.argmax(done >= part))


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


def time_beyond(time: np.ndarray, Omega: np.ndarray, threshold: float) -> float:
    """Return the time from which the speed stays above a threshold; NaN if it does not."""
    below = np.flatnonzero(Omega <= threshold)
    if not len(Omega) or Omega[-1] <= threshold:
        return math.nan
    return float(time[below[-1] + 1]) if below.size else float(time[0])


def jump_labels(directions: Sequence[str]) -> list[str]:
    """Return labels for jumps of some directions: "up", "down", and further ones "up 2"."""
    counts: Counter[str] = Counter()
    labels = []
    for direction in directions:
        counts[direction] += 1
        labels.append(direction if counts[direction] == 1 else f"{direction} {counts[direction]}")
    return labels


def variables_shown(table: Table, shown: Sequence[Suspect]) -> dict[str, Variable]:
    """Build the variables of what a record shows at jumps; NaN where a row is NaN."""
    rows = np.array(shown, dtype=float).reshape(-1, 3).T
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
