"""The times of a record: equal steps, rounded ones, uneven ones, and the channels at them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..errors import InputError
from .pieces import Floats

UNEVEN = 0.05  # largest distance of a time from equal steps, parts of a step


def make_times_equal(
    times: Floats, rate: float | None, first_row: int, resample: bool
) -> tuple[Floats, float, str]:
    """Return equally spaced times, their rate in Hz, and what was done to make them equal.

    - Times within 5 % of a step of equal ones are kept.
    - Rounded ones, whose distances from equal steps range over no more than their last digit,
      become equal: by the stated rate, else, if that is ten steps at most, by the roundest one.
    - Others are refused, as times that contradict a stated rate; with `resample` they become equal,
      unless they fall or have a gap.
    """
    count, resolution = np.arange(len(times)), time_resolution(times)
    if rate is not None:
        spread = float(np.ptp(times - count / rate))
        if spread <= UNEVEN / rate:
            return times, rate, ""
        if spread <= rounding_range(resolution, 1.0 / rate):
            return times[0] + count / rate, rate, f"rounded to {resolution:g} s"
    step = float(times[-1] - times[0]) / (len(times) - 1)
    if step <= 0.0:  # some are not ascending
        return resample_or_raise(times, first_row, resample)
    off = float(np.abs(times - times[0] - step * count).max())
    rounded = roundest_rate(times, resolution)
    if rate is not None and (rounded is not None or off <= UNEVEN * step):
        raise InputError(f"sample_rate = {rate!r} Hz: expected {1.0 / step:.6g}, as the times have")
    if off <= UNEVEN * step:
        return times, float(f"{1.0 / step:.10g}"), ""  # the digits of the times are not those of it
    if rounded is not None:
        words = f"rounded to {resolution:g} s, taken as {rounded:.10g} Hz"
        return times[0] + count / rounded, rounded, words
    return resample_or_raise(times, first_row, resample)


def resample_or_raise(times: Floats, first_row: int, resample: bool) -> tuple[Floats, float, str]:
    """Return equal times in place of uneven ones and a note; raise unless that is wanted."""
    steps = np.diff(times)
    usual = float(np.median(steps))
    # beyond three steps samples are lost, which no spline knows
    falling, gaps = np.flatnonzero(steps <= 0.0), np.flatnonzero(steps > 3.0 * usual)
    if resample and not len(falling) and not len(gaps):
        count = np.arange(len(times))
        step, start = np.polyfit(count, times, 1)
        jitter = float(np.std(times - start - step * count))
        words = f"resampled to {1.0 / step:.6g} Hz; jitter {jitter:.2g} s, {jitter / step:.2g} step"
        even = np.linspace(times[0], times[-1], len(times))
        return even, (len(times) - 1) / float(times[-1] - times[0]), words
    away = falling if len(falling) else gaps
    if not len(away):
        away = np.flatnonzero(np.abs(steps - usual) > 2.0 * UNEVEN * usual)
    row = int(away[0]) + 1 if len(away) else 1
    if len(falling):
        text = f"{times[row]:.9g} s after {times[row - 1]:.9g} s; expected ascending times"
    elif len(gaps):
        text = f"a step of {steps[row - 1]:.6g} s where others are {usual:.6g} s; expected equal "
        text += "steps: samples are lost, cut the record there"
    else:
        text = f"a step of {steps[row - 1]:.6g} s where others are {usual:.6g} s; expected equal "
        text += "steps: resample= makes them"
    raise InputError(f"time, row {row + first_row}: {text}")


def roundest_rate(times: Floats, resolution: float) -> float | None:
    """Return the rate of rounded times with fewest digits, Hz; None if they are not rounded."""
    count, steps = np.arange(len(times)), np.diff(times)
    step = float(np.polyfit(count, times, 1)[0])
    unequal = np.abs(steps - np.median(steps)) > 0.05 * resolution
    if not 0.0 < resolution <= 10.0 * step or unequal.sum() < 3:
        return None
    return fewest_digits(1.0 / step, lambda f: np.ptp(times - count / f) <= 1.05 * resolution)


def fewest_digits(number: float, fits: Callable[[float], Any]) -> float | None:
    """Return a number rounded to as few digits as fit; None if ten do not."""
    rounded = (float(f"{number:.{digits}g}") for digits in range(1, 11))
    return next(filter(fits, rounded), None)


def rounding_range(resolution: float, step: float) -> float:
    """Return the range of the errors of rounded times, s: 0 where the step needs no rounding."""
    whole = resolution and abs(step / resolution - round(step / resolution)) < 1e-6
    return 0.0 if whole else resolution * (1.0 + 1e-6)


def time_resolution(times: Floats) -> float:
    """Return the power of ten that the last times are multiples of, s; 0 if there is none."""
    last = times[-min(20, len(times) // 2 + 1) :]  # late ones have the fewest digits
    for digits in range(10):
        scaled = last * 10.0**digits
        if np.abs(scaled - np.round(scaled)).max() < 1e-4:
            return float(10.0**-digits)
    return 0.0


def interpolate_at(times: Floats, values: Floats, new_times: Floats) -> Floats:
    """Return a channel at other times, by the cubic spline through its samples."""
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(times, values)(new_times))
