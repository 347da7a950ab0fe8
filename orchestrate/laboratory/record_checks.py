"""Checks of a record's channels: what makes one doubtful, and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from .pieces import Floats

PLAUSIBLE = (0.05, 2e5)  # largest absolute values that accelerometers read in tests, m/s2
CLIPPED = 1e-4  # share of samples at repeated extremes from which a channel is saturated
SLOWEST, LONGEST = 1.0, 3600.0  # Hz, s: a rate below, a duration above have another unit of time
PLATEAU = 3  # samples in a row at an extreme that no sine has


def doubtful_channels(
    time: Floats, accelerations: Mapping[str, Floats], channels: Mapping[str, Floats]
) -> list[tuple[str, str, str]]:
    """Return what makes channels, the base first, doubtful: (channel, what it is, what to do)."""
    doubts, knocked = [], any(name.startswith("force") for name in channels)
    for name, values in channels.items():
        other = next((one for key, one in channels.items() if key != name), values)
        force = name.startswith("force")  # of a hammer it is 0 most of the time
        # a half next to the one that is struck may hardly move
        wrong_unit = "" if knocked else doubt_about_unit(accelerations[name])
        share = clipped_share(values)
        constant = None if force else stuck_part(values, other)
        if wrong_unit:
            doubts.append((name, wrong_unit, "expected m/s2"))
        if share > CLIPPED:
            text = f"saturated: {100.0 * share:.2g} % of its samples repeat its extreme values"
            doubts.append((name, text, "record it again with a wider range"))
        if constant is not None:
            first, last = time[constant.start], time[constant.stop - 1]
            text = f"keeps the value {values[constant.start]:.4g} from {first:.4g} to {last:.4g} s"
            doubts.append((name, text, "expected a reading: look for a loose cable"))
    for first, second in combinations(channels, 2):
        values, off = channels[first], np.abs(channels[first] - channels[second])
        # two sensors never differ so little
        if np.ptp(values) > 0.0 and off.max() <= 1e-9 * np.abs(values).max():
            doubts.append((second, f"the same values as {first}", "expected a channel each"))
    return doubts


def doubt_about_unit(values: Floats) -> str:
    """Return a question on the unit of numbers that are hardly in m/s2; empty if they may be."""
    peak, low, high = float(np.abs(values).max()), *PLAUSIBLE
    mean, spread = abs(float(values.mean())), float(values.std())
    if 0.0 < peak < low:
        return f"no more than {peak:.3g} m/s2: are these numbers in g, or in V?"
    if peak > high:
        return f"up to {peak:.3g} m/s2: are these numbers in mV, or counts?"
    if abs(mean - 1.0) < 0.03 and spread < 0.5 * mean:
        return f"a mean of {mean:.3g} m/s2, as gravity has in g: are these numbers in g?"
    return ""


def doubt_about_time_unit(times: Floats) -> str:
    """Return a question on the unit of times that no unit is stated of; empty if they may be s."""
    steps, duration = np.diff(times), float(np.ptp(times)) if len(times) else 0.0
    step = float(np.median(steps)) if len(steps) else 0.0
    if step * SLOWEST <= 1.0 and duration <= LONGEST:
        return ""
    text = f"no unit, taken as s: {step:.6g} s a sample, {duration:.6g} s in all"
    return f'{text}; if they are not in s, give their unit, such as unit="time=ms" or "time=us"'


def stuck_part(values: Floats, other: Floats) -> slice | None:
    """Return the longest part with one value in which another channel moves; None without one."""
    changes = np.flatnonzero(np.diff(values)) + 1
    ends = np.concatenate([[0], changes, [len(values)]])
    longest = int(np.argmax(np.diff(ends)))
    part = slice(int(ends[longest]), int(ends[longest + 1]))
    if part.stop - part.start < max(0.02 * len(values), 20):
        return None
    return part if other[part].std() > 0.1 * other.std() else None


def is_ascending(values: Floats) -> bool:
    """Return whether values never fall, and rise somewhere, as times and counters do."""
    steps = np.diff(values)
    return bool((steps >= 0.0).all() and (steps > 0.0).any())


def first_skipped_row(values: Floats) -> int | None:
    """Return the row where a counter (nine equal steps of ten) skips numbers, or None."""
    steps = np.diff(values)
    usual = float(np.median(steps)) if len(steps) else 0.0
    equal = np.abs(steps - usual) <= 0.5 * usual
    if not usual > 0.0 or equal.mean() < 0.9:
        return None
    holes = np.flatnonzero(steps > 1.5 * usual)
    return int(holes[0]) + 1 if len(holes) else None


def clipped_share(values: Floats, plateau: int = PLATEAU) -> float:
    """Return the share of samples at repeated extreme values, as a saturated channel has them.

    - A sample is at an extreme within 0.1 % of the peak-to-peak value, or less than a step of the
      digits away. It counts in a row of `plateau` or more such samples.
    - An extreme counts where these are three at least and outnumber the samples in the ten times
      wider band next to it: of a sine, coarsely digitized or not, there are less than half as many.
    - It has to be a quarter of the peak-to-peak value from the median: rest is no saturation.
    """
    ordered = np.sort(values)
    spread = float(ordered[-1] - ordered[0])
    steps = np.diff(ordered)
    if not spread > 0.0:
        return 0.0
    band = max(1e-3 * spread, 0.999 * float(steps[steps > 1e-9 * spread].min()))
    median, share = float(ordered[len(ordered) // 2]), 0.0
    for extreme in (ordered[0], ordered[-1]):
        distance = np.abs(values - extreme)
        at = distance < band
        row = np.convolve(at, np.ones(plateau), "valid") > plateau - 0.5
        repeated = int(np.convolve(row, np.ones(plateau)).astype(bool).sum())
        near = int(((distance >= band) & (distance < 11.0 * band)).sum())
        if repeated >= max(near + 1, PLATEAU) and abs(extreme - median) >= 0.25 * spread:
            share += repeated / len(values)
    return share
