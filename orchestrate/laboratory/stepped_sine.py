"""A sine that dwells on one frequency after the other, long enough to settle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..constants import TURN
from ..errors import InputError
from ..model.ranges import Quantity
from .pieces import ERROR, Floats, Pieces, max_phase_step, subdivide
from .signals import HERTZ, Profile, Sine, checked_level, checked_quantity

CYCLES = Quantity("cycles", "", "", 0.0, 1e6)
MOST_FREQUENCIES = 100_000


@dataclass(frozen=True, kw_only=True)
class SteppedSine(Sine):
    """A sine of one frequency after the other: at each the structure settles, then it is measured.

    The frequency changes at a peak of the acceleration, where the box's velocity passes zero: the
    sine continues without a jump while its level stays, and the box does not drift. The first one
    begins at zero and has a quarter of a cycle more.

    Parameters
    ----------
    frequencies : sequence of float
        Hz, in the order in which they are played.
    acceleration : float or sequence of (float, float)
        Peak acceleration, m/s2, or its profile as break points (Hz, m/s2), as for
        :class:`orchestrate.SweptSine`.
    settle_cycles : int
        Cycles at each frequency before what is measured. A free vibration with a damping ratio of
        zeta falls to a thousandth within ``1.1/zeta`` cycles.
    measured_cycles : int
        Cycles at each frequency that are measured.

    Examples
    --------
    >>> stepped = SteppedSine(frequencies=(40.0, 41.0, 42.0), acceleration=4.9, settle_cycles=150)
    >>> round(stepped.duration, 2), stepped.measured_times()[0].round(3).tolist()
    (14.65, [3.756, 5.006])
    """

    frequencies: tuple[float, ...]
    acceleration: float | Profile
    settle_cycles: int = 100
    measured_cycles: int = 50
    duration: float = field(init=False)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "frequencies", checked_frequencies(self.frequencies))
        low, high = min(self.frequencies), max(self.frequencies)
        put(self, "acceleration", checked_level("acceleration", self.acceleration, low, high))
        for name, least in (("settle_cycles", 0), ("measured_cycles", 1)):
            cycles = checked_quantity(CYCLES, name, getattr(self, name))
            if cycles != int(cycles) or cycles < least:
                raise InputError(f"{name} = {cycles!r}: expected a whole number >= {least}")
            put(self, name, int(cycles))
        put(self, "duration", float(self._change_times_and_phases()[0][-1]))

    def _change_times_and_phases(self) -> tuple[Floats, Floats]:
        """Return times, s, and phases, rad, of the changes of frequency, with beginning and end."""
        cycles = np.full(len(self.frequencies), self.settle_cycles + self.measured_cycles, float)
        cycles[0] += 0.25
        times = np.cumsum([0.0, *(cycles / np.array(self.frequencies))])
        return times, TURN * np.cumsum([0.0, *cycles])

    @property
    def label(self) -> str:
        first, last, count = self.frequencies[0], self.frequencies[-1], len(self.frequencies)
        over = f"{first:g} to {last:g} Hz in {count} steps" if count > 1 else f"{first:g} Hz"
        return f"stepped sine {over} and {self.duration:.4g} s"

    @property
    def usual_rate(self) -> float:
        return 20.0 * max(self.frequencies)

    def measured_times(self) -> Floats:
        """Return beginning and end of the measured part at each frequency, s; shape (n, 2)."""
        ends = self._change_times_and_phases()[0][1:]
        return np.stack([ends - self.measured_cycles / np.array(self.frequencies), ends], axis=1)

    def _step_index_at(self, time: ArrayLike) -> NDArray[np.int_]:
        """Return the index of the frequency that is played at a time."""
        changes = self._change_times_and_phases()[0][1:-1]
        return np.searchsorted(changes, np.asarray(time, dtype=float), side="right")

    def frequency(self, time: ArrayLike) -> Floats:
        return np.array(self.frequencies)[self._step_index_at(time)]

    def phase(self, time: ArrayLike) -> Floats:
        t = np.asarray(time, dtype=float)
        times, phases = self._change_times_and_phases()
        step = self._step_index_at(t)
        return np.asarray(phases[step] + TURN * self.frequency(t) * (t - times[step]))

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        """Return pieces of equal phase at each frequency."""
        times, phases = self._change_times_and_phases()
        longest = max_phase_step(accuracy)
        self.check_piece_count(phases[-1], longest, "stepped sine")
        nodes = subdivide(times, np.ceil(np.diff(phases) / longest).astype(int))
        angles = TURN * self.frequency(nodes[:-1]) * np.diff(nodes)
        error = float((self.level(nodes[:-1]) * angles**4).max() / ERROR)
        return Pieces.interpolate(nodes, self, error)


def checked_frequencies(argument: Any) -> tuple[float, ...]:
    """Return frequencies in Hz as floats; raise unless there is one at least."""
    several = isinstance(argument, (Sequence, np.ndarray)) and not isinstance(argument, str)
    several = several and getattr(argument, "ndim", 1) > 0
    values = tuple(argument) if several else ()
    if not 1 <= len(values) <= MOST_FREQUENCIES:
        text = f"{len(values)} of them" if several else repr(argument)
        raise InputError(f"frequencies: {text}; expected 1 to {MOST_FREQUENCIES} numbers in Hz")
    return tuple(checked_quantity(HERTZ, f"frequencies[{i}]", f) for i, f in enumerate(values))
