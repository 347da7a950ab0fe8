"""The columns of a file as a dataset, and as a setup, a TOML file to complete and give back.

The command ``channels`` prints them (``cli/laboratory.py``).
"""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..files import write_atomically
from ..lazy import xr
from ..model.arguments import checked_path
from ..response.labels import variable
from .columns import Column, ColumnAssignment, Columns, assign_columns, convert_to_si, times_in_s
from .conversion import (
    FORCES,
    MOTIONS,
    OF_MOTIONS,
    VOLTAGES,
    ByChannel,
    expand_by_channel,
    normalize_unit,
)
from .record import CHANNELS, SHORT_NAMES
from .record_checks import is_ascending
from .record_files import read_columns_in_process
from .stated_channels import ACTING, SENSOR_WORDS, Channels, ChannelSetup

NOT_READ = "not read"
QUANTITIES = {word: OF_MOTIONS[n] for n, word in MOTIONS.items()}
QUANTITIES |= {"voltage": VOLTAGES, "force": FORCES}


def channels(
    path: str | os.PathLike[str],
    channels: Channels = None,
    *,
    unit: ByChannel = None,
    sensitivity: ByChannel = None,
    sample_rate: float | None = None,
    scale: ByChannel = None,
    delay: ByChannel = None,
    resample: bool = False,
    output: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    r"""List a file's columns, and the channels that :func:`orchestrate.read_record` reads there.

    Parameters
    ----------
    path : path-like
        As for :func:`orchestrate.read_record`.
    channels : path-like, mapping, sequence or str, optional
        As for :func:`orchestrate.read_record`.
    unit, sensitivity, sample_rate, scale, delay, resample
        As for :func:`orchestrate.read_record`.
    output : path-like, optional
        Where to write the setup as TOML: to complete by hand, and to give as ``channels`` to
        whatever reads such files.

    Returns
    -------
    xarray.Dataset
        Over ``column``, by the names in the file: ``role`` (time, base, face 1, ...; empty where
        it is not read), ``known`` (how that is known), ``quantity``, ``unit`` and ``rms`` (without
        its mean, in that unit; NaN of times and texts). Attributes ``sample_rate``, Hz, 0 if
        unknown, and ``refused``: why the channels cannot be read so; empty if they can.

    Raises
    ------
    InputError, StoreError

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "a.csv"
    >>> _ = path.write_text("Zeit [ms];Tisch [g];oben [g]\n0;0,1;0\n1;0,3;2\n2;-0,2;0\n3;0;-1\n")
    >>> listing = channels(path)
    >>> listing.role.values.tolist(), listing.known.values.tolist()[1:]
    (['time', 'base', 'face 1'], ['by its name', 'what is left'])
    """
    setup = ChannelSetup.from_argument(channels)
    rate = setup.sample_rate if sample_rate is None else sample_rate
    table = read_columns_in_process(checked_path("path", path)).with_sample_rate(rate)
    assignment = assign_columns(table, setup.columns)
    stated = setup.merge_keywords(unit=unit, sensitivity=sensitivity, scale=scale, delay=delay)
    used = [name for name in assignment.indices if name != "time"]
    words = {key: expand_by_channel(key, value, used, ("time",)) for key, value in stated.items()}
    setup = replace(setup, words={**setup.words, **words}, resample=resample or setup.resample)
    listing = dataset_of_columns(table, assignment, setup)
    try:
        convert_to_si(table, setup.columns, stated["unit"], stated["sensitivity"], setup.file)
    except InputError as error:
        listing.attrs["refused"] = str(error)
    if output is not None:
        write_channels_toml(listing, setup, checked_path("output", output))
    return listing


def dataset_of_columns(
    table: Columns, assignment: ColumnAssignment, setup: ChannelSetup
) -> xr.Dataset:
    import xarray as xr

    roles = {index: name for name, index in assignment.indices.items()}
    units = setup.words.get("unit", {})
    rows = []
    for index, column in enumerate(table.columns):
        name = roles.get(index)
        unit = str(units.get(name, column.unit)) if name else column.unit
        rms = np.nan if column.text or name == "time" else float(np.std(column.values))
        known = assignment.known[name] if name else NOT_READ
        role = SHORT_NAMES.get(name, name) if name else ""
        rows.append((role, known, quantity_of_column(column, unit, role), unit, rms))
    texts = {
        "role": "channel it is read as",
        "known": "how that is known",
        "quantity": "what it holds",
        "unit": "unit in the file",
        "rms": "root mean square without the mean, in its unit",
    }
    parts = zip(texts.items(), zip(*rows, strict=True), strict=True)
    made = {name: variable("column", list(values), "1", text) for (name, text), values in parts}
    names = variable("column", [one.name for one in table.columns], "1", "name in the file")
    rate = table.sample_rate
    if rate is None and "time" in assignment.indices:
        column = table.columns[assignment.indices["time"]]
        time = times_in_s(table, column, str(units.get("time", "")))
        if time is not None and time[-1] > time[0]:
            rate = float((len(time) - 1) / (time[-1] - time[0]))
    title = f"Columns of {Path(table.path).name}"
    words = {"title": title, "sample_rate": rate or 0.0, "refused": ""}
    return xr.Dataset(made, {"column": names}, words)


def quantity_of_column(column: Column, unit: str, role: str) -> str:
    """Return a word: text, time, a quantity by the unit, counter or unknown."""
    if column.text:
        return "text"
    if role == "time":
        return "time"
    plain = normalize_unit(unit)
    known = [name for name, units in QUANTITIES.items() if plain in units]
    return known[0] if known else "counter" if is_ascending(column.values) else "unknown"


def write_channels_toml(listing: xr.Dataset, setup: ChannelSetup, path: Path) -> Path:
    """Write a setup as TOML; what is not known of the sensors is left to be filled in."""
    of_role = {SHORT_NAMES.get(name, name): name for name in ("time", *CHANNELS)}
    lines = [f"# {listing.attrs['title']}: columns by name or number from 0, units as in the file"]
    if listing.attrs["sample_rate"] and "time" not in listing.role.values:
        lines.append(f"sample_rate = {float(listing.attrs['sample_rate'])!r}  # Hz")
    lines += ["resample = true"] if setup.resample else []
    headings = listing.column.values.tolist()
    fields = ("role", "known", "quantity", "unit", "rms")
    rows = zip(headings, *(listing[field].values.tolist() for field in fields), strict=True)
    for index, (heading, role, known, quantity, unit, rms) in enumerate(rows):
        label = f"{heading}, {quantity}" + ("" if np.isnan(rms) else f", rms {rms:.4g}")
        if not role:
            lines.append(f"\n# not read: {label} {unit}".rstrip())
            continue
        name = of_role[role]
        lines += [f"\n[{role.replace(' ', '')}]  # {known}; {label}"]
        column = index if headings.count(heading) > 1 else heading
        lines.append(f"column = {json.dumps(column, ensure_ascii=False)}")
        keys = ("unit",) if name == "time" else (*ACTING, *SENSOR_WORDS)
        for key in keys:
            value = setup.words.get(key, {}).get(name, unit if key == "unit" else "")
            lacking = key == "sensitivity" and quantity == "voltage"
            if value != "" or lacking or key in ("unit", *SENSOR_WORDS):
                usual = "s or ms" if name == "time" else "g, m/s2, mm/s, um, N, V"
                remark = f"  # write it: {usual}" if (key, value) == ("unit", "") else ""
                lines.append(f"{key} = {json.dumps(value, ensure_ascii=False)}{remark}")
    text = "\n".join(lines) + "\n"
    return write_atomically(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))
