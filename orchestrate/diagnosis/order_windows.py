"""Orders of a record's channels in short windows, and the floor between the orders.

The same windows and weights serve a measured record and a computed one: the least squares of each
window are solved once, as a matrix, and applied to as many channels as there are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from ..errors import InputError
from ..laboratory.analysis.channels import BOX, Channels
from ..laboratory.analysis.order_tracking import (
    EDGE,
    NYQUIST,
    Window,
    make_window,
    median_absolute_sweep_rate,
    phase_of_box,
)
from ..laboratory.pieces import Floats
from ..laboratory.record import FORCES, channel_label
from ..lazy import xr

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Complexes = NDArray[np.complex128]
ORDERS = (1.0, 2.0, 3.0, 0.5)
OFF_ORDERS = (1.37, 2.37, 2.63)  # no multiples of 1/2, 1/3 or 1/4: what is there is no order
SHORTEST_WINDOW = 0.25  # s, shortest window
LONGEST_WINDOW = 1.0  # s, longest window, if it holds enough periods
# Least number of excitation periods in a window: they separate the orders 0.5, 1 and 1.37
MIN_PERIODS = 8.0
# Relative change of the frequency in a window that may be longer than SHORTEST_WINDOW
MAX_GLIDE = 0.006
OVERLAP = 0.5
MIN_LEVEL = 0.05  # of the usual amplitude of the base: windows below are not used
MAX_DISTORTION = 0.5  # rms of the base's motion besides its orders, over the rms of order 1
MIN_WINDOWS = 8  # windows
# Samples in a period of the highest frequency: order 3 has more than three then
SAMPLES_PER_PERIOD = 11.0
EXPECTED = "not described by this method: expected a swept or stepped sine"


@dataclass(frozen=True)
class OrderWindows:
    """Hold the windows of a record, and the least squares that give the orders in them."""

    # middle of each in s, frequency of the excitation there in Hz
    time: Floats
    frequency: Floats
    orders: tuple[float, ...]  # `ORDERS` and after them `OFF_ORDERS`
    parts: tuple[slice, ...]  # samples of each
    # complex: a channel's samples times these give `A exp(i theta)` of `A sin(n phase + theta)` for
    # each order n, NaN above 0.45 of the sampling rate. The phase is that of the base: its own
    # order 1 has theta = 0
    solutions: tuple[Complexes, ...]
    sample_rate: float  # Hz
    samples: int  # of the record

    def __len__(self) -> int:
        return len(self.parts)

    @property
    def is_tone(self) -> bool:
        """Whether the base keeps one frequency, within what the longest window resolves."""
        longest = max(part.stop - part.start for part in self.parts) / self.sample_rate
        return float(np.ptp(self.frequency)) < 1.0 / longest

    def select(self, windows: NDArray[np.intp], order_count: int) -> OrderWindows:
        """Return these windows with the first orders only, contiguous for fast products."""
        return OrderWindows(
            self.time[windows],
            self.frequency[windows],
            self.orders[:order_count],
            tuple(self.parts[i] for i in windows),
            tuple(np.ascontiguousarray(self.solutions[i][:, :order_count]) for i in windows),
            self.sample_rate,
            self.samples,
        )

    def displacement_operator(self) -> csr_array:
        """Return the sparse matrix from displacements to the orders of their accelerations."""
        from scipy.sparse import coo_array, csr_array, vstack

        count = self.samples
        inner = np.clip(np.arange(count), 1, count - 2)
        columns = (inner[:, np.newaxis] + np.array([-1, 0, 1])).ravel()
        weights = np.tile(self.sample_rate**2 * np.array([1.0, -2.0, 1.0]), count)
        second = coo_array((weights, (np.arange(count).repeat(3), columns))).tocsr()
        starts = np.cumsum([0, *(part.stop - part.start for part in self.parts)])
        places = np.concatenate([np.arange(part.start, part.stop) for part in self.parts])
        solutions = np.concatenate(self.solutions)
        shape = len(self), count
        blocks = [
            csr_array((values, places, starts), shape) @ second
            for column in solutions.T
            for values in (column.real, column.imag)
        ]
        return vstack(blocks).tocsr()

    def cut_to_samples(self, windows: NDArray[np.intp], samples: slice) -> OrderWindows:
        """Return these windows, renumbered for a record that is cut to these samples."""
        some = self.select(windows, len(self.orders))
        parts = (slice(p.start - samples.start, p.stop - samples.start) for p in some.parts)
        return replace(some, parts=tuple(parts), samples=samples.stop - samples.start)

    def amplitudes(self, values: Floats) -> Complexes:
        """Compute the complex amplitudes of channels, shape (channels, orders, windows)."""
        found = np.empty((len(values), len(self.orders), len(self)), dtype=complex)
        for number, (part, solution) in enumerate(zip(self.parts, self.solutions, strict=True)):
            found[:, :, number] = values[:, part] @ solution
        return found


@dataclass(frozen=True)
class RecordOrders:
    """Hold the orders of a record's channels, with the floor between the orders."""

    windows: OrderWindows
    channels: Channels
    amplitude: Complexes  # complex, m/s2, of `ORDERS`
    # root mean square of the amplitudes at `OFF_ORDERS`, m/s2, smoothed over the windows
    floor: Floats
    noise: Floats  # floor in the quietest fifth of the windows, m/s2

    def order_amplitudes(self, number: float, channel: str) -> Complexes:
        """Return the complex amplitudes of an order in a channel, m/s2, shape (windows,)."""
        row = self.channels.names.index(channel)
        return np.asarray(self.amplitude[row, ORDERS.index(number)])

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the channels besides the base's."""
        return tuple(name for name in self.channels.names if name != BOX)

    @property
    def rows(self) -> list[int]:
        """Rows of the channels besides the base's."""
        return [row for row, name in enumerate(self.channels.names) if name != BOX]

    @property
    def level(self) -> Floats:
        """Amplitude of the base's order 1, m/s2, shape (windows,)."""
        return np.abs(self.order_amplitudes(1.0, BOX))

    @property
    def resonance(self) -> float:
        """Frequency at which a sensor moves most for the base's amplitude, Hz."""
        response = (np.abs(self.amplitude[self.rows, 0]) / self.level).max(axis=0)
        return float(self.windows.frequency[np.argmax(response)])


def checked_sensor_channels(record: xr.Dataset) -> Channels:
    """Return the channels of a record; raise of a simulation that no sensor has read."""
    impacts = record.sizes.get("impact", 0) if hasattr(record, "sizes") else 0
    if impacts and not {"acceleration1", "acceleration2"} & set(record):
        text = "expected what sensors read of it, orchestrate.measure(history, sensor)"
        raise InputError(f"record: its accelerations leave out its {impacts} impacts; {text}")
    return Channels.from_record(record, (BOX,))


def checked_base_and_faces(record: xr.Dataset) -> Channels:
    """Check that a record has the base's acceleration and a face's, and return the channels."""
    if hasattr(record, "data_vars") and not {BOX} & set(record):
        excited = (
            "it is excited by a force" if {*FORCES} & {*record} else "what excites it is unknown"
        )
        text = f"no acceleration of the base, {excited}; a verdict needs it"
        test = "measure a swept sine of the base, with an accelerometer next to the clamp"
        raise InputError(f"record: {text}: {test}; orchestrate.signs does without")
    channels = checked_sensor_channels(record)
    if len(channels.names) < 2:
        text = "expected acceleration1, acceleration2 or both besides the base's"
        raise InputError(f"record: no acceleration of a face; {text}")
    for name, values in zip(channels.names, channels.values, strict=True):
        if not np.ptp(values) > 0.0:
            text = "does not move; expected the reading of an accelerometer"
            raise InputError(f"{channel_label(name)}: {text}")
    return channels


def compute_orders(channels: Channels) -> RecordOrders:
    """Compute orders of a swept or stepped sine, and floors, in windows that resolve order 2."""
    windows, amplitude = sine_windows_and_amplitudes(channels)
    resolved = np.isfinite(amplitude[0, ORDERS.index(2.0)])
    rows = [row for row, name in enumerate(channels.names) if name != BOX]
    level = np.abs(amplitude[channels.names.index(BOX), 0])
    peak = np.argmax((np.abs(amplitude[rows, 0]) / level).max(axis=0))
    if not resolved[peak]:
        rate, frequency = channels.sample_rate, windows.frequency[peak]
        text = f"{rate:.4g} samples a second are {rate / frequency:.3g} in a period of"
        text = f"record: {text} {frequency:.3g} Hz, where it moves most"
        raise InputError(f"{text}; expected {2.0 / NYQUIST:.3g} or more, to read order 2")
    kept = np.flatnonzero(resolved)
    windows = windows.select(kept, len(windows.orders))
    return orders_with_floors(channels, windows, amplitude[:, :, kept])


def orders_with_floors(
    channels: Channels, windows: OrderWindows, amplitude: Complexes
) -> RecordOrders:
    """Return a record's orders in windows, with their floors."""
    whole, off = amplitude[:, : len(ORDERS)], amplitude[:, len(ORDERS) :]
    squares = np.nanmean(np.abs(off) ** 2, axis=1)
    floor = np.sqrt(np.stack([moving_average(row) for row in squares]))
    return RecordOrders(windows, channels, whole, floor, np.quantile(floor, 0.2, axis=1))


def moving_average(values: Floats, width: int = 5) -> Floats:
    """Return the moving average over neighbouring windows."""
    kernel = np.ones(min(width, len(values)))
    return np.convolve(values, kernel, "same") / np.convolve(np.ones(len(values)), kernel, "same")


# -- windows --------------------------------------------------------------------------------------


@lru_cache(maxsize=4)  # of a record, decimated for the evidence and for a coarse search
def sine_windows_and_amplitudes(channels: Channels) -> tuple[OrderWindows, Complexes]:
    """Find the windows in which the base moves as a sine, and all channels' amplitudes in them."""
    phase = phase_of_box(channels)
    every = overlapping_windows(channels, phase)
    high = NYQUIST * channels.sample_rate / OFF_ORDERS[0]  # above, no floor is resolved
    usable = [w for w in every if w.frequency * channels.duration > 1.0 and w.frequency < high]
    if len(usable) < MIN_WINDOWS:
        text = f"{EXPECTED}, of {MIN_WINDOWS * MIN_PERIODS / 2:g} periods or more"
        lacking = f"no sine of moving frequency in {channels.duration:.4g} s"
        raise InputError(f"{channel_label(BOX)}: {lacking}; {text}")
    row = channels.names.index(BOX)
    windows = assemble_windows(channels, usable)
    amplitude = windows.amplitudes(channels.values)
    level = np.abs(amplitude[row, 0])
    pairs = zip(usable, amplitude[row].T, strict=True)
    rest = [rms_without_order_1(channels.box, one, a) for one, a in pairs]
    sine = np.asarray(rest) <= MAX_DISTORTION * level * 0.5**0.5
    good = sine & (level >= MIN_LEVEL * np.median(level))
    if good.sum() < max(MIN_WINDOWS, 0.5 * len(good)):
        text = f"no sine in {np.sum(~sine)} of {len(good)} windows"
        raise InputError(f"{channel_label(BOX)}: {text}; {EXPECTED}")
    kept = np.flatnonzero(good)
    return windows.select(kept, len(windows.orders)), amplitude[:, :, kept]


def overlapping_windows(channels: Channels, phase: Floats) -> list[Window]:
    """Divide a record into overlapping windows, each with its smoothed phase."""
    turns = (phase[-1] - phase[0]) / TURN
    usual = turns / channels.duration
    glide = MAX_GLIDE * usual / max(median_absolute_sweep_rate(phase, channels), 1e-12)
    shortest = min(max(SHORTEST_WINDOW, glide), LONGEST_WINDOW)
    begin, end = np.searchsorted(phase, [phase[0] + EDGE * TURN, phase[-1] - EDGE * TURN])
    found, now = [], int(begin)
    while now < end:
        periods = int(np.searchsorted(phase, phase[now] + MIN_PERIODS * TURN))
        last = max(periods, now + round(shortest * channels.sample_rate))
        if last > end:
            break
        found.append(make_window(channels, phase, slice(now, last), smooth=True))
        now += max(1, round((1.0 - OVERLAP) * (last - now)))
    return found


def assemble_windows(channels: Channels, windows: list[Window]) -> OrderWindows:
    """Collect single windows in one object, with their least-squares matrices."""
    box, rate = channels.box, channels.sample_rate
    return OrderWindows(
        np.array([one.time for one in windows]),
        np.array([one.frequency for one in windows]),
        (*ORDERS, *OFF_ORDERS),
        tuple(one.part for one in windows),
        tuple(refer_to_base(box, one, least_squares_matrix(one, rate)) for one in windows),
        rate,
        len(channels.time),
    )


def least_squares_matrix(window: Window, sample_rate: float) -> Complexes:
    """Compute the least-squares matrix of a window, shape (orders, samples)."""
    orders = np.array([*ORDERS, *OFF_ORDERS])
    resolved = np.flatnonzero(orders * window.frequency <= NYQUIST * sample_rate)
    half, off = np.exp(1j * np.outer((0.5, 0.37), window.phase))
    first = half * half
    second = first * first
    third = second * first
    waves = np.stack([first, second, third, half, first * off, second * off, third * off.conj()])
    moving = window.offset * waves[[row for row in resolved if orders[row] % 1.0 == 0.0]]
    waves = waves[resolved]
    parts = (waves.imag, waves.real, moving.imag, moving.real)
    basis = np.concatenate([*parts, np.ones((1, len(window.offset)))])
    weighted = basis * window.weights
    # products as small as these wait for the threads of a BLAS, up to 20 times as long as they take
    normal = np.einsum("is,js->ij", weighted, basis)
    inverse = np.linalg.pinv(normal, hermitian=True)[: 2 * len(resolved)]
    sine, cosine = np.einsum("ij,js->is", inverse, weighted).reshape(2, len(resolved), -1)
    matrix = np.full((len(orders), len(window.offset)), np.nan, dtype=complex)
    matrix[resolved] = sine + 1j * cosine
    return matrix


def refer_to_base(box: Floats, window: Window, solution: Complexes) -> Complexes:
    """Refer the phases of a window's matrix to the base's own order 1."""
    shift = np.angle(solution[0] @ box[window.part])
    turn = np.exp(-1j * np.array([*ORDERS, *OFF_ORDERS]) * shift)
    return np.ascontiguousarray((solution * turn[:, None]).T)


def rms_without_order_1(box: Floats, window: Window, amplitude: Complexes) -> float:
    """Return the weighted root mean square of the base's motion besides its order 1, m/s2."""
    values = box[window.part] - np.average(box[window.part], weights=window.weights)
    power = np.average(values**2, weights=window.weights)
    return float(np.sqrt(max(power - 0.5 * abs(amplitude[0]) ** 2, 0.0)))


def split_sweeps(record: xr.Dataset) -> list[xr.Dataset]:
    """Return the sweeps of a record as records; the record itself where it has one.

    - A sweep ends where the base has no sine for a second, or its frequency jumps by a fifth.
    - What lasts less than 2 s or covers less than a tenth of its frequency is no sweep.
    """
    windows = sine_windows_and_amplitudes(checked_sensor_channels(record))[0]
    frequency, time = windows.frequency, windows.time
    jumps = np.abs(np.diff(frequency)) > 0.2 * frequency[:-1]
    ends = np.flatnonzero(jumps | (np.diff(time) > 1.0)) + 1  # s without a sine
    groups = [
        one
        for one in np.split(np.arange(len(time)), ends)
        if np.ptp(time[one]) >= 2.0 and np.ptp(frequency[one]) >= 0.1 * frequency[one].mean()
    ]
    if len(groups) < 2:
        return [record]
    parts = [slice(windows.parts[one[0]].start, windows.parts[one[-1]].stop) for one in groups]
    title = str(record.attrs.get("title", "record"))
    return [
        record.isel(time=part).assign_attrs(title=f"{title}, sweep {number}")
        for number, part in enumerate(parts, 1)
    ]
