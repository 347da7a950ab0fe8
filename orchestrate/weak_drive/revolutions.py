"""Convert a coupled run to rows, one per revolution of the motor."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple

from ..constants import TURN
from .extremes import Revolution
from .master import Master

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


class Revolutions:
    """Collect a run's steps into rows, one per revolution of the motor."""

    def __init__(self, master: Master, impact_count: Callable[[], float]) -> None:
        """Start the record of the first revolution."""
        self._master, self._impact_count = master, impact_count
        self._now = master.revolution = Revolution.begin(master.motion, master.shaking)

    def add(self) -> tuple[float, ...] | None:
        """Return the row of a revolution if the last step completed one, else None."""
        master, now = self._master, self._now
        turns = master.shaking.angle / TURN
        if not now.is_complete(turns):
            return None
        turn = math.floor(turns) if turns > now.turn else math.ceil(turns)
        time = master.time - (master.shaking.angle - turn * TURN) / master.shaking.speed
        impacts = self._impact_count()
        row = self._row(time, (turn - now.turn) * TURN / (time - now.time), impacts - now.impacts)
        ends = master.motion, master.shaking
        self._now = master.revolution = Revolution.begin(*ends, turn, time, impacts)
        return row

    def _row(self, time: float, speed: float, impacts: float) -> tuple[float, ...]:
        """Build the row of a revolution from its end time, speed and impacts."""
        master, now = self._master, self._now
        ranges = 0.5 * (now.x1_high - now.x1_low), 0.5 * (now.box_high - now.box_low)
        energies = master.balance.energies(master.motion, master.shaking)
        return (time, master.voltage, speed, *ranges, impacts, now.acceleration, *energies)

    def get_state(self) -> list[float]:
        """Return the unfinished revolution as a list of floats, to be restored later."""
        return list(astuple(self._now))

    def set_state(self, numbers: Sequence[float]) -> None:
        """Restore the state that :meth:`get_state` returned."""
        self._now = self._master.revolution = Revolution(*numbers)
