"""Whether a passing of the resonance is a jump, asked of the FMUs: the voltage is held on the way.

Where the record of a ramp does not tell a jump from a steep branch, states of the run are restored,
and the voltage is held there. From low ones the motion goes on as it is; from higher ones the speed
passes the resonance all the same. Bisection brings the two together: where the motion is lost, the
speeds at which they end stay apart; on a steep branch they come together with the voltages.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..running.job import Chunk, Table
from .jumps import Passing
from .schedule import Constant, Schedule

if TYPE_CHECKING:
    from .couple import Run

MEMORY = (
    "oscillator_state",
    "shaker_state",
    "master_memory",
    "revolution_memory",
    "control_memory",
)
SHARE = 1.0 / 64.0  # of a step: steps of the voltage come no closer
NOT_ASKED, LOST, FOLLOWS, LEFT_BEFORE = range(4)
TOLD = {
    FOLLOWS: "no loss of stability: at held voltages too the speed passes without a gap",
    LEFT_BEFORE: "left its branch before the ramp: it does so at the first voltage, held, too",
}


class Verdict(NamedTuple):
    """What held voltages tell.

    Attributes
    ----------
    what : int
        ``NOT_ASKED``, ``LOST``, ``FOLLOWS`` or ``LEFT_BEFORE``.
    low, high : float
        The last voltage at which the motion stays and the first at which it is lost, V; NaN where
        it is not.
    """

    what: float
    low: float
    high: float


class Ending(NamedTuple):
    """How a motion ends at a held voltage: whether it has left, and its mean speed over omega."""

    left: bool
    speed: float


@dataclass(frozen=True)
class Patience:
    """How closely is looked.

    Attributes
    ----------
    time : float
        For which a voltage is held at most, 1/omega.
    look, rest : float
        Mean speeds of such times, 1/omega, that come closer by a third or more each time, and have
        less than this left, over omega, have arrived.
    width : float
        Of the voltages between which the gap is measured first, over K omega.
    halvings : int
        Of that width until it is measured again.
    kept : float
        Part of the gap that is still there then, where a motion is lost.
    stay : int
        Revolutions beyond the resonance after which a motion has left; its mean speed is theirs.
    """

    time: float = 4000.0
    look: float = 150.0
    rest: float = 1e-4
    width: float = 4e-4
    halvings: int = 2
    kept: float = 0.8
    stay: int = 20


class Holder:
    """A run of the past, from whose states the voltage is held.

    Parameters
    ----------
    begin : callable
        Begins a run with another schedule.
    schedule : Schedule
        Of the run.
    h, omega, volts : float
        Its step, s, and the units of speed and voltage.
    patience : Patience, optional
    """

    def __init__(
        self,
        begin: Callable[[Schedule], Run],
        schedule: Schedule,
        h: float,
        omega: float,
        volts: float,
        patience: Patience | None = None,
    ) -> None:
        self.begin, self.schedule, self.h = begin, schedule, h
        self.omega, self.volts, self.patience = omega, volts, patience or Patience()
        self.known: dict[int, Table] = {}

    def know(self, table: Table, every: int, steps: int) -> None:
        """Keep the states of a table, one after each ``every`` steps."""
        for i in range(len(table["master_memory"])):
            self.known[min((i + 1) * every, steps)] = {name: table[name][[i]] for name in MEMORY}

    def state(self, step: int) -> Table | None:
        """The state before a step; None for the start."""
        if step not in self.known and step:
            last = max((known for known in self.known if known < step), default=0)
            run = self.begin(self.schedule)
            try:
                if last:
                    run.remember(self.known[last])
                run.revolve(range(last, step))
                self.known[step] = run.memory()
            finally:
                run.master.close()
        return self.known.get(step)

    def voltage(self, step: float) -> float:
        """The run's voltage at a step, or a part of it later, V."""
        return self.schedule.voltage((step + 0.5) * self.h)

    def hold(self, step: float, divide: float, up: bool, whole: bool = False) -> Ending:
        """Hold the voltage of a step from there on; to the end, or until the motion has left."""
        count = math.ceil(self.patience.time / self.omega / self.h)
        piece = max(1, round(self.patience.look / self.omega / self.h))
        state, voltage = self.state(int(step)), self.voltage(step)
        run, speeds = self.begin(Constant(voltage, count * self.h)), np.zeros(0)
        means: list[float] = []
        try:
            if state is not None:
                run.remember(state)
            for first in range(0, count, piece):
                rows = run.revolve(range(first, min(first + piece, count)))
                now = np.abs(rows["speed"]) / self.omega
                speeds, means = np.append(speeds, now), [*means, now.mean() if now.size else 0.0]
                last = speeds[-self.patience.stay :]
                left = bool(((last > divide) == up).all()) and len(last) == self.patience.stay
                if (left and not whole) or at_rest(np.diff(means[-5:]), self.patience.rest):
                    break
        finally:
            run.master.close()
        return Ending(left, float(last.mean()) if last.size else math.nan)

    def judge(self, steps: Passing, first: int, divide: float, up: bool) -> Verdict:
        """Whether a motion is lost on the way through the resonance.

        Parameters
        ----------
        steps : Passing
            By steps of the run.
        first : int
            Step at which the voltage begins to go this way.
        divide : float
            Speed over omega between the motions below and beyond the resonance.
        up : bool
        """
        high, low = float(steps.row), float(steps.before)
        back = max(1.0, high - low)
        if not self.hold(high, divide, up).left:
            high = float(steps.after)
            if not self.hold(high, divide, up).left:
                return Verdict(FOLLOWS, math.nan, math.nan)
        ending = self.hold(low, divide, up)
        while ending.left:
            if low == first:
                return Verdict(LEFT_BEFORE, math.nan, math.nan)
            high, low, back = low, max(float(first), low - back), 2.0 * back
            ending = self.hold(low, divide, up)
        gaps, width = [], self.patience.width
        for part in (width, width / 2**self.patience.halvings):
            low, high, ending = self.closer((low, high), ending, part, divide, up)
            gaps.append(abs(self.hold(high, divide, up, whole=True).speed - ending.speed))
        apart = abs(self.voltage(high) - self.voltage(low)) / self.volts
        lost = gaps[1] > self.patience.kept * gaps[0] and gaps[1] > 10.0 * apart
        if not lost:
            return Verdict(FOLLOWS, math.nan, math.nan)
        return Verdict(LOST, self.voltage(low), self.voltage(high))

    def closer(
        self, ends: tuple[float, float], ending: Ending, width: float, divide: float, up: bool
    ) -> tuple[float, float, Ending]:
        """Steps whose voltages are no further apart than ``width``, and how the lower one ends."""
        low, high = ends
        while high - low > SHARE:
            if abs(self.voltage(high) - self.voltage(low)) <= width * self.volts:
                break
            middle = 0.5 * (low + high)
            found = self.hold(middle, divide, up)
            if found.left:
                high = middle
            else:
                low, ending = middle, found
        return low, high, ending


def at_rest(changes: np.ndarray, rest: float) -> bool:
    """Whether speeds with these last changes have arrived: those by a fold are slow, but go on."""
    sizes = np.abs(changes)
    if len(sizes) < 4:
        return False
    return bool((sizes[1:] < 0.67 * sizes[:-1]).all() and 2.0 * sizes[-1] < rest) or bool(
        sizes.max() < 0.01 * rest
    )


def with_a_last_one(chunks: list[Chunk]) -> list[Chunk]:
    """Chunks with the last item, which is not a step, as one of its own."""
    last = chunks[-1]
    if last.last - last.first == 1:
        return chunks
    steps = Chunk(last.index, last.first, last.last - 1, last.after)
    return [*chunks[:-1], steps, Chunk(last.index + 1, last.last - 1, last.last, last.index)]
