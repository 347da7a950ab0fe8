"""The frequencies and levels at which a test shows a delamination best."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..constants import GRAVITY
from ..errors import InputError
from ..laboratory.analysis.channels import Channels, attributes, checked_number
from ..laboratory.analysis.orders import fit_windows
from ..laboratory.pieces import Floats
from ..laboratory.sensors import Sensor, measure, sensor_by_channel
from ..laboratory.shake import shake
from ..laboratory.swept_sine import SweptSine
from ..lazy import Unpack, xr
from ..model import Structure
from ..response.labels import variable, yes_or_no
from ..running.job import refuse_family
from ..running.options import Running
from .opening import largest_opening_force, sweep_rate
from .undamaged import SoundStructure

SPLITS = (1.0, 0.2)  # parts of the guess's difference between its halves that are computed
BOX = "box_acceleration"
NEARLY = 0.5  # of the largest distance: what a sweep covers where less counts
ROOM, PASSED = 0.1, 0.25  # beyond that and beyond the resonance, over the resonance
FEWEST = 4.0  # windows at the lowest frequency
USUAL_NOISE = 1e-3  # (m/s2)/sqrt(Hz)
USUAL_LEVELS = tuple(float(f"{level:.2g}") for level in np.geomspace(0.01, 1.0, 9))  # g


@dataclass(frozen=True)
class Sweep:
    """Hold the orders of a computed sweep over the frequency."""

    # complex amplitudes, m/s2
    delaminated: Floats
    sound: Floats
    opening: Floats  # largest gap around a frequency, m
    peak: float  # largest reading, m/s2
    level: float  # of the box, m/s2

    def scaled_to(self, level: float) -> Sweep:
        """Scale the sweep to another level, which does not matter to the structure."""
        names = ("delaminated", "sound", "opening", "peak")
        scaled = {name: level / self.level * getattr(self, name) for name in names}
        return replace(self, level=level, **scaled)


@dataclass(frozen=True)
class Noise:
    """Describe the noise and gain errors that sensors add to an order in a window."""

    density: Floats  # one-sided, (m/s2)/sqrt(Hz)
    periods: float  # in a window
    gain_error: float  # of the sensors against each other, relative

    def distances(self, sweep: Sweep, frequency: Floats) -> tuple[Floats, Floats]:
        """Compute the distance between both structures by order 1, and by orders 2 and 3.

        In standard deviations of a complex amplitude, by least squares with Hann's weights: of n
        samples of noise of variance s^2 = c^2 r/2 it is 6 s^2/n, with n = r periods/f.
        """
        variance = 3.0 * self.density[:, None] ** 2 * frequency / self.periods
        gap = np.abs(sweep.delaminated - sweep.sound) ** 2
        doubt = (self.gain_error * np.abs(sweep.sound[:, 0])) ** 2
        first = (gap[:, 0] / (variance + doubt)).sum(axis=0)
        higher = (np.nansum(gap[:, 1:], axis=1) / variance).sum(axis=0)
        return np.sqrt(first), np.sqrt(higher)


def plan_test(
    structure: Structure,
    *,
    sensor: Sensor | dict[str, Sensor] | None = None,
    levels: ArrayLike | None = None,
    g: ArrayLike | None = None,
    frequencies: ArrayLike | None = None,
    periods: float = 16.0,
    gain_error: float = 0.03,
    threshold: float = 5.0,
    margin: float = 4.0,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find frequencies and levels at which a delamination shows best.

    Parameters
    ----------
    structure : Structure
        A guess of the delaminated beam; the sound one is its bonded form.
    sensor : Sensor or mapping of str to Sensor
        As for :func:`orchestrate.measure`; its noise must be known. By default a noise of
        1e-3 (m/s2)/sqrt(Hz), of usual accelerometers, up to 40 times the highest frequency.
    levels : array_like
        Peak accelerations of the box, m/s2; nine from 0.01 to 1 g by default.
    g : array_like
        The same in g.
    frequencies : array_like
        Hz, ascending, two at least; by default from 0.8 times the lower to 1.2 times the higher
        natural frequency of the halves.
    periods : float
        Of the excitation, in a window of the orders.
    gain_error : float
        Doubt about the sensors' gains, relative: it makes differences of order 1 worth less.
    threshold : float
        Standard deviations from which a difference counts.
    margin : float
        Of the recommended level over the one at which differences count, and over the one at which
        pressed faces open: neither the noise nor the preload is known exactly.
    **running
        As for :func:`orchestrate.shake`, but for ``store``.

    Returns
    -------
    xarray.Dataset
        Over ``level`` in m/s2 and ``frequency`` in Hz: ``distance`` between the delaminated and
        the sound structure in standard deviations of the noise in one window, and its parts
        ``distance_first`` (order 1, which a sound beam of other numbers may imitate) and
        ``distance_harmonics`` (orders 2 and 3, which no linear one has); ``opening``, the largest
        gap in m; ``closing_force`` in N: faces pressed together by more stay shut there, and half
        way to the neighbouring frequencies.
        Over ``frequency``: ``smallest_level`` in m/s2 from which orders 2 and 3 count (with
        clearance, preload or ``e_slope`` one of ``levels``; infinite where none is enough), and
        ``opening_level`` in m/s2 from which a preloaded structure opens (0 without preload). Over
        ``level``: ``smallest_opening`` in m and ``smallest_split`` (difference between the halves'
        frequencies, relative to the guess's) that count at the best frequency, and ``overload``,
        whether the readings reach the sensor's range. Scalars ``recommended_level``,
        ``recommended_first``, ``recommended_last`` and ``recommended_duration`` of a swept sine,
        and ``counts``, whether orders 2 and 3 count there.

    Raises
    ------
    InputError

    Notes
    -----
    One sweep over all frequencies is computed for the guess, and one for a fifth of its split, at
    most 120 s long. A structure without clearance and with a constant e is the same at all levels;
    another is computed at each. The recommended sweep passes the bonded resonance, as
    :func:`orchestrate.detect` needs it, and is as slow as ISO 7626-2 asks for; sweep it up and
    down.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam").replace(D=0.02)
    >>> plan = orchestrate.plan_test(beam, g=[0.002, 0.02], frequencies=[10, 11, 12, 13, 14])
    >>> float(plan.distance_harmonics.max("frequency").values.argmax()), bool(plan.counts)
    (1.0, True)
    """
    refuse_family("plan_test", structure)
    if structure.bonded:
        raise InputError("structure: bonded; expected a guess of the delaminated one")
    if frequencies is None:
        low, high = sorted((structure.f1, structure.f2))
        frequencies = np.linspace(0.8 * low, 1.2 * high, 61)
    f = checked_frequencies(frequencies)
    if levels is not None and g is not None:
        raise InputError("levels and g: expected one of them")
    if levels is None:
        levels = GRAVITY * checked_positive("g", USUAL_LEVELS if g is None else g, "g")
    wanted = np.unique(checked_positive("levels", levels, "m/s2"))
    sensors = sensor_by_channel(sensor or Sensor(bandwidth=40.0 * float(f[-1]), noise=USUAL_NOISE))
    limit = checked_number("threshold", threshold, 1e-3, 1e6)
    above = checked_number("margin", margin, 1.0, 1e3)
    noise = checked_noise(sensors, checked_number("periods", periods, 2.0, 1e4), gain_error)
    if running.get("store") is not None:
        raise InputError("store: expected none; the answer is small, write it by to_netcdf")
    test = SweepComputation(structure, sensors, f, noise, running)
    sweeps = test.sweeps_at(wanted)
    answer = plan_dataset(test, sweeps, limit, test.largest_distances(sweeps[-1]))
    return answer.assign(recommended_sweep(test, answer, above))


@dataclass(frozen=True)
class SweepComputation:
    """Compute sweeps of a structure and of its sound form at the planned frequencies."""

    structure: Structure
    sensors: dict[str, Sensor]
    frequency: Floats  # hz
    noise: Noise
    running: Running  # keywords of orchestrate.running.options.Running

    @property
    def sound(self) -> SoundStructure:
        """The bonded structure as a linear oscillator: natural frequency and damping ratio."""
        return SoundStructure.from_structure(self.structure)

    @property
    def duration(self) -> float:
        """Duration of a sweep over all frequencies, s, as ISO 7626-2 asks for."""
        rate = max(sweep_rate(self.sound.f, self.sound.zeta), 1e-9)
        fewest = FEWEST * self.noise.periods / self.frequency[0]
        return max(float(self.frequency[-1] - self.frequency[0]) / rate, fewest)

    def sweeps_at(self, levels: Floats) -> list[Sweep]:
        """Compute the sweep at each level; one is scaled where the level does not matter."""
        if self.structure.has_scale:
            return [self.simulated_sweep(self.structure, level) for level in levels]
        computed = self.simulated_sweep(self.structure, float(levels[-1]))
        return [computed.scaled_to(level) for level in levels]

    def largest_distances(self, highest: Sweep) -> Floats:
        """Return the largest distance by orders 2 and 3 for each of ``SPLITS``."""
        smaller = [scale_split(self.structure, part) for part in SPLITS[1:]]  # the first is whole
        sweeps = [highest, *(self.simulated_sweep(one, highest.level) for one in smaller)]
        distances = (self.noise.distances(one, self.frequency)[1] for one in sweeps)
        return np.array([float(one.max()) for one in distances])

    def simulated_sweep(self, structure: Structure, level: float) -> Sweep:
        """Simulate a sweep over all frequencies at this level, and return its orders."""
        f = self.frequency
        duration = min(self.duration, 120.0)  # a lighter damping would ask for more
        first, last = float(f[0]), float(f[-1])
        sine = SweptSine(first=first, last=last, duration=duration, acceleration=level)
        rate = 20.0 * float(f[-1])
        history = shake(structure, sine, sample_rate=rate, **self.running)
        ideal: Any = {"noise": 0.0, "range": math.inf, "resolution": 0.0, "sample_rate": rate}
        every = {BOX: next(iter(self.sensors.values())), **self.sensors}
        quiet = {name: replace(one, **ideal) for name, one in every.items()}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of a low level: it is no other unit
            channels = Channels.from_record(measure(history, quiet, excitation=sine), (BOX,))
        names, responses = channels.responses()
        shares = np.array([[self.sensors[name].participation] for name in names])
        mass = self.sound.acceleration(channels)
        linear = shares * mass + (1.0 - shares) * channels.box
        rows = np.concatenate([channels.values[:1], responses, linear])
        sound_names = (f"sound {name}" for name in names)
        both = Channels(channels.time, rate, (BOX, *names, *sound_names), rows, channels.title)
        windows, amplitudes, _ = fit_windows(both, (1.0, 2.0, 3.0), None, self.noise.periods, 0.5)
        at = np.array([window.frequency for window in windows])
        found = interpolate_amplitudes(f, at, amplitudes[1:])
        measured, linear_orders = np.split(found, 2)
        sound = np.zeros_like(measured)
        sound[:, 0] = linear_orders[:, 0]
        gaps = [largest_gap(history, both.time[one.part]) for one in windows]
        peak = float(np.abs(responses).max())
        return Sweep(measured, sound, np.interp(f, at, gaps), peak, level)


def interpolate_amplitudes(frequency: Floats, at: Floats, amplitudes: Floats) -> Floats:
    """Interpolate the windows' amplitudes linearly at other frequencies."""
    flat = amplitudes.reshape(-1, len(at))
    return np.array([np.interp(frequency, at, row) for row in flat]).reshape(
        *amplitudes.shape[:-1], len(frequency)
    )


def largest_gap(history: xr.Dataset, times: Floats) -> float:
    """Return the largest gap of a history within these times, m."""
    return float(history.x_rel.sel(time=slice(times[0], times[-1])).max())


def scale_split(structure: Structure, part: float) -> Structure:
    """Scale the difference between a structure's halves, with the same bonded form."""
    share = structure.m1 / (structure.m1 + structure.m2)
    k, d = structure.k1 + structure.k2, structure.d1 + structure.d2
    k1 = share * k + part * (structure.k1 - share * k)
    d1 = share * d + part * (structure.d1 - share * d)
    return structure.replace(k1=k1, k2=k - k1, d1=d1, d2=d - d1)


# -- what is asked --------------------------------------------------------------------------------


def checked_frequencies(frequencies: ArrayLike) -> Floats:
    """Check that frequencies ascend, and return them in Hz."""
    f = checked_positive("frequencies", frequencies, "Hz")
    if len(f) < 2 or not (np.diff(f) > 0.0).all():
        text = "expected two at least, ascending, in Hz"
        raise InputError(f"frequencies = {frequencies!r}: {text}")
    return f


def checked_positive(name: str, given: ArrayLike, unit: str) -> Floats:
    """Check that all numbers are finite and > 0, and return them as an array."""
    try:
        values = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        values = np.array([np.nan])
    if values.ndim != 1 or not len(values) or not (np.isfinite(values) & (values > 0.0)).all():
        raise InputError(f"{name} = {given!r}: expected numbers > 0 in {unit}")
    return values


def checked_noise(sensors: dict[str, Sensor], periods: float, gain_error: float) -> Noise:
    """Check that the responses' sensors have a noise, and return it with their gain error."""
    error = checked_number("gain_error", gain_error, 0.0, 1.0)
    responses = {name: one for name, one in sensors.items() if name != BOX}
    if not responses:
        raise InputError("sensor: on the box alone; expected one on acceleration1 or acceleration2")
    for name, one in responses.items():
        if not one.noise:
            text = "expected its density in (m/s2)/sqrt(Hz), > 0: without it every level counts"
            raise InputError(f"sensor on {name}: noise = 0.0; {text}")
    return Noise(np.array([one.noise for one in responses.values()]), periods, error)


# -- the answer -----------------------------------------------------------------------------------


def plan_dataset(
    test: SweepComputation, sweeps: Sequence[Sweep], limit: float, split_distances: Floats
) -> xr.Dataset:
    """Assemble the dataset of a plan from a sweep at each level."""
    f, levels = test.frequency, np.array([sweep.level for sweep in sweeps])
    distances = [test.noise.distances(one, f) for one in sweeps]
    first, higher = (np.stack(rows) for rows in zip(*distances, strict=True))
    opening = np.stack([sweep.opening for sweep in sweeps])
    over, unit = ("level", "frequency"), "standard deviations of the noise in a window"
    kept = levels[:, None] * largest_opening_force(test.structure, f)
    splits = smallest_splits(levels, limit, split_distances)
    split = "smallest difference between the halves that counts, relative to the guess's"
    return xr.Dataset(
        {
            "distance": variable(over, np.hypot(first, higher), "1", f"difference in {unit}"),
            "distance_first": variable(over, first, "1", f"of order 1, in {unit}"),
            "distance_harmonics": variable(over, higher, "1", f"of orders 2 and 3, in {unit}"),
            "opening": variable(over, opening, "m", "largest gap"),
            "closing_force": variable(over, kept, "N", "preload above which the faces stay shut"),
            "threshold": variable((), limit, "1", f"difference that counts, in {unit}"),
            "smallest_split": variable("level", splits, "1", split),
            **smallest_detectable(test, sweeps, limit, higher, opening),
        },
        {
            "level": variable("level", levels, "m/s2", "peak acceleration of the box"),
            "frequency": variable("frequency", f, "Hz", "frequency of the box"),
        },
        attributes("plan_test", "Plan of a test", test.structure.label()),
    )


def smallest_detectable(
    test: SweepComputation, sweeps: Sequence[Sweep], limit: float, higher: Floats, opening: Floats
) -> dict[str, Any]:
    """Return variables: the smallest levels and openings that count, and levels that overload."""
    force = largest_opening_force(test.structure, test.frequency)
    with np.errstate(divide="ignore", invalid="ignore"):
        levels = np.array([[sweep.level] for sweep in sweeps])
        if test.structure.has_scale:  # not in proportion to the level
            smallest = np.where(higher >= limit, levels, np.inf).min(axis=0)
        else:
            smallest = np.where(higher[-1] > 0.0, limit * levels[-1] / higher[-1], np.inf)
        open_from = test.structure.preload / force
        smallest_gap = np.where(higher > 0.0, opening * limit / higher, np.inf).min(axis=1)
    ranges = min(one.range for name, one in test.sensors.items() if name != BOX)
    cut = np.array([sweep.peak > ranges for sweep in sweeps])
    level, opens = "level from which orders 2 and 3 count", "level from which the faces open"
    return {
        "smallest_level": variable("frequency", smallest, "m/s2", level),
        "opening_level": variable("frequency", open_from, "m/s2", opens),
        "smallest_opening": variable("level", smallest_gap, "m", "smallest gap that counts"),
        "overload": yes_or_no("level", cut, "whether readings reach the sensor's range"),
    }


def smallest_splits(levels: Floats, limit: float, distances: Floats) -> Floats:
    """Return the smallest part of the guess's split that shows at each level; infinity if none.

    Between the computed splits the distance is a power of the split; below the smallest one it is
    taken to be proportional to it.
    """
    log_distance, log_split = np.log(np.maximum(distances, 1e-300)), np.log(SPLITS)
    wanted = np.log(limit * levels[-1] / levels)
    ascending = np.maximum.accumulate(log_distance[::-1])
    inside = np.interp(wanted, ascending, log_split[::-1])
    below = log_split[-1] + np.minimum(wanted - log_distance[-1], 0.0)
    parts = np.where(wanted < log_distance[-1], below, inside)
    return np.where(wanted > ascending[-1], np.inf, np.exp(parts))


def recommended_sweep(test: SweepComputation, answer: xr.Dataset, margin: float) -> dict[str, Any]:
    """Recommend a level, and a sweep over the bonded resonance and all frequencies that count.

    The lowest level without overload at which orders 2 and 3 reach ``margin * threshold`` and
    preloaded faces open with ``margin``; else the highest without overload; else the lowest.
    """
    higher, limit = answer.distance_harmonics.values, float(answer.threshold)
    fits = np.flatnonzero(answer.overload.values == 0)
    shut = answer.level.values < margin * np.fmin.reduce(answer.opening_level.values)
    enough = [i for i in fits if higher[i].max() >= margin * limit and not shut[i]]
    row = int(enough[0] if enough else fits[-1] if len(fits) else 0)
    f, curve = test.frequency, higher[row]
    counting = np.flatnonzero(curve >= min(limit, NEARLY * float(curve.max())))
    low, high = float(f[counting[0]]), float(f[counting[-1]])
    room, passed = ROOM * max(high - low, test.sound.f), PASSED * test.sound.f
    first = max(min(low - room, test.sound.f - passed), float(f[0]))
    last = min(max(high + room, test.sound.f + passed), float(f[-1]))
    rate = sweep_rate(test.sound.f, test.sound.zeta)
    duration = max((last - first) / max(rate, 1e-9), FEWEST * test.noise.periods / first)
    text = "whether orders 2 and 3 count in the recommended sweep"
    return {
        "recommended_level": variable((), answer.level.values[row], "m/s2", "level to test at"),
        "recommended_first": variable((), first, "Hz", "frequency to begin at"),
        "recommended_last": variable((), last, "Hz", "frequency to end at"),
        "recommended_duration": variable((), duration, "s", "time of the sweep, one way"),
        "counts": yes_or_no((), bool(curve.max() >= limit), text),
    }
