"""An acceleration known at equal times: a record played again."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np

from ..errors import InputError
from ..lazy import xr
from ..model.arguments import check_and_convert_fields
from .pieces import Pieces
from .record import checked_finite_list
from .signals import MOST_PIECES, ExcitationSignal, Hertz


@dataclass(frozen=True, kw_only=True)
class Sampled(ExcitationSignal):
    """Play an acceleration that is known at equal times, as an analyser's record has it.

    Between the samples the natural choice of cubics: the spline through them, with two continuous
    derivatives. That is the excitation itself, so the pieces have no error.

    Parameters
    ----------
    acceleration : array_like
        Samples from time 0 on, m/s2; at least four.
    sample_rate : float
        Hz.
    """

    acceleration: tuple[float, ...]
    sample_rate: Hertz
    duration: float = field(init=False)

    def __post_init__(self) -> None:
        put = object.__setattr__
        check_and_convert_fields(self)
        try:
            values = checked_finite_list("acceleration", self.acceleration)
        except InputError as error:
            raise InputError(f"{error}, in m/s2, at most {MOST_PIECES} of them") from None
        if len(values) > MOST_PIECES:
            text = f"{len(values)} values; expected a list of at most {MOST_PIECES} numbers"
            raise InputError(f"acceleration: {text}")
        put(self, "acceleration", tuple(values.tolist()))
        put(self, "duration", (len(values) - 1) / self.sample_rate)

    def __repr__(self) -> str:
        """Return a short text with a checksum of the samples, which may be millions."""
        values = np.array(self.acceleration)
        digest = hashlib.sha256(values.tobytes()).hexdigest()[:16]
        made = f"acceleration={len(values)} values of {digest}, sample_rate={self.sample_rate!r}"
        return f"{type(self).__name__}({made})"

    @classmethod
    def from_record(cls, record: xr.Dataset) -> Sampled:
        """Take the box's acceleration of a record, from its beginning on.

        Parameters
        ----------
        record : xarray.Dataset
            As :func:`orchestrate.record` makes it.

        Raises
        ------
        InputError
            Where it has none.
        """
        known = "box_acceleration" in getattr(record, "variables", {})
        if not known or "sample_rate" not in record.attrs:
            text = "expected one with box_acceleration and the attribute sample_rate"
            raise InputError(f"record: {text}")
        rate = float(record.attrs["sample_rate"])
        return cls(acceleration=record.box_acceleration.values, sample_rate=rate)

    @property
    def label(self) -> str:
        return f"{len(self.acceleration)} samples at {self.sample_rate:g} Hz"

    @property
    def usual_rate(self) -> float:
        return self.sample_rate

    def pieces(self, accuracy: float = 1e-6) -> Pieces:
        from scipy.interpolate import CubicSpline

        nodes = np.arange(len(self.acceleration)) / self.sample_rate
        third, second, first, value = CubicSpline(nodes, self.acceleration).c
        return Pieces(nodes, np.stack([value, first, 2.0 * second, 6.0 * third], axis=1), 0.0)
