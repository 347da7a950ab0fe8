"""The one dataset of channels over time, measured or simulated."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..response.labels import variable
from .pieces import Floats
from .record_checks import doubtful_channels
from .signals import HERTZ, checked

if TYPE_CHECKING:
    import xarray as xr

CHANNELS = {  # long names
    "box_acceleration": "acceleration of the box",
    "acceleration1": "absolute acceleration of mass 1",
    "acceleration2": "absolute acceleration of mass 2",
}
SHORT_NAMES = {"box_acceleration": "base", "acceleration1": "face 1", "acceleration2": "face 2"}
FEWEST = 4
UNEVEN = 0.05  # largest distance of a time from equal steps, parts of a step
LAST_TIMES = 20  # which show to how many digits times are rounded: the late ones have fewest


def record(
    *,
    time: ArrayLike | None = None,
    box_acceleration: ArrayLike | None = None,
    acceleration1: ArrayLike | None = None,
    acceleration2: ArrayLike | None = None,
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
    channels = dict(zip(CHANNELS, (box_acceleration, acceleration1, acceleration2), strict=True))
    given = {name: one for name, one in channels.items() if one is not None}
    words = sensors
    if isinstance(sensors, Mapping):
        words = "; ".join(f"{name}: {text}" for name, text in sensors.items())
    attributes = {"title": title, "source": source, "sensors": words}
    return checked_record(time, given, sample_rate, attributes)


def checked_record(
    time: ArrayLike | None,
    channels: Mapping[str, ArrayLike],
    sample_rate: float | None,
    attributes: Mapping[str, Any],
    first_row: int = 0,
) -> xr.Dataset:
    """Make a record as :func:`record` does, with rows in messages counted from ``first_row``."""
    import xarray as xr

    values = {name: checked_numbers(name, one, first_row) for name, one in channels.items()}
    if not values:
        raise InputError(f"record: no channel given; expected one of {', '.join(CHANNELS)}")
    rate = None if sample_rate is None else checked(HERTZ, "sample_rate", sample_rate)
    if time is not None:
        times = checked_numbers("time", time, first_row)
    elif rate is not None:
        times = np.arange(len(next(iter(values.values())))) / rate
    else:
        raise InputError("record: neither time nor sample_rate given; expected one of them")
    for name, one in values.items():
        if len(one) != len(times):
            raise InputError(f"{name}: {len(one)} values; expected {len(times)}, as the times")
    times, rate = checked_times(times, rate, first_row)
    if attributes.get("source") != "simulated":
        for name, what, advice in doubtful_channels(times, values):
            text = f"{what}{'' if what.endswith('?') else ';'} {advice}"
            warnings.warn(f"{channel_label(name)}: {text}", UserWarning, stacklevel=4)
    return xr.Dataset(
        {name: variable("time", one, "m/s2", CHANNELS[name]) for name, one in values.items()},
        {"time": variable("time", times, "s", "time")},
        {"sensors": "", **attributes, "sample_rate": rate},
    )


def checked_numbers(name: str, given: Any, first_row: int = 0) -> Floats:
    """Return a list as an array of floats; raise with the row where one is not finite."""
    try:
        values = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected a list of numbers") from None
    if values.ndim != 1 or len(values) < FEWEST:
        shape = "x".join(map(str, values.shape)) or "one"
        raise InputError(f"{name}: {shape} values; expected a list of {FEWEST} numbers or more")
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        text = f"{name}, row {wrong[0] + first_row}: {values[wrong[0]]}{more}"
        raise InputError(f"{text}; expected finite numbers")
    return values


def checked_times(times: Floats, rate: float | None, first_row: int = 0) -> tuple[Floats, float]:
    """Return equally spaced times and their rate, Hz; a stated rate corrects rounded times."""
    count, resolution = np.arange(len(times)), time_resolution(times)
    if rate is not None:
        spread = float(np.ptp(times - count / rate))
        if spread <= UNEVEN / rate:
            return times, rate
        if spread <= rounding_error(resolution, 1.0 / rate):
            return times[0] + count / rate, rate
    step = float(times[-1] - times[0]) / (len(times) - 1)
    off = float(np.abs(times - times[0] - step * count).max())
    is_rounded = off <= rounding_error(resolution, step)
    if rate is not None and (is_rounded or off <= UNEVEN * step):
        raise InputError(f"sample_rate = {rate!r} Hz: expected {1.0 / step:.6g}, as the times have")
    if off <= UNEVEN * step:
        return times, float(f"{1.0 / step:.10g}")  # the digits of the times are not those of it
    steps = np.diff(times)
    usual = float(np.median(steps))
    falling = np.flatnonzero(steps <= 0.0)
    away = falling if len(falling) else np.flatnonzero(np.abs(steps - usual) > 2.0 * UNEVEN * usual)
    row = int(away[0]) + 1 if len(away) else 1
    if len(falling):
        text = f"{times[row]:.9g} s after {times[row - 1]:.9g} s; expected ascending times"
    else:
        text = f"a step of {steps[row - 1]:.6g} s where others are {usual:.6g} s"
        text += "; expected equal steps"
    if is_rounded:
        text += f": they are rounded to {resolution:g} s, give sample_rate="
    raise InputError(f"time, row {row + first_row}: {text}")


def rounding_error(resolution: float, step: float) -> float:
    """Return the range of the errors of rounded times, s: 0 where the step needs no rounding."""
    whole = resolution and abs(step / resolution - round(step / resolution)) < 1e-6
    return 0.0 if whole else resolution * (1.0 + 1e-6)


def time_resolution(times: Floats) -> float:
    """Return the power of ten that the last times are multiples of, s; 0 if there is none.

    Examples
    --------
    >>> time_resolution(np.array([9.9998, 10.001, 10.002])), time_resolution(np.arange(4) / 3.0)
    (0.001, 0.0)
    """
    last = times[-min(LAST_TIMES, len(times) // 2 + 1) :]
    for digits in range(10):
        scaled = last * 10.0**digits
        if np.abs(scaled - np.round(scaled)).max() < 1e-4:
            return float(10.0**-digits)
    return 0.0


def channel_label(name: str) -> str:
    """Return a channel's name as people say it and as it is in Python: base (box_acceleration)."""
    return f"{SHORT_NAMES[name]} ({name})"
