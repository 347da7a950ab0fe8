"""Order tracking: amplitude and phase of a swept sine's orders, by least squares in windows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...constants import TURN
from ...errors import NOT_NUMBERS, InputError
from ...lazy import xr
from ...model.ranges import checked_range
from ...response.labels import variable
from ..stepped_sine import SteppedSine
from ..swept_sine import SweptSine
from .channels import BOX, Channels, Floats

MOST_ORDERS = 50
EDGE = 2.0  # periods at both ends where the Hilbert transform is not trusted
NYQUIST = 0.45  # of the sampling rate: orders above are not resolved


@dataclass(frozen=True)
class Window:
    """One window of a record, in which the orders are fitted."""

    part: slice  # samples
    weights: Floats  # of the squares, Hann's over the phase
    offset: Floats  # time from the middle, in half lengths of the window
    phase: Floats  # rad
    time: float  # of the middle, s
    # in the middle, Hz, and its derivative, Hz/s
    frequency: float
    rate: float


def track_orders(
    record: xr.Dataset,
    *,
    orders: int | Sequence[float] = 3,
    phase: SweptSine | SteppedSine | ArrayLike | None = None,
    periods: float = 16.0,
    overlap: float = 0.5,
) -> xr.Dataset:
    """Track the orders of a record of a swept sine.

    Parameters
    ----------
    record : xarray.Dataset
        As for :func:`orchestrate.frf`.
    orders : int or sequence of float
        Orders 1 to this one, or the orders themselves, as ``(0.5, 1, 1.5, 2)``.
    phase : SweptSine, SteppedSine or array_like, optional
        The phase of order 1: of the swept or stepped sine, or in rad at each sample. By default it
        is measured from the box's acceleration.
    periods : float
        Of the excitation, in a window. A stepped sine has a window at each frequency instead: what
        is measured there.
    overlap : float
        Part of a window that the next one shares, 0 to 0.95.

    Returns
    -------
    xarray.Dataset
        Over ``time`` in s (the middle of a window) with the coordinate ``frequency`` in Hz:
        ``amplitude`` in m/s2 and ``phase`` in rad over ``channel`` and ``order``; ``residual``, the
        root mean square of what is not in these orders, over ``channel``; ``sweep_rate`` in Hz/s,
        negative where the sweep goes down. Orders above 0.45 of the sampling rate are NaN.

    Raises
    ------
    InputError
        Where no phase is given and the box's acceleration is no sine of growing phase.

    Notes
    -----
    In each window a constant and, for each order n, ``A sin(n phase + theta)`` are fitted by least
    squares with Hann weights; A cos(theta) and A sin(theta) may change at a constant rate. The
    measured phase is that of the analytic signal, smoothed in each window by a polynomial of third
    degree, less the phase that the box's own order 1 then has. Windows in which the box does not
    move as a sine, as in silence between two sweeps, are left out.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam").as_bonded()
    >>> sweep = orchestrate.SweptSine(first=10.0, last=14.0, duration=60.0, acceleration=0.2)
    >>> answer = orchestrate.track_orders(orchestrate.shake(beam, sweep), phase=sweep)
    >>> first = answer.swap_dims(time="frequency").amplitude.sel(channel="acceleration1", order=1)
    >>> round(float(first.idxmax()), 1)
    12.7
    """
    channels = Channels.from_record(record, (BOX,) if phase is None else ())
    wanted = checked_orders(orders)
    length = checked_range("periods", periods, low=2.0, high=1e4)
    part = checked_range("overlap", overlap, low=0.0, high=0.95)
    windows, fitted, residual = fit_orders_in_windows(channels, wanted, phase, length, part)
    over = ("channel", "order", "time")
    frequency = [w.frequency for w in windows]
    text = "root mean square of all but the orders"
    return channels.result(
        "orders",
        "Orders",
        {
            "amplitude": variable(over, np.abs(fitted), "m/s2", "amplitude of orders"),
            "phase": variable(over, np.angle(fitted), "rad", "phase of sines"),
            "residual": variable(("channel", "time"), residual, "m/s2", text),
            "sweep_rate": variable("time", [w.rate for w in windows], "Hz/s", "rate of the sweep"),
        },
        {
            "order": variable("order", np.array(wanted), "1", "frequency over the excitation's"),
            "time": variable("time", [w.time for w in windows], "s", "middle of the window"),
            "frequency": variable("time", frequency, "Hz", "frequency of the excitation"),
        },
        periods=length,
        overlap=part,
    )


def fit_orders_in_windows(
    channels: Channels,
    orders: tuple[float, ...],
    phase: SweptSine | SteppedSine | ArrayLike | None,
    periods: float,
    overlap: float,
) -> tuple[list[Window], Floats, Floats]:
    """Fit orders in windows of a record by least squares; return windows, amplitudes, residuals."""
    measured = phase is None
    angle = phase_of_box(channels) if measured else checked_phase(channels, phase)
    if isinstance(phase, SteppedSine):
        windows = list(dwell_windows(channels, phase, angle))
    else:
        windows = list(sliding_windows(channels, angle, periods, overlap, smooth=measured))
    if not windows:
        turns = abs(float(angle[-1] - angle[0])) / TURN
        text = f"the record has {turns:.4g}; expected fewer in a window"
        raise InputError(f"periods = {periods!r}: {text}")
    fits = [fit_orders_in_window(channels, window, orders) for window in windows]
    amplitudes = np.stack([fitted[0] for fitted in fits], axis=-1)
    residual = np.stack([fitted[1] for fitted in fits], axis=-1)
    if measured:
        sine = sinusoidal_window_mask(channels, windows, amplitudes, residual, orders)
        windows = list(compress(windows, sine))
        amplitudes, residual = amplitudes[..., sine], residual[:, sine]
        # phases against that of the box's own order 1
        shift = np.angle(amplitudes[channels.names.index(BOX), orders.index(1.0)])
        amplitudes = amplitudes * np.exp(-1j * np.array(orders)[:, None] * shift)
    return windows, amplitudes, residual


def checked_orders(orders: int | Sequence[float]) -> tuple[float, ...]:
    """Return the orders to track as floats, 1 always first; raise if they are no orders."""
    expected = f"expected a whole number of 1 to {MOST_ORDERS}, or orders > 0 with 1 among them"
    try:
        if np.ndim(orders) == 0:
            highest = float(orders)  # type: ignore[arg-type]
            if not highest.is_integer() or not 1 <= highest <= MOST_ORDERS:
                raise ValueError
            return tuple(map(float, range(1, int(highest) + 1)))
        wanted = tuple(sorted({float(order) for order in orders}))  # type: ignore[union-attr]
    except NOT_NUMBERS:
        raise InputError(f"orders = {orders!r}: {expected}") from None
    if 1.0 not in wanted or len(wanted) > MOST_ORDERS or not 0.0 < wanted[0] <= wanted[-1] < 1e3:
        raise InputError(f"orders = {orders!r}: {expected}")
    return wanted


# -- phase ----------------------------------------------------------------------------------------


def checked_phase(channels: Channels, phase: SweptSine | SteppedSine | ArrayLike | None) -> Floats:
    """Return the excitation's phase at each sample as the user states it, rad."""
    if isinstance(phase, (SweptSine, SteppedSine)):
        return phase.phase(channels.time)
    try:
        angle = np.asarray(phase, dtype=float)
    except NOT_NUMBERS:
        angle = np.empty(0)
    if angle.shape != channels.time.shape or not np.isfinite(angle).all():
        count = len(channels.time)
        raise InputError(f"phase: expected a SweptSine or {count} finite numbers, one a sample")
    if not (np.diff(angle) > 0.0).all():
        wrong = int(np.argmin(np.diff(angle)))
        text = f"{angle[wrong]:.6g} rad before {angle[wrong + 1]:.6g} rad"
        raise InputError(f"phase[{wrong}]: {text}; expected a phase that grows")
    return angle


def phase_of_box(channels: Channels) -> Floats:
    """Return the phase of the box's acceleration as a sine, by its analytic signal; rad."""
    from scipy.signal import hilbert

    box = channels.box - channels.box.mean()
    if not np.ptp(box) > 0.0:
        raise InputError(f"{channels.box_label}: does not move; expected a swept sine")
    angle = np.unwrap(np.angle(hilbert(box))) + 0.5 * math.pi
    if not angle[-1] > angle[0]:
        raise InputError(f"{channels.box_label}: its phase does not grow; expected a swept sine")
    return np.asarray(angle)


def mean_frequencies(phase: Floats, channels: Channels) -> Floats:
    """Return the mean frequency of the excitation in each twentieth of a record, Hz."""
    marks = np.linspace(0, len(phase) - 1, 21).astype(int)
    return np.asarray(np.diff(phase[marks]) / np.diff(marks) * channels.sample_rate / TURN)


def median_absolute_sweep_rate(phase: Floats, channels: Channels) -> float:
    """Estimate the median size of the sweep rate, Hz/s, without its sign."""
    changes = np.abs(np.diff(mean_frequencies(phase, channels)))
    return float(np.median(changes)) * 20.0 / channels.duration


def bound_on_sweep_frequency(channels: Channels) -> float:
    """Return a frequency, Hz, that the base's sweep does not exceed: it may rise at the end."""
    return 1.1 * float(mean_frequencies(phase_of_box(channels), channels).max())


def integrate_in_time(signal: Floats, rate: float, lowest_omega: float, count: int = 1) -> Floats:
    """Integrate a signal once or twice in time, without what is slower than a rad/s."""
    spectrum, omega = np.fft.rfft(signal), TURN * np.fft.rfftfreq(len(signal), 1.0 / rate)
    spectrum[omega < lowest_omega] = 0.0  # drift
    return np.fft.irfft(spectrum / (1j * np.maximum(omega, lowest_omega)) ** count, len(signal))


def decimate(channels: Channels, highest_frequency: float, samples_per_period: float) -> Channels:
    """Low-pass and decimate channels by a whole factor, if enough samples are left."""
    from scipy.signal import firwin, resample_poly

    factor = int(channels.sample_rate // (samples_per_period * highest_frequency))
    if factor < 2:
        return channels
    # 90 dB from the new Nyquist frequency on, flat up to 0.86 of it: order 3 passes
    low_pass = firwin(80 * factor + 1, 0.93 / factor, window=("kaiser", 9.0))
    values = resample_poly(channels.values, 1, factor, axis=1, window=low_pass)
    time, rate = channels.time[::factor], channels.sample_rate / factor
    return replace(channels, time=time, sample_rate=rate, values=values)


def sinusoidal_window_mask(
    channels: Channels,
    windows: Sequence[Window],
    amplitudes: Floats,
    residual: Floats,
    orders: tuple[float, ...],
) -> NDArray[np.bool_]:
    """Return a mask of the windows in which the box is a sine; raise if less than half the time."""
    row, first = channels.names.index(BOX), orders.index(1.0)
    rms = np.abs(amplitudes[row, first]) * 0.5**0.5
    beside = residual[row] / np.maximum(rms, 1e-300)
    forward = np.array([window.frequency > 0.0 for window in windows])
    sine = forward & (beside <= 0.5) & (rms > 1e-6 * rms.max())  # below, the box is at rest
    length = np.array([len(window.phase) for window in windows])
    if length[sine].sum() < 0.5 * length.sum():
        text = f"{np.median(beside):.2g} of its sine's rms is no sine"
        raise InputError(f"{channels.box_label}: {text}; expected a swept sine, or phase=")
    return np.asarray(sine)


# -- windows --------------------------------------------------------------------------------------


def sliding_windows(
    channels: Channels, phase: Floats, periods: float, overlap: float, smooth: bool
) -> Iterator[Window]:
    """Yield the windows of a record, `periods` periods each, overlapping by a part of that."""
    edge = EDGE * TURN if smooth else 0.0
    length = TURN * periods
    grown = np.maximum.accumulate(phase)
    first, last = grown[0] + edge, grown[-1] - edge
    count = math.floor((last - first - length) / (length * (1.0 - overlap)) + 1e-9) + 1
    starts = first + length * (1.0 - overlap) * np.arange(max(count, 0))
    begins = np.searchsorted(grown, starts - 1e-9)
    ends = np.searchsorted(grown, starts + length + 1e-9, side="right")
    for begin, end in zip(begins, ends, strict=True):
        yield make_window(channels, phase, slice(int(begin), int(end)), smooth)


def dwell_windows(channels: Channels, stepped: SteppedSine, phase: Floats) -> Iterator[Window]:
    """Yield a stepped sine's windows: the measured part of each frequency recorded whole."""
    step = 0.5 / channels.sample_rate
    ends = stepped.measured_times()
    inside = (ends[:, 0] >= channels.time[0] - step) & (ends[:, 1] <= channels.time[-1] + step)
    if not inside.any():
        span = f"{channels.time[0]:.6g} to {channels.time[-1]:.6g} s"
        raise InputError(f"record: it has {span}; expected all of what is measured at a frequency")
    begins = np.searchsorted(channels.time, ends[inside, 0] - 1e-3 * step)
    lasts = np.searchsorted(channels.time, ends[inside, 1] + 1e-3 * step, side="right")
    for begin, last in zip(begins, lasts, strict=True):
        yield make_window(channels, phase, slice(int(begin), int(last)), smooth=False)


def make_window(channels: Channels, phase: Floats, part: slice, smooth: bool) -> Window:
    """Make one window of a part of a record: its weights, phase and frequency."""
    time, angle = channels.time[part], phase[part]
    middle, half = 0.5 * (time[0] + time[-1]), 0.5 * (time[-1] - time[0])
    offset = (time - middle) / half
    weights = np.cos(0.5 * math.pi * offset) ** 2 + 1e-6  # not zero: few samples keep their rank
    powers = np.vander(offset, 4, increasing=True).T
    weighted = powers * weights
    start = angle[len(angle) // 2]  # long records have large phases
    polynomial = np.linalg.solve(weighted @ powers.T, weighted @ (angle - start))
    if smooth:
        angle = start + polynomial @ powers
    frequency = polynomial[1] / (TURN * half)
    rate = 2.0 * polynomial[2] / (TURN * half**2)
    return Window(part, weights, offset, angle, float(middle), float(frequency), float(rate))


def fit_orders_in_window(
    channels: Channels, window: Window, orders: tuple[float, ...]
) -> tuple[Floats, Floats]:
    """Fit orders in a window by least squares; return each channel's amplitudes and residual."""
    # complex A exp(i theta) of A sin(n phase + theta) in the middle, shape (channels, orders)
    limit = NYQUIST * channels.sample_rate
    resolved = [n for n in orders if n * window.frequency <= limit]
    columns = [np.ones_like(window.offset)]
    for n in resolved:
        sine, cosine = np.sin(n * window.phase), np.cos(n * window.phase)
        columns += [sine, cosine, window.offset * sine, window.offset * cosine]
    basis, values = np.stack(columns), channels.values[:, window.part]
    weighted = basis * window.weights
    # normal equations: the columns are close to orthogonal, so that no digits are lost
    solution = np.linalg.lstsq(weighted @ basis.T, weighted @ values.T, rcond=None)[0]
    rest = (values - solution.T @ basis) ** 2
    residual = np.sqrt(rest @ window.weights / window.weights.sum())
    amplitudes = np.full((len(values), len(orders)), np.nan, dtype=complex)
    for number, n in enumerate(resolved):
        sine, cosine = solution[1 + 4 * number], solution[2 + 4 * number]
        amplitudes[:, orders.index(n)] = sine + 1j * cosine
    return amplitudes, residual
