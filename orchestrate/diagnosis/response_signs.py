"""Signs of accelerations over time: orders, coherence, moments, differences between responses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..laboratory.analysis.channels import BOX, Channels, WelchSegments, divide_into_segments
from ..laboratory.analysis.frf import EXCITED
from ..laboratory.analysis.order_tracking import Window, fit_orders_in_windows
from ..laboratory.pieces import Floats

OFF_ORDERS = (2.37, 3.37)  # where no motion with a period has a line: what is there is noise
ORDERS = (0.5, 1.0, 2.0, 2.37, 3.0, 3.37, 4.0, 5.0)
HARMONICS = (2.0, 3.0, 4.0, 5.0)
OF_ORDERS = {"order_2": 2.0, "order_3": 3.0, "order_half": 0.5}
OVERLAP = 0.5
MAX_EDGE = 0.4  # highest beginning of the high band that may be given, over the sampling rate
MIN_WINDOWS = 4  # windows of a curve


@dataclass(frozen=True)
class Curve:
    """Hold the response over the base's motion along a frequency that only rises or falls."""

    direction: int  # 1 up, -1 down, 0 where all frequencies come at once
    level: float  # root mean square of the box's order 1, or of its acceleration, m/s2
    frequency: Floats  # ascending, Hz
    response: Floats  # complex
    floor: Floats  # what noise makes of the root mean square of the response, relative to it


@dataclass(frozen=True)
class ResponseSigns:
    """Hold the signs of the responses of a record."""

    # by the sign's name, of shape (rows,); frequencies in Hz, where a sign is largest
    values: dict[str, Floats]
    floors: dict[str, Floats]
    frequencies: dict[str, Floats]
    curves: list[Curve]
    noise: Floats  # root mean square of the noise, m/s2
    highest: float  # highest frequency of the excitation, Hz


def response_signs(
    channels: Channels, swept: bool, periods: float, high_band: float | None
) -> ResponseSigns:
    """Compute the signs that one record has by itself, without comparison."""
    own = signs_of_orders(channels, periods) if swept else curve_and_noise_by_spectra(channels)
    edge = default_high_band_edge(channels, own.highest) if high_band is None else high_band
    moments = moment_signs_and_floors(channels, edge)
    loss, loss_floor = coherence_loss_and_floor(channels, own.noise)
    values = {**own.values, **moments[0], "coherence_loss": loss}
    floors = {**own.floors, **moments[1], "coherence_loss": loss_floor}
    return replace(own, values=values, floors=floors)


def default_high_band_edge(channels: Channels, highest: float) -> float:
    """Return where the high band begins, Hz; NaN if the sampling rate does not reach it."""
    edge = min(6.0 * highest, 0.3 * channels.sample_rate)
    return edge if edge >= 3.3 * highest else math.nan


def has_trackable_sine(channels: Channels, periods: float) -> bool:
    """Return whether the box moves as a sine whose orders can be tracked."""
    box = Channels(channels.time, channels.sample_rate, (BOX,), channels.box[None], channels.title)
    try:
        fit_orders_in_windows(box, (1.0,), None, periods, OVERLAP)
    except InputError:
        return False
    return True


# -- a swept sine ---------------------------------------------------------------------------------


def signs_of_orders(channels: Channels, periods: float) -> ResponseSigns:
    """Compute the orders over the first one, and the response of order 1, of a swept sine."""
    windows, amplitudes, _ = fit_orders_in_windows(channels, ORDERS, None, periods, OVERLAP)
    box, rows = amplitudes[0], amplitudes[1:]
    frequency = np.array([window.frequency for window in windows])
    power = {order: np.abs(rows[:, ORDERS.index(order)]) ** 2 for order in ORDERS}
    sums = {order: nan_mean(power[order]) for order in ORDERS}
    off = np.fmin(*(sums[order] for order in OFF_ORDERS))
    values = {name: np.sqrt(sums[order] / sums[1.0]) for name, order in OF_ORDERS.items()}
    floors = {name: np.sqrt(off / sums[1.0]) for name in OF_ORDERS}
    peaks = {name: frequency[nan_argmax(power[order])] for name, order in OF_ORDERS.items()}
    total = np.nansum([power[order] for order in HARMONICS], axis=0)
    values["distortion"] = np.sqrt(nan_mean(total) / sums[1.0])
    floors["distortion"] = np.sqrt(len(HARMONICS) * off / sums[1.0])
    peaks["distortion"] = frequency[nan_argmax(total)]
    noise = noise_from_off_orders(windows, [power[order] for order in OFF_ORDERS])
    first = ORDERS.index(1.0)
    curves = curves_by_direction(windows, box[first], rows[:, first], floors["order_2"])
    return ResponseSigns(values, floors, peaks, curves, noise, float(frequency.max()))


def nan_mean(power: Floats) -> Floats:
    """Average each row over the windows that have a value; NaN where none has."""
    known = np.isfinite(power)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, power, 0.0).sum(axis=-1) / known.sum(axis=-1))


def nan_argmax(power: Floats) -> NDArray[np.intp]:
    return np.asarray(np.nan_to_num(power, nan=-1.0).argmax(axis=-1))


def noise_from_off_orders(windows: Sequence[Window], powers: Sequence[Floats]) -> Floats:
    """Estimate the root mean square of white noise from the off-orders, m/s2."""
    # Hann's weights over n samples leave 6 ln(2) s^2/n in the median, which impacts hardly raise
    samples = np.array([window.part.stop - window.part.start for window in windows])
    medians = [median_of_finite_columns(power * samples) for power in powers]
    return np.asarray(np.sqrt(np.fmin.reduce(medians) / (6.0 * math.log(2.0))))


def median_of_finite_columns(values: Floats) -> Floats:
    """Return the median of each row over the columns without NaN; NaN where there are none."""
    known = values[:, np.isfinite(values).all(axis=0)]
    return np.median(known, axis=-1) if known.size else np.full(len(values), np.nan)


def curves_by_direction(
    windows: Sequence[Window], box: Floats, rows: Floats, floor: Floats
) -> list[Curve]:
    """Split the response of order 1 into one curve upwards and one downwards."""
    frequency = np.array([window.frequency for window in windows])
    rate = smooth_rate(np.array([window.rate for window in windows]))
    curves = []
    for direction in (1, -1):
        chosen = np.flatnonzero(rate * direction > 0.0)
        if len(chosen) >= max(MIN_WINDOWS, 0.1 * len(windows)):  # fewer are noise, or a turn
            chosen = chosen[np.argsort(frequency[chosen])]
            level = math.sqrt(float(np.mean(np.abs(box[chosen]) ** 2)))
            response = rows[:, chosen] / box[chosen]
            curves.append(Curve(direction, level, frequency[chosen], response, floor))
    return curves


def smooth_rate(rate: Floats) -> Floats:
    """Smooth the sweep's rate by a running median: noise on the box moves single windows."""
    from scipy.ndimage import median_filter

    return np.asarray(median_filter(rate, size=min(15, len(rate)), mode="nearest"))


# -- any excitation -------------------------------------------------------------------------------


def curve_and_noise_by_spectra(channels: Channels) -> ResponseSigns:
    """Compute the response at the lines that the box excites, and the noise; without orders."""
    segments, faces, rate = welch_segments(channels), channels.values[1:], channels.sample_rate
    frequency, box, rows, cross = segments.compute_spectra(channels.box, faces, rate)
    excited = excited_lines(frequency, box)
    low, high = 0.36 * rate, 0.44 * rate
    density = median_of_finite_columns(rows[:, (frequency >= low) & (frequency <= high)])
    response = cross[:, excited] / box[excited]
    level, unknown = float(channels.box.std()), np.full(len(rows), np.nan)
    curve = Curve(0, level, frequency[excited], response, unknown)
    noise = np.sqrt(0.5 * channels.sample_rate * density)
    curves = [curve] if excited.sum() >= MIN_WINDOWS else []
    highest = float(frequency[excited].max()) if excited.any() else math.nan
    return ResponseSigns({}, {}, {}, curves, noise, highest)


def welch_segments(channels: Channels) -> WelchSegments:
    return divide_into_segments(channels, None, "hann", OVERLAP, fewest=2)


def excited_lines(frequency: Floats, box: Floats) -> NDArray[np.bool_]:
    """Return a mask of the lines of a spectrum that the base excites."""
    return np.asarray((box >= EXCITED * box.max()) & (frequency > 0.0))


def coherence_loss_and_floor(channels: Channels, noise: Floats) -> tuple[Floats, Floats]:
    """Return the mean of 1 less the coherence over the excited lines, and that of noise."""
    try:
        segments = welch_segments(channels)
    except InputError:
        unknown = np.full(len(noise), np.nan)
        return unknown, unknown
    faces, rate = channels.values[1:], channels.sample_rate
    frequency, box, rows, cross = segments.compute_spectra(channels.box, faces, rate)
    excited = excited_lines(frequency, box)
    with np.errstate(invalid="ignore", divide="ignore"):
        power = rows[:, excited]
        coherence = np.abs(cross[:, excited]) ** 2 / (box[excited] * power)
        share = 2.0 * noise[:, None] ** 2 / channels.sample_rate / power
        floor = np.minimum(share, 1.0).mean(axis=-1) + 1.0 / segments.independent_count
    return 1.0 - coherence.mean(axis=-1), np.minimum(floor, 1.0)


def moment_signs_and_floors(
    channels: Channels, edge: float
) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Compute kurtosis and skewness, of all and of the high band; and those of Gaussian noise."""
    from scipy.signal import butter, sosfiltfilt
    from scipy.stats import kurtosis, skew

    rows, count = channels.values[1:], len(channels.time)
    bands = {"": rows}
    if 0.0 < edge <= MAX_EDGE * channels.sample_rate:
        sections = butter(4, edge, "highpass", fs=channels.sample_rate, output="sos")
        bands["_high"] = sosfiltfilt(sections, rows)
    values: dict[str, Floats] = {}
    for ending in ("", "_high"):
        band = bands.get(ending)
        moves = band is not None and np.ptp(band, axis=-1).min() > 0.0
        unknown = np.full(len(rows), np.nan)
        values[f"kurtosis{ending}"] = kurtosis(band, axis=-1, fisher=False) if moves else unknown
        values[f"skewness{ending}"] = np.abs(skew(band, axis=-1)) if moves else unknown
    noise = {"kurtosis": 3.0, "skewness": 2.0 * math.sqrt(6.0 / count)}
    floors = {name: np.full(len(rows), noise[name.partition("_")[0]]) for name in values}
    return values, floors


# -- differences between responses ----------------------------------------------------------------


def sensor_difference_and_floor(curves: Sequence[Curve], channels: int) -> tuple[Floats, Floats]:
    """Compute the difference between two sensors, best complex gain taken out, and its floor."""
    rows = len(curves[0].response) if curves else 0
    if channels != 2 or not rows:
        unknown = np.full(rows, np.nan)
        return unknown, unknown
    every = np.concatenate([curve.response for curve in curves], axis=-1)
    one, other = every[0::2], every[1::2]
    gain = (other.conj() * one).sum(axis=-1) / (np.abs(other) ** 2).sum(axis=-1)
    rest = np.linalg.norm(one - gain[:, None] * other, axis=-1) / np.linalg.norm(one, axis=-1)
    floor = np.linalg.norm(curves[0].floor.reshape(-1, 2), axis=-1)
    return np.repeat(rest, 2), np.repeat(floor, 2)


def relative_rms_difference(one: Curve, other: Curve) -> Floats:
    """Return the rms difference of two curves over that of the first, of each row."""
    low, high = other.frequency[0], other.frequency[-1]
    common = (one.frequency >= low) & (one.frequency <= high)
    if common.sum() < MIN_WINDOWS:
        return np.full(len(one.response), np.nan)
    at, first = one.frequency[common], one.response[:, common]
    second = np.array([np.interp(at, other.frequency, row) for row in other.response])
    return np.asarray(np.linalg.norm(second - first, axis=-1) / np.linalg.norm(first, axis=-1))


def level_and_direction_differences(
    curves: Sequence[Curve], rows: int
) -> Mapping[str, tuple[Floats, Floats]]:
    """Compute the largest differences over level and over direction, and their noise floors."""
    unknown, names = np.full(rows, np.nan), ("level_dependence", "direction_difference")
    best = dict.fromkeys(names, (unknown, unknown))
    for one, other in combinations(curves, 2):
        same_level = 1.0 / 1.1 < one.level / other.level < 1.1
        if one.direction == other.direction and not same_level:
            name = "level_dependence"
        elif one.direction != other.direction and same_level:
            name = "direction_difference"
        else:
            continue
        first, second = sorted((one, other), key=lambda curve: (-curve.direction, curve.level))
        value, floor = relative_rms_difference(first, second), np.hypot(first.floor, second.floor)
        best[name] = np.fmax(best[name][0], value), np.fmax(best[name][1], floor)
    return best
