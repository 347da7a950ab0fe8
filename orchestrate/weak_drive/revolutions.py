"""A run as one row a revolution of the motor: mean speed, amplitudes, impacts, energies."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass

from .master import Master

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
    v1, box_velocity : float
        At the last communication point, m/s.
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
    v1: float
    box_velocity: float
    acceleration: float = 0.0


def reach(value: float, velocity: float, before: float, h: float) -> float:
    """A position, or how far it has been where it has turned round since: on a parabola."""
    if before * velocity < 0.0:
        return value + 0.5 * velocity * velocity / (before - velocity) * h
    return value


class Revolutions:
    """Turns a run into rows, one a revolution.

    Parameters
    ----------
    master : Master
        At the start.
    impact_count : callable
        The number of impacts so far, asked at the end of a revolution.
    """

    def __init__(self, master: Master, impact_count: Callable[[], float]) -> None:
        self._master, self._impact_count = master, impact_count
        self._begin(0.0, 0.0, 0.0)

    def _begin(self, turn: float, time: float, impacts: float) -> None:
        """A revolution begins."""
        motion, shaking = self._master.motion, self._master.shaking
        x, y = motion.x1, shaking.box_position
        self._now = Revolution(turn, time, impacts, x, x, y, y, motion.v1, shaking.box_velocity)

    def add(self) -> tuple[float, ...] | None:
        """Look at the state after a step.

        Returns
        -------
        tuple of float, or None
            In the order of ``COLUMNS``, when a revolution is complete, forward or backward.
        """
        master, now = self._master, self._now
        self._watch(now)
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

    def _watch(self, now: Revolution) -> None:
        """Keep the extreme values."""
        master = self._master
        motion, shaking, h = master.motion, master.shaking, master.h_before
        x = reach(motion.x1, motion.v1, now.v1, h)
        now.x1_high, now.x1_low = max(now.x1_high, x), min(now.x1_low, x)
        y = reach(shaking.box_position, shaking.box_velocity, now.box_velocity, h)
        now.box_high, now.box_low = max(now.box_high, y), min(now.box_low, y)
        now.v1, now.box_velocity = motion.v1, shaking.box_velocity
        now.acceleration = max(now.acceleration, abs(shaking.box_acceleration))

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
