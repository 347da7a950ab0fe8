"""Model-free signs of a record, and those of a sound structure with the same noise."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import InputError
from ..laboratory.analysis.channels import BOX, Channels, analysis_attributes
from ..laboratory.pieces import Floats
from ..laboratory.record import FORCES
from ..lazy import xr
from ..model import Structure
from ..model.arguments import checked_integer
from ..model.ranges import checked_range
from ..response.labels import flags, variable
from ..running.job import refuse_unsupported_structure
from .drive_signs import drive_signs, is_drive_run
from .indicators import INDICATORS
from .order_windows import checked_sensor_channels
from .response_signs import (
    MAX_EDGE,
    ResponseSigns,
    has_trackable_sine,
    level_and_direction_differences,
    response_signs,
    sensor_difference,
)
from .undamaged import SoundStructure

RESPONSE = "the response"  # reference of the phase where nothing else is known
UNKNOWN = SoundStructure(math.nan, math.nan)
MEANINGS = {-1: "unknown", 0: "no", 1: "yes"}
NOISE_SOURCES = "lines at 0.36 to 0.44 of the sampling rate", "off-orders 2.37 and 3.37"


def signs(
    record: xr.Dataset,
    *,
    other: xr.Dataset | Sequence[xr.Dataset] | None = None,
    structure: Structure | None = None,
    noise: float | None = None,
    seeds: int = 8,
    periods: float = 16.0,
    high_band: float | None = None,
    factor: float = 2.0,
) -> xr.Dataset:
    """Compute model-free signs of delamination in a record.

    Parameters
    ----------
    record : xarray.Dataset
        As for :func:`orchestrate.frf`. Without ``box_acceleration`` the phase is that of
        the force or, without one too, of the response itself, and no sound structure is known. Or
        a run of :func:`orchestrate.couple`, for the signs of a weak drive.
    other : xarray.Dataset or sequence of them, optional
        Records of the same beam at other levels or in the other direction, for the signs that
        compare records; of a run on a weak drive that of the sound beam, which it must have.
    structure : Structure, optional
        A guess of the beam. Its bonded form is the sound structure; by default that is the linear
        oscillator whose acceleration is nearest to the record's.
    noise : float, optional
        Root mean square of the noise of each response, m/s2; by default from the record.
    seeds : int
        How many sound structures are simulated, each with a noise of its own.
    periods : float
        Of the excitation, in a window of the orders.
    high_band : float, optional
        Hz above which the signs at high frequencies are taken; by default six times the highest
        frequency of the excitation or, where that is lower, 0.3 of the sampling rate. Where that
        is less than 3.3 times the highest frequency they are not computed.
    factor : float
        Times what noise and a sound structure show: a sign above it stands out, ``exceeds``.

    Returns
    -------
    xarray.Dataset
        Over ``sign`` and ``channel``: ``value``; ``floor``, its value by noise; ``sound``
        and ``sound_highest``, the median and the largest value of sound structures under the same
        box with the same noise; ``exceeds``, whether the value is above ``factor`` times
        ``sound_highest`` and the floor, where that is known; unknown without the other two;
        ``frequency`` in Hz, where an order is largest. All signs are numbers without a unit, NaN
        where the record cannot show them.
        Coordinates over ``sign``: its ``meaning``, ``formula``, ``source`` and what else is known
        to move it, ``moved_by``. Over ``channel``: ``noise`` in m/s2. ``sound_f`` in Hz and
        ``sound_zeta`` are the sound structure's. The attribute ``seeds`` has the seeds.

    Raises
    ------
    InputError

    Notes
    -----
    A sign is no verdict: each is moved by other things too. Where the box moves as a sine the noise
    is what two orders without meaning, 2.37 and 3.37, have in the median window: a line of a
    motion with a period is never there. Else it is what stands at 0.36 to 0.44 of the sampling
    rate, impacts included: then it is too large rather than too small.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> sweep = orchestrate.SweptSine(first=10.0, last=14.0, duration=30.0, acceleration=0.2)
    >>> record = orchestrate.measure(
    ...     orchestrate.shake(beam, sweep), orchestrate.Sensor(bandwidth=200.0, noise=1e-3)
    ... )
    >>> answer = orchestrate.signs(record, structure=beam, seeds=2).sel(channel="acceleration1")
    >>> bool(answer.exceeds.sel(sign="order_2") == 1)
    True
    """
    others = [other] if isinstance(other, xr.Dataset) else list(other or ())
    times = checked_range("factor", factor, low=1.0, high=1e6)
    if is_drive_run(record):
        return signs_of_drive_run(record, others, times)
    length = checked_range("periods", periods, low=2.0, high=1e4)
    count = checked_integer("seeds", seeds, 1, 1000)
    every = [channels_with_reference(one) for one in (record, *others)]
    reference = every[0].box_label
    names = checked_response_names(every)
    edge = high_band
    if edge is not None:
        highest = MAX_EDGE * every[0].sample_rate
        edge = checked_range("high_band", edge, "Hz", low=1e-9, high=highest)
    level = None if noise is None else checked_range("noise", noise, "m/s2", low=0.0)
    swept = [has_trackable_sine(channels, length) for channels in every]
    pairs = zip(every, swept, strict=True)
    own = [response_signs(channels, sine, length, edge) for channels, sine in pairs]
    noises = [one.noise if level is None else np.full(len(names), level) for one in own]
    value, floor = all_signs(own, len(names))
    shown, sound = np.full((count, *value.shape), np.nan), UNKNOWN
    if reference != RESPONSE:
        sound = choose_sound_structure(structure, own[0], every[0])
        made = [
            response_signs(sound.simulate_channels(channels, rms, range(count)), sine, length, edge)
            for channels, rms, sine in zip(every, noises, swept, strict=True)
        ]
        rows = all_signs(made, len(names))[0]
        shown = rows.reshape(len(rows), count, len(names)).transpose(1, 0, 2)
    described = {
        "seeds": f"0 to {count - 1}",
        "noise_from": "given" if level is not None else NOISE_SOURCES[swept[0]],
        "sound_from": "nearest oscillator" if structure is None else "the guess, bonded",
        "reference": reference,
    }
    if reference == RESPONSE:
        described["sound_from"] = "none: what excites the structure is unknown"
    unknown = np.full(len(names), np.nan)
    peaks = np.stack([own[0].frequencies.get(name, unknown) for name in INDICATORS])
    text = "frequency of the excitation where it is largest"
    return signs_dataset(every[0].title, names, value, floor, shown, times, described).assign(
        frequency=variable(("sign", "channel"), peaks, "Hz", text),
        noise=variable("channel", noises[0], "m/s2", "root mean square of the noise"),
        sound_f=variable((), sound.f, "Hz", "natural frequency of the sound structure"),
        sound_zeta=variable((), sound.zeta, "1", "damping ratio of the sound structure"),
    )


def channels_with_reference(record: xr.Dataset) -> Channels:
    """Return a record's channels; the force, or the first response, stands for a base without."""
    if not isinstance(getattr(record, "data_vars", None), Mapping) or BOX in record:
        return checked_sensor_channels(record)
    channels = Channels.from_record(record)
    label = next((name for name in FORCES if name in record), RESPONSE)
    values = channels.values[0] if label == RESPONSE else np.asarray(record[label].values, float)
    names, rows = (BOX, *channels.names), np.vstack([values, channels.values])
    return replace(channels, names=names, values=rows, box_label=label)


def checked_response_names(every: Sequence[Channels]) -> tuple[str, ...]:
    """Check that all records have the same responses, and return their names."""
    names = every[0].responses()[0]
    if not names:
        raise InputError("record: no acceleration1, m/s2; signs needs it and box_acceleration")
    for number, channels in enumerate(every[1:]):
        if channels.responses()[0] != names:
            have = " and ".join(channels.responses()[0]) or "none"
            raise InputError(f"other[{number}]: {have}; expected {' and '.join(names)}")
    return names


def choose_sound_structure(
    structure: Structure | None, own: ResponseSigns, channels: Channels
) -> SoundStructure:
    """Return the bonded guess, or the oscillator fitted to the record."""
    refuse_unsupported_structure("signs", structure)
    force = channels.box_label in FORCES
    if structure is not None and not (force and own.curves):
        return SoundStructure.from_structure(structure)
    if not own.curves:
        text = "too short, or the box does not move; expected structure="
        raise InputError(f"record: {text}")
    curve = own.curves[0]
    if structure is not None:
        bonded = SoundStructure.from_structure(structure)
        return bonded.with_gains_under_force(curve.frequency, curve.response)
    return SoundStructure.fit_to_record(curve.frequency, curve.response, channels, force)


def all_signs(own: Sequence[ResponseSigns], channels: int) -> Floats:
    """Return value and noise floor of all signs, also those that compare records.

    Shape (2, signs, rows); NaN where a sign is not known.
    """
    first, curves = own[0], [curve for one in own for curve in one.curves]
    every = {**first.signs, **level_and_direction_differences(curves, len(first.noise))}
    if first.curves:
        every["sensor_difference"] = sensor_difference(first.curves, channels)
    unknown = (np.full(len(first.noise), np.nan),) * 2
    return np.array([every.get(name, unknown) for name in INDICATORS]).swapaxes(0, 1)


# -- results --------------------------------------------------------------------------------------


def signs_dataset(
    title: str,
    names: Sequence[str],
    value: Floats,
    floor: Floats,
    shown: Floats,
    factor: float,
    described: dict[str, Any],
) -> xr.Dataset:
    over = ("sign", "channel")
    is_complete = np.isfinite(shown).all(axis=0)  # for all seeds
    median = np.where(is_complete, np.median(np.nan_to_num(shown), axis=0), np.nan)
    highest = np.fmax.reduce(shown)
    limit = factor * np.fmax(floor, highest)
    known = np.isfinite(value) & np.isfinite(highest)
    exceeds = np.where(known, value > limit, -1)
    texts = (
        ("meaning", "long_name", "what the sign is"),
        ("formula", "formula", "formula"),
        ("source", "source", "where it is described"),
        ("moved_by", "moved_by", "what else than delamination moves it"),
    )
    columns = {name: [getattr(one, of) for one in INDICATORS.values()] for name, of, _ in texts}
    return xr.Dataset(
        {
            "value": variable(over, value, "1", "sign of the record"),
            "floor": variable(over, floor, "1", "its value by noise"),
            "sound": variable(over, median, "1", "of a sound structure, median"),
            "sound_highest": variable(over, highest, "1", "of a sound structure, largest"),
            "exceeds": flags(over, exceeds, f"whether it is above {factor:g} times all", MEANINGS),
        },
        {
            "sign": ("sign", np.array(list(INDICATORS)), {"long_name": "sign"}),
            "channel": ("channel", np.array(names), {"long_name": "channel of the record"}),
            **{n: ("sign", np.array(columns[n]), {"long_name": text}) for n, _, text in texts},
        },
        analysis_attributes("signs", "Signs", title, factor=factor, **described),
    )


def signs_of_drive_run(run: xr.Dataset, others: Sequence[xr.Dataset], factor: float) -> xr.Dataset:
    """Compute the signs of a run on a weak drive, against that of the sound beam."""
    if len(others) != 1 or not is_drive_run(others[0]):
        raise InputError("other: expected the run of the sound beam on the same drive")
    known, unknown = drive_signs(run, others[0]), (math.nan, math.nan)
    value, floor = np.array([known.get(name, unknown) for name in INDICATORS]).T[..., np.newaxis]
    shown = 0.0 * floor[np.newaxis]  # against itself; an unknown floor stays so
    title = str(run.attrs.get("title", "run"))
    described = {"seeds": "none", "sound_from": "the run of the sound beam"}
    return signs_dataset(title, ["motor"], value, floor, shown, factor, described)
