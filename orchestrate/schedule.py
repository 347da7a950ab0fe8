"""What a run of the weak drive is: the voltage over time, and all else that decides its numbers."""

import math
from dataclasses import asdict, dataclass

from .coupling import Scheme
from .setups import Setup


@dataclass(frozen=True)
class Schedule:
    """The voltage over time: settle, there, back; eta0 and 1/omega.

    Attributes
    ----------
    first, last : float
        Ends of eta0; the same for a constant voltage.
    rate : float
        Change of eta0 per unit time, > 0; on average, where ``increment`` is not 0.
    settle : float
        Time at ``first`` before.
    increment : float
        Height of steps; 0 for a ramp.
    back : bool
        Whether it goes back to ``first`` again.
    """

    first: float
    last: float
    rate: float
    settle: float = 300.0
    increment: float = 0.0
    back: bool = True

    @property
    def rise(self):
        """Time the voltage takes from one end to the other."""
        return abs(self.last - self.first) / self.rate

    @property
    def duration(self):
        """Time of the whole run."""
        return self.settle + self.rise * (2 if self.back else 1)

    def eta0(self, time):
        """Voltage at a time."""
        ramp = min(max(time - self.settle, 0.0), self.duration - self.settle)
        there = ramp <= self.rise
        change = self.rate * (ramp if there else 2.0 * self.rise - ramp)
        if self.increment:
            count = change / self.increment
            change = self.increment * (math.floor(count + 1e-9) if there else math.ceil(count - 1e-9))
        return self.first + math.copysign(min(change, abs(self.last - self.first)), self.last - self.first)


@dataclass(frozen=True)
class Plan:
    """One run.

    Attributes
    ----------
    setup : Setup
    schedule : Schedule
    scheme : Scheme
        With its step in 1/omega.
    speed : float
        At the start, over omega.
    guids : tuple of str
        Of the FMUs that compute it.
    """

    setup: Setup
    schedule: Schedule
    scheme: Scheme
    speed: float
    guids: tuple

    def identity(self):
        """All that decides the numbers, as plain data."""
        return asdict(self)

    @property
    def steps(self):
        """Number of communication steps."""
        return math.ceil(self.schedule.duration / self.scheme.h - 1e-9)
