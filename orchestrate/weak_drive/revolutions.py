"""A run as one row a revolution of the motor: mean speed, amplitudes, impacts, energies."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass

from ..structures.structure import Structure
from .extremes import reach_of_box, reach_of_mass
from .master import Master, Step

TURN = 2.0 * math.pi
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


@dataclass
class Revolution:
    """What is seen of a revolution under way.

    Attributes
    ----------
    turn : float
        Full turns of the motor at its beginning.
    time, impacts : float
        s, and impacts so far, at its beginning.
    x1_high, x1_low, box_high, box_low : float
        Extreme positions since, m.
    acceleration : float
        Largest of the box, m/s2.
    """

    turn: float
    time: float
    impacts: float
    x1_high: float
    x1_low: float
    box_high: float
    box_low: float
    acceleration: float = 0.0


class Revolutions:
    """Turns a run into rows, one a revolution.

    Parameters
    ----------
    master : Master
        At the start; its steps are watched from now on.
    structure : Structure
    impact_count : callable
        The number of impacts so far, asked at the end of a revolution.
    """

    def __init__(
        self, master: Master, structure: Structure, impact_count: Callable[[], float]
    ) -> None:
        self._master, self._structure, self._impact_count = master, structure, impact_count
        master.watch = self._watch
        self._begin(0.0, 0.0, 0.0)

    def _begin(self, turn: float, time: float, impacts: float) -> None:
        """A revolution begins."""
        motion, shaking = self._master.motion, self._master.shaking
        x, y = motion.x1, shaking.box_position
        self._now = Revolution(turn, time, impacts, x, x, y, y)

    def add(self) -> tuple[float, ...] | None:
        """Look at the state after a step.

        Returns
        -------
        tuple of float, or None
            In the order of ``COLUMNS``, when a revolution is complete, forward or backward.
        """
        master, now = self._master, self._now
        angle = master.shaking.angle / TURN
        turn = math.floor(angle)
        if turn <= now.turn:
            turn = math.ceil(angle)
            if turn >= now.turn:
                return None
        time = master.time - (master.shaking.angle - turn * TURN) / master.shaking.speed
        impacts = self._impact_count()
        row = self._row(time, (turn - now.turn) * TURN / (time - now.time), impacts - now.impacts)
        self._begin(turn, time, impacts)
        return row

    def _watch(self, done: Step, h: float) -> None:
        """Keep the extreme values of a step."""
        master, now = self._master, self._now
        ends = (master.motion, done.motion)
        x = reach_of_mass(self._structure, ends, done.acceleration, master.time, h)
        now.x1_high, now.x1_low = max(now.x1_high, x.high), min(now.x1_low, x.low)
        y = reach_of_box(master.shaking, done.shaking, done.acceleration, h)
        now.box_high, now.box_low = max(now.box_high, y.high), min(now.box_low, y.low)
        now.acceleration = max(now.acceleration, abs(done.shaking.box_acceleration))

    def _row(self, time: float, speed: float, impacts: float) -> tuple[float, ...]:
        """What is kept of a revolution that ends at ``time``."""
        master, now = self._master, self._now
        ranges = 0.5 * (now.x1_high - now.x1_low), 0.5 * (now.box_high - now.box_low)
        energies = master.balance.energies(master.motion, master.shaking)
        return (time, master.voltage, speed, *ranges, impacts, now.acceleration, *energies)

    def memory(self) -> list[float]:
        """The revolution under way, as a list of floats."""
        return list(astuple(self._now))

    def remember(self, numbers: Sequence[float]) -> None:
        """The inverse of :meth:`memory`."""
        self._now = Revolution(*numbers)
