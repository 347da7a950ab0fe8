"""The acceleration channels of a record, checked, and its overlapping segments (Welch)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import NOT_NUMBERS, InputError
from ...lazy import xr
from ...model.arguments import checked_word
from ...model.ranges import checked_range
from ...response.labels import Variable, variable
from ...running.provenance import describe_dataset
from ..columns import source_column_label
from ..pieces import Floats

BOX = "box_acceleration"
NAMES_IN_RESULTS = {  # and what the result of shake calls them
    BOX: BOX,
    "acceleration1": "a1_abs",
    "acceleration2": "a2_abs",
}


@dataclass(frozen=True, eq=False)  # equal only to itself: what is computed of it is kept by it
class Channels:
    """Acceleration channels of a record as one array."""

    time: Floats  # s
    sample_rate: float  # Hz
    names: tuple[str, ...]  # of `NAMES_IN_RESULTS`
    values: Floats  # m/s2
    title: str  # of the record
    # what messages call the box's acceleration: the column of the file that it was read from
    box_label: str = BOX

    @classmethod
    def from_record(cls, record: xr.Dataset, needed: tuple[str, ...] = ()) -> Channels:
        """Check a record, or a result of :func:`orchestrate.shake`, and take its channels."""
        is_dataset = isinstance(record, xr.Dataset)
        if not is_dataset or "time" not in record.coords:
            expected = "expected an xarray.Dataset over time with box_acceleration, acceleration1"
            what = describe_dataset(record) if is_dataset else type(record).__name__
            raise InputError(f"record: {what}, without time; {expected}")
        present = {
            name: record[key]
            for name, of_shake in NAMES_IN_RESULTS.items()
            for key in (of_shake, name)  # the last one counts
            if key in record and record[key].dims == ("time",)
        }
        missing = [name for name in needed if name not in present]
        if missing or not present:
            lacking = " and no ".join(missing or NAMES_IN_RESULTS)
            expected = " and ".join(needed) or "one of them"
            raise InputError(f"record: no {lacking}; expected {expected} over time, in m/s2")
        time = np.asarray(record.time.values, dtype=float)
        if time.ndim != 1 or len(time) < 16:
            raise InputError(f"record: {time.size} samples; expected at least 16")
        rate = checked_sample_rate(time, record.attrs.get("sample_rate"))
        values = np.stack([checked_finite(name, array, time) for name, array in present.items()])
        title = str(record.attrs.get("title", "record"))
        label = source_column_label(record.attrs, BOX)
        return cls(time, rate, tuple(present), values, title, label)

    @property
    def box(self) -> Floats:
        return np.asarray(self.values[self.names.index(BOX)])

    @property
    def duration(self) -> float:
        """Number of samples over the sampling rate, s."""
        return len(self.time) / self.sample_rate

    def responses(self) -> tuple[tuple[str, ...], Floats]:
        """Return names and values of all channels but the box's."""
        chosen = [i for i, name in enumerate(self.names) if name != BOX]
        return tuple(self.names[i] for i in chosen), self.values[chosen]

    def result(
        self,
        analysis: str,
        heading: str,
        variables: Mapping[str, Variable],
        coordinates: Mapping[str, Variable],
        **settings: Any,
    ) -> xr.Dataset:
        """Return the dataset of an analysis, over all channels unless coordinates name some."""
        if "channel" not in coordinates:
            coordinates = {"channel": channel_coordinate(self.names), **coordinates}
        words = analysis_attributes(analysis, heading, self.title, **settings)
        return xr.Dataset(variables, coordinates, words)


def checked_sample_rate(time: Floats, stated: Any) -> float:
    """Return the sampling rate of times, Hz, as stated if it agrees; raise if they are uneven."""
    steps = np.diff(time)
    if not np.isfinite(time).all() or not (steps > 0.0).all():
        wrong = int(np.argmin(np.nan_to_num(steps, nan=-np.inf)))
        raise InputError(f"time[{wrong + 1}] = {time[wrong + 1]!r} s: expected ascending numbers")
    rate = (len(time) - 1) / (time[-1] - time[0])
    uneven = np.abs((time - time[0]) * rate - np.arange(len(time)))
    if uneven.max() > 0.05:  # of a step
        wrong = int(np.abs(steps * rate - 1.0).argmax())
        text = f"a step of {steps[wrong]:.6g} s after it, of {1.0 / rate:.6g} s on average"
        raise InputError(f"time[{wrong}] = {time[wrong]:.9g} s: {text}; expected equal steps")
    if stated is None:
        return float(rate)
    try:
        number = float(stated)
    except NOT_NUMBERS:
        number = np.nan
    if not abs(number / rate - 1.0) <= 0.01:
        text = f"the time has {rate:.6g} samples a second; expected the same"
        raise InputError(f"attribute sample_rate = {stated!r} Hz: {text}")
    return number


def checked_finite(name: str, array: xr.DataArray, time: Floats) -> Floats:
    """Return a channel's values as floats; raise if one is not finite."""
    values = np.asarray(array.values, dtype=float)
    if not np.isfinite(values).all():
        wrong = int(np.flatnonzero(~np.isfinite(values))[0])
        text = f"= {values[wrong]} at {time[wrong]:.9g} s: expected finite numbers"
        raise InputError(f"{name}[{wrong}] {text}")
    return values


# -- results --------------------------------------------------------------------------------------


def channel_coordinate(names: Sequence[str]) -> Variable:
    return "channel", np.array(names), {"long_name": "channel of the record"}


def frequency_coordinate(frequency: Floats) -> Variable:
    return variable("frequency", frequency, "Hz", "frequency")


def analysis_attributes(analysis: str, heading: str, title: str, **settings: Any) -> dict[str, Any]:
    return {"analysis": analysis, "title": f"{heading}: {title}", **settings}


WINDOWS = ("hann", "hamming", "blackman", "blackmanharris", "flattop", "boxcar")
FEWEST_LINES = 8  # samples in a segment


@dataclass(frozen=True)
class WelchSegments:
    """Overlapping segments of a record for Welch's method."""

    # samples of a segment, and those it shares with the next
    length: int
    overlap: int
    window: str  # of scipy.signal.get_window
    segments: int  # how many there are
    resolution: float  # distance of the lines, Hz

    @property
    def scipy_options(self) -> dict[str, Any]:
        """Keywords of :func:`scipy.signal.csd` and :func:`scipy.signal.welch`."""
        sizes = {"nperseg": self.length, "noverlap": self.overlap}
        return {"window": self.window, **sizes, "detrend": "constant"}

    def compute_spectra(
        self, drive: Floats, responses: Floats, rate: float
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """Return lines, Hz, and spectra of what drives, of the responses and between them."""
        from scipy.signal import csd, welch

        options = self.scipy_options
        frequency, power = welch(drive, rate, **options)
        response = welch(responses, rate, **options)[1]
        return frequency, power, response, csd(drive, responses, rate, **options)[1]

    @property
    def independent_count(self) -> float:
        """Number of independent segments that would have the same random error."""
        # overlapping segments are correlated by the squared correlation of the window with itself
        # (Welch, IEEE Trans. Audio Electroacoust. 15, 1967, 70-73)
        from scipy.signal import get_window

        w = get_window(self.window, self.length)
        hop, count = self.length - self.overlap, self.segments
        shifts = range(1, min(count, -(-self.length // hop)))
        shared = (float(w[: -s * hop] @ w[s * hop :]) / float(w @ w) for s in shifts)
        total = sum((1.0 - s / count) * c**2 for s, c in zip(shifts, shared, strict=True))
        return count / (1.0 + 2.0 * total)


def samples_per_segment(channels: Channels, resolution: float | None, default: int = 0) -> int:
    """Return the samples of a segment by the distance of its lines, Hz; else the default."""
    if resolution is None:
        return default
    ends = default or len(channels.time), FEWEST_LINES
    finest, coarsest = (channels.sample_rate / n for n in ends)
    checked = checked_range("resolution", resolution, "Hz", low=finest, high=coarsest)
    return round(channels.sample_rate / checked)


def divide_into_segments(
    channels: Channels, resolution: float | None, window: str, overlap: float, fewest: int = 1
) -> WelchSegments:
    """Divide a record into overlapping windowed segments; raise if they are too few."""
    checked_word("window", window, WINDOWS)
    part = checked_range("overlap", overlap, low=0.0, high=0.95)
    count, rate = len(channels.time), channels.sample_rate
    length = samples_per_segment(channels, resolution) or max(count // 16, FEWEST_LINES)
    shared = min(int(part * length), length - 1)
    segments = (count - shared) // (length - shared)
    if segments < fewest:
        text = f"{segments} segments in {channels.duration:.4g} s; expected at least {fewest}"
        raise InputError(f"resolution = {rate / length:.4g} Hz: {text}")
    return WelchSegments(length, shared, window, segments, rate / length)
