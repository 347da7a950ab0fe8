"""The one dataset of channels over time, measured or simulated."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import NOT_NUMBERS, InputError
from ..lazy import xr
from ..model.arguments import checked_unmasked
from ..response.labels import variable
from .conversion import MOTIONS, differentiate_and_advance
from .pieces import Floats
from .record_checks import doubtful_channels
from .signals import HERTZ, checked_quantity
from .time_base import interpolate_at, make_times_equal

ACCELERATIONS = {  # long names
    "box_acceleration": "acceleration of the box",
    "acceleration1": "absolute acceleration of mass 1",
    "acceleration2": "absolute acceleration of mass 2",
}
FORCES = {"force1": "force on mass 1", "force2": "force on mass 2"}  # long names
CHANNELS = {**ACCELERATIONS, **FORCES}
SHORT_NAMES = {"box_acceleration": "base", "acceleration1": "face 1", "acceleration2": "face 2"}
SHORT_NAMES |= {"force1": "force 1", "force2": "force 2"}
FEWEST = 4


def record(
    *,
    time: ArrayLike | None = None,
    box_acceleration: ArrayLike | None = None,
    acceleration1: ArrayLike | None = None,
    acceleration2: ArrayLike | None = None,
    force1: ArrayLike | None = None,
    force2: ArrayLike | None = None,
    sample_rate: float | None = None,
    source: str = "measured",
    sensors: Mapping[str, str] | str = "",
    title: str = "Record",
) -> xr.Dataset:
    """Make a record: check the channels of one measurement and put them in a dataset.

    Parameters
    ----------
    time : array_like, optional
        s, in equal steps; or give ``sample_rate``, then it begins at 0.
    box_acceleration, acceleration1, acceleration2 : array_like, optional
        Absolute accelerations of the box and the masses, m/s2; one of them at least.
    force1, force2 : array_like, optional
        N, of a structure that is excited by a force on a half in place of its base: for
        :func:`orchestrate.frf`, :func:`orchestrate.halves` and :func:`orchestrate.signs`.
    sample_rate : float, optional
        Hz; by default from ``time``. Of both the rate corrects times that are rounded.
    source : str
        Where it comes from: a file, ``"measured"``, ``"simulated"``.
    sensors : str or mapping of str to str
        What the channels were measured by.
    title : str

    Returns
    -------
    xarray.Dataset
        Over ``time`` in s the channels given, m/s2; attributes ``sample_rate`` in Hz, ``source``
        and ``sensors``.

    Raises
    ------
    InputError
        Where something is no number, missing, or not in equal steps; it names the first such row,
        counted from 0.

    Warns
    -----
    UserWarning
        Where a channel looks as if it had another unit, is saturated, keeps one value while the
        base moves, or is the same as another.

    Examples
    --------
    >>> made = record(box_acceleration=[0.0, 1.0, 0.0, -1.0], sample_rate=1000.0)
    >>> made.time.values[-1], made.attrs["sample_rate"]
    (np.float64(0.003), 1000.0)
    """
    columns = box_acceleration, acceleration1, acceleration2, force1, force2
    channels = dict(zip(CHANNELS, columns, strict=True))
    measured = {name: one for name, one in channels.items() if one is not None}
    words = sensors
    if isinstance(sensors, Mapping):
        words = "; ".join(f"{name}: {text}" for name, text in sensors.items())
    attributes = {"title": title, "source": source, "sensors": words}
    return make_record(time, measured, sample_rate, attributes)


def make_record(
    time: ArrayLike | None,
    channels: Mapping[str, ArrayLike],
    sample_rate: float | None,
    attributes: Mapping[str, Any],
    reading: ReadingOptions | None = None,
) -> xr.Dataset:
    """Make a record as :func:`record` does, of channels with options of reading."""
    import xarray as xr

    reading = reading or ReadingOptions()
    raw = {
        name: checked_finite_list(name, one, reading.first_row) for name, one in channels.items()
    }
    if not raw:
        raise InputError(f"record: no channel given; expected one of {', '.join(CHANNELS)}")
    rate = None if sample_rate is None else checked_quantity(HERTZ, "sample_rate", sample_rate)
    if time is not None:
        times = checked_finite_list("time", time, reading.first_row)
    elif rate is not None:
        times = np.arange(len(next(iter(raw.values())))) / rate
    else:
        raise InputError("record: neither time nor sample_rate given; expected one of them")
    for name, one in raw.items():
        if len(one) != len(times):
            raise InputError(f"{name}: {len(one)} values; expected {len(times)}, as the times")
    even, rate, time_base = make_times_equal(times, rate, reading.first_row, reading.resample)
    if "resampled" in time_base:
        raw = {name: interpolate_at(times, one, even) for name, one in raw.items()}
    kept = reading.samples_in_all_channels(len(even), rate)
    values = {name: reading.to_acceleration(name, one, rate)[kept] for name, one in raw.items()}
    raw, even = {name: one[kept] for name, one in raw.items()}, even[kept]
    if attributes.get("source") != "simulated":
        for name, what, advice in doubtful_channels(even, values, raw):
            text = f"{what}{'' if what.endswith('?') else ';'} {advice}"
            warnings.warn(f"{channel_label(name)}: {text}", UserWarning, stacklevel=4)
    words = {"sensors": "", **attributes, "sample_rate": rate}
    words |= reading.attributes(time_base, len(times) - len(even))
    return xr.Dataset(
        {
            name: variable("time", one, unit_of_channel(name), CHANNELS[name])
            for name, one in values.items()
        },
        {"time": variable("time", even, "s", "time")},
        words,
    )


@dataclass(frozen=True)
class ReadingOptions:
    """How the values of a record's channels become accelerations at equal times."""

    first_row: int = 0  # from which rows in messages are counted
    resample: bool = False  # uneven times are made equal
    derivatives: Mapping[str, int] = field(default_factory=dict)  # that make accelerations
    scale: Mapping[str, float] = field(default_factory=dict)  # factors
    delay: Mapping[str, float] = field(default_factory=dict)  # s by which channels are late

    def to_acceleration(self, name: str, values: Floats, rate: float) -> Floats:
        lateness = self.delay.get(name, 0.0)
        made = differentiate_and_advance(values, rate, self.derivatives.get(name, 0), lateness)
        return made if name not in self.scale else self.scale[name] * made

    def samples_in_all_channels(self, count: int, rate: float) -> slice:
        """Return the samples of which all channels, earlier by their delays, have data."""
        samples = {name: delay * rate for name, delay in self.delay.items()}
        first = math.ceil(max((-one for one in samples.values()), default=0.0) - 1e-6)
        last = count - max(0, math.ceil(max(samples.values(), default=0.0) - 1e-6))
        if last - (first := max(0, first)) < FEWEST:
            delays = ", ".join(f"{SHORT_NAMES[n]} {one:g} s" for n, one in self.delay.items())
            text = f"expected delays that leave {FEWEST} of {count} samples, at {rate:.6g} Hz"
            raise InputError(f"delay: {delays}; {text}")
        return slice(first, last)

    def attributes(self, time_base: str, cut: int = 0) -> dict[str, str]:
        """Return what was done to the channels, as attributes of the record."""
        converted = [
            f"{SHORT_NAMES[name]}: {MOTIONS[count]}, differentiated by its spectrum"
            for name, count in self.derivatives.items()
            if count
        ]
        words = {"time_base": time_base, "converted": ", ".join(converted)}
        words["cut"] = f"{cut} samples of which a delayed channel has no data" if cut else ""
        return {name: text for name, text in words.items() if text}


def array_of_numbers(name: str, values: Any, dtype: type = float) -> NDArray[Any]:
    """Return a copy of an argument as an array; raise unless it has only numbers, NaN too."""
    checked_unmasked(name, values)
    try:
        return np.array(values, dtype=dtype)
    except NOT_NUMBERS:
        raise InputError(f"{name}: expected a list of numbers") from None


def checked_finite_list(name: str, argument: Any, first_row: int = 0) -> Floats:
    """Return a list as an array of floats; raise with the row where one is not finite."""
    values = array_of_numbers(name, argument)
    if values.ndim != 1 or len(values) < FEWEST:
        shape = "x".join(map(str, values.shape)) or "one"
        raise InputError(f"{name}: {shape} values; expected a list of {FEWEST} numbers or more")
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        text = f"{name}, row {wrong[0] + first_row}: {values[wrong[0]]}{more}"
        raise InputError(f"{text}; expected finite numbers")
    return values


def unit_of_channel(name: str) -> str:
    return "N" if name in FORCES else "m/s2"


def channel_label(name: str) -> str:
    """Return a channel's short name and its name in Python: base (box_acceleration)."""
    return f"{SHORT_NAMES[name]} ({name})"
