"""The knock of an impulse hammer on one of the halves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

from ..model.arguments import check_and_convert_fields, whole
from ..model.ranges import Quantity
from .pieces import Pieces
from .shock import Shock
from .signals import ExcitationSignal, Moment, Seconds, checked_duration, checked_quantity

LISTENED = 1000.0  # widths from the knock to the end of the record


@dataclass(frozen=True, kw_only=True)
class Hammer(ExcitationSignal):
    """A knock on a half: a force that is half a sine, with the box at rest.

    Knocks for averages, far enough from each other that the motion dies out, are added:
    ``one + other``. All of a sum are on the same half.

    Parameters
    ----------
    peak : float
        Largest force, N; negative against the direction of x.
    width : float
        Duration of the contact, s.
    at : float
        Beginning, s.
    half : int
        1 or 2.
    duration : float, optional
        Of all, s; by default a thousand widths after the knock's beginning.

    Examples
    --------
    >>> knock = Hammer(peak=20.0, width=0.004, at=0.1)
    >>> knock.duration, knock.drives
    (4.1, 'force1')
    """

    peak: Annotated[float, partial(checked_quantity, Quantity("peak", "N", "", -1e12, 1e12))]
    width: Seconds
    at: Moment = 0.0
    half: Annotated[int, whole(1, 2)] = 1
    duration: float = 0.0

    def __post_init__(self) -> None:
        check_and_convert_fields(self)
        usual, end = self.at + LISTENED * self.width, self.at + self.width
        duration = checked_duration(self.duration, usual, end, "at + width")
        object.__setattr__(self, "duration", duration)

    @property
    def drives(self) -> str:
        """Input of the FMU, and channel of records: force1 or force2."""
        return f"force{self.half}"

    @property
    def label(self) -> str:
        return f"hammer on half {self.half}, {self.peak:.4g} N for {1e3 * self.width:.4g} ms"

    @property
    def usual_rate(self) -> float:
        return 20.0 / self.width

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        pulse = Shock(
            peak=abs(self.peak), length=self.width, delay=self.at, duration=self.duration
        ).pieces(accuracy)
        return pulse if self.peak >= 0.0 else replace(pulse, derivatives=-pulse.derivatives)
