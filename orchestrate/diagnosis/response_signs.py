"""Signs of accelerations over time: orders, coherence, moments, differences between responses."""

from __future__ import annotations

import math
from collections.abc import Sequence
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


ValueAndFloor = tuple[Floats, Floats]  # of a sign, and by noise


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

    # by the sign's name, of shape (rows,): value and floor; frequency in Hz, where it is largest
    signs: dict[str, ValueAndFloor]
    frequencies: dict[str, Floats]
    curves: list[Curve]
    noise: Floats  # root mean square of the noise, m/s2
    highest: float  # highest frequency of the excitation, Hz


def response_signs(
    channels: Channels, swept: bool, periods: float, high_band: float | None
) -> ResponseSigns:
    """Compute the signs that one record has by itself, without comparison."""
    own = signs_of_orders(channels, periods) if swept else curve_and_noise_by_spectra(channels)
    edge = high_band
    if edge is None:  # NaN if the sampling rate does not reach it
        edge = min(6.0 * own.highest, 0.3 * channels.sample_rate)
        edge = edge if edge >= 3.3 * own.highest else math.nan
    more = {**moment_signs(channels, edge), "coherence_loss": coherence_loss(channels, own.noise)}
    return replace(own, signs={**own.signs, **more})


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
    noise = np.sqrt(off / sums[1.0])
    signs = {name: (np.sqrt(sums[order] / sums[1.0]), noise) for name, order in OF_ORDERS.items()}
    peaks = {name: frequency[nan_argmax(power[order])] for name, order in OF_ORDERS.items()}
    total = np.nansum([power[order] for order in HARMONICS], axis=0)
    floor = np.sqrt(len(HARMONICS) * off / sums[1.0])
    signs["distortion"] = np.sqrt(nan_mean(total) / sums[1.0]), floor
    peaks["distortion"] = frequency[nan_argmax(total)]
    first = ORDERS.index(1.0)
    curves = curves_by_direction(windows, box[first], rows[:, first], noise)
    # white noise: Hann's weights over n samples leave 6 ln(2) s^2/n in the median of an off-order,
    # which impacts hardly raise
    samples = np.array([window.part.stop - window.part.start for window in windows])
    medians = [row_medians_over_finite_columns(power[order] * samples) for order in OFF_ORDERS]
    rms = np.asarray(np.sqrt(np.fmin.reduce(medians) / (6.0 * math.log(2.0))))
    return ResponseSigns(signs, peaks, curves, rms, float(frequency.max()))


def nan_mean(power: Floats) -> Floats:
    """Average each row over the windows that have a value; NaN where none has."""
    known = np.isfinite(power)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(known, power, 0.0).sum(axis=-1) / known.sum(axis=-1))


def nan_argmax(power: Floats) -> NDArray[np.intp]:
    return np.asarray(np.nan_to_num(power, nan=-1.0).argmax(axis=-1))


def row_medians_over_finite_columns(values: Floats) -> Floats:
    """Return the median of each row over the columns without NaN; NaN where there are none."""
    known = values[:, np.isfinite(values).all(axis=0)]
    return np.median(known, axis=-1) if known.size else np.full(len(values), np.nan)


def curves_by_direction(
    windows: Sequence[Window], box: Floats, rows: Floats, floor: Floats
) -> list[Curve]:
    """Split the response of order 1 into one curve upwards and one downwards."""
    from scipy.ndimage import median_filter

    frequency = np.array([window.frequency for window in windows])
    rate = np.array([window.rate for window in windows])
    # smooth: noise on the box moves single windows
    rate = median_filter(rate, size=min(15, len(rate)), mode="nearest")
    curves = []
    for direction in (1, -1):
        chosen = np.flatnonzero(rate * direction > 0.0)
        if len(chosen) >= max(MIN_WINDOWS, 0.1 * len(windows)):  # fewer are noise, or a turn
            chosen = chosen[np.argsort(frequency[chosen])]
            level = math.sqrt(float(np.mean(np.abs(box[chosen]) ** 2)))
            response = rows[:, chosen] / box[chosen]
            curves.append(Curve(direction, level, frequency[chosen], response, floor))
    return curves


# -- any excitation -------------------------------------------------------------------------------


def curve_and_noise_by_spectra(channels: Channels) -> ResponseSigns:
    """Compute the response at the lines that the box excites, and the noise; without orders."""
    _, (frequency, box, rows, cross), excited = spectra_and_excited_lines(channels)
    low, high = 0.36 * channels.sample_rate, 0.44 * channels.sample_rate
    density = row_medians_over_finite_columns(rows[:, (frequency >= low) & (frequency <= high)])
    response = cross[:, excited] / box[excited]
    level, unknown = float(channels.box.std()), np.full(len(rows), np.nan)
    curve = Curve(0, level, frequency[excited], response, unknown)
    noise = np.sqrt(0.5 * channels.sample_rate * density)
    curves = [curve] if excited.sum() >= MIN_WINDOWS else []
    highest = float(frequency[excited].max()) if excited.any() else math.nan
    return ResponseSigns({}, {}, curves, noise, highest)


def spectra_and_excited_lines(
    channels: Channels,
) -> tuple[WelchSegments, tuple[Floats, Floats, Floats, Floats], NDArray[np.bool_]]:
    """Return segments, their spectra, and a mask of the lines that the base excites."""
    segments = divide_into_segments(channels, None, "hann", OVERLAP, fewest=2)
    spectra = segments.compute_spectra(channels.box, channels.values[1:], channels.sample_rate)
    frequency, box, *_ = spectra
    return segments, spectra, (box >= EXCITED * box.max()) & (frequency > 0.0)


def coherence_loss(channels: Channels, noise: Floats) -> ValueAndFloor:
    """Return the mean of 1 less the coherence over the excited lines, and that of noise."""
    try:
        segments, (_, box, rows, cross), excited = spectra_and_excited_lines(channels)
    except InputError:
        unknown = np.full(len(noise), np.nan)
        return unknown, unknown
    with np.errstate(invalid="ignore", divide="ignore"):
        power = rows[:, excited]
        coherence = np.abs(cross[:, excited]) ** 2 / (box[excited] * power)
        share = 2.0 * noise[:, None] ** 2 / channels.sample_rate / power
        floor = np.minimum(share, 1.0).mean(axis=-1) + 1.0 / segments.independent_count
    return 1.0 - coherence.mean(axis=-1), np.minimum(floor, 1.0)


def moment_signs(channels: Channels, edge: float) -> dict[str, ValueAndFloor]:
    """Compute kurtosis and skewness, of all and of the high band; and those of Gaussian noise."""
    from scipy.signal import butter, sosfiltfilt
    from scipy.stats import kurtosis, skew

    rows, rate, signs = channels.values[1:], channels.sample_rate, {}
    unknown, whole = np.full(len(rows), np.nan), np.ones(len(rows))
    bands = {"": rows, "_high": rows[:, :0]}
    if 0.0 < edge <= MAX_EDGE * rate:
        bands["_high"] = sosfiltfilt(butter(4, edge, "highpass", fs=rate, output="sos"), rows)
    for ending, band in bands.items():
        moves = band.size > 0 and np.ptp(band, axis=-1).min() > 0.0
        fourth = kurtosis(band, axis=-1, fisher=False) if moves else unknown
        third = np.abs(skew(band, axis=-1)) if moves else unknown
        signs[f"kurtosis{ending}"] = fourth, 3.0 * whole
        signs[f"skewness{ending}"] = third, 2.0 * math.sqrt(6.0 / len(channels.time)) * whole
    return signs


# -- differences between responses ----------------------------------------------------------------


def sensor_difference(curves: Sequence[Curve], channels: int) -> ValueAndFloor:
    """Compute the difference between two sensors, best complex gain taken out."""
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


def level_and_direction_differences(curves: Sequence[Curve], rows: int) -> dict[str, ValueAndFloor]:
    """Compute the largest differences over level and over direction."""
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
