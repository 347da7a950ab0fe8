"""Columns of a file as they stand there, and which of them are a record's channels."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..constants import GRAVITY, TURN
from ..errors import InputError
from .record import CHANNELS, SHORT_NAMES

Floats = NDArray[np.float64]
INCH = 0.0254
ACCELERATIONS = {  # in m/s2
    **dict.fromkeys(("m/s2", "m/s/s", "ms-2", "m/sec2", "ms2"), 1.0),
    **dict.fromkeys(("g", "gn", "g0", "gs", "gpk", "gpeak"), GRAVITY),
    "mg": 1e-3 * GRAVITY,
    "mm/s2": 1e-3,
    "cm/s2": 1e-2,
    "gal": 1e-2,
    "in/s2": INCH,
    "ft/s2": 12.0 * INCH,
}
SPEEDS = {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "in/s": INCH}  # in m/s
LENGTHS = {  # in m
    **{"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": INCH, "mil": 1e-3 * INCH, "nm": 1e-9},
    **dict.fromkeys(("um", "\u00b5m", "\u03bcm", "micron"), 1e-6),
}
FREQUENCIES = {  # in Hz
    **{"hz": 1.0, "1/s": 1.0, "khz": 1e3, "rad/s": 1.0 / TURN},
    **dict.fromkeys(("rpm", "1/min"), 1.0 / 60.0),
}
ANGLES = {  # in rad
    **dict.fromkeys(("rad", "radian", "radians"), 1.0),
    **dict.fromkeys(("deg", "\u00b0", "degree", "degrees"), TURN / 360.0),
}
RATIOS = dict.fromkeys(("1", "-", "g/g", "m/m", "mm/mm", "m/s2/m/s2", "(m/s2)/(m/s2)"), 1.0)
TIMES = {  # in s
    **dict.fromkeys(("s", "sec", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec"), 1e-3),
    **dict.fromkeys(("us", "\u00b5s", "\u03bcs"), 1e-6),
    "min": 60.0,
}
NAMES = {  # as files call them; letters and digits alone, small
    "time": ("time", "t", "zeit"),
    "box_acceleration": ("boxacceleration", "box", "base", "table", "shaker", "abox", "abase"),
    "acceleration1": ("acceleration1", "mass1", "a1", "acc1", "accel1", "face1", "beam", "face"),
    "acceleration2": ("acceleration2", "mass2", "a2", "acc2", "accel2", "face2"),
}
HEADING = re.compile(r"^(?P<name>.*?)[\s_]*[\[(](?P<unit>[^\[\]()]*)[\])]\s*$")


@dataclass(frozen=True)
class Column:
    """Hold a column of a file: its name, unit and numbers."""

    name: str
    unit: str  # as it stands there; empty where there is none
    values: Floats


@dataclass(frozen=True)
class Columns:
    """Hold all columns of a file."""

    path: str
    columns: list[Column]
    sample_rate: float | None = None  # hz, where the file says it
    first_row: int = 0  # number of the first values in the file's own count
    # what a record written by this package says of itself
    attributes: dict[str, Any] = field(default_factory=dict)


def split_heading(heading: str) -> tuple[str, str]:
    """Split a column's heading; return its name and its unit, an empty string without one.

    Examples
    --------
    >>> split_heading("Acc 1 [g]"), split_heading("base (m/s^2)"), split_heading("time")
    (('Acc 1', 'g'), ('base', 'm/s^2'), ('time', ''))
    """
    found = HEADING.match(heading.strip().strip('"').strip())
    if found is None:
        return heading.strip().strip('"').strip(), ""
    return found["name"].strip(), found["unit"].strip()


def plain_unit(text: str) -> str:
    """Return a unit in the spelling of the tables of units.

    Examples
    --------
    >>> plain_unit("m/s\u00b2"), plain_unit("M/S^2"), plain_unit("m/s**2"), plain_unit(" G ")
    ('m/s2', 'm/s2', 'm/s2', 'g')
    """
    plain = text.strip().lower().replace("\u00b2", "2").replace("\u207b", "-")
    return plain.translate(str.maketrans("", "", "^*_. \u00b7[]()"))


def is_unit(text: str) -> bool:
    """Return whether a text is a unit that columns of records or resonance curves may have."""
    known = (ACCELERATIONS, TIMES, SPEEDS, LENGTHS, FREQUENCIES, ANGLES, RATIOS)
    return any(plain_unit(text) in units for units in known)


def si_factor(label: str, unit: str, known: Mapping[str, float]) -> float:
    """Return the factor that converts a unit to SI."""
    if plain_unit(unit) not in known:
        usual = ("g", "mg", "ms", "rad/s", "deg")
        names = ", ".join(list(known)[:1] + [name for name in usual if name in known])
        text = f"unit = {unit!r}" if unit else "no unit"
        remedy = "give it by unit=" if known is ACCELERATIONS else "mend it in the file"
        raise InputError(f"{label}: {text}; expected one such as {names}: {remedy}")
    return known[plain_unit(unit)]


def converted_channels(
    table: Columns,
    columns: Mapping[str, str | int] | Sequence[str | int] | None,
    unit: str | None,
) -> tuple[Floats | None, dict[str, Floats], dict[str, str]]:
    """Convert a file's columns: return times in s or None, channels in m/s2, how they were read.

    How they were read are attributes of a record: ``columns``, which column was taken for what;
    ``unit`` of the accelerations; and ``unit_in_file``, where ``unit`` was taken in its place.
    """
    known = channels_by_name(table) if columns is None else {}
    places = known or channel_places(table, columns)
    by_order = ", by their order: no name is known" if columns is None and not known else ""
    time, read_as = None, {"columns": taken_text(table, places) + by_order}
    if "time" in places:
        column = table.columns[places.pop("time")]
        label = column_label(table, column)
        time = scaled_values(table, column, si_factor(label, column.unit or "s", TIMES))
    if not places:
        raise InputError(f"{table.path}: no channel; expected one of {', '.join(CHANNELS)}")
    values = {}
    for name, place in places.items():
        column = table.columns[place]
        own = column.unit if unit is None else unit
        values[name] = scaled_values(
            table, column, si_factor(column_label(table, column), own, ACCELERATIONS)
        )
    channels = [table.columns[place] for place in places.values()]
    return time, values, read_as | unit_attributes(channels, unit)


def unit_attributes(channels: Sequence[Column], unit: str | None) -> dict[str, str]:
    """Return a record's attributes on its unit: the one used, and the file's own if it differs."""
    own = ", ".join(dict.fromkeys(column.unit for column in channels if column.unit))
    if unit is None:
        return {"unit": own}
    differs = any(
        column.unit and plain_unit(column.unit) != plain_unit(unit) for column in channels
    )
    return {"unit": unit, "unit_in_file": own} if differs else {"unit": unit}


def taken_text(table: Columns, places: Mapping[str, int]) -> str:
    """Return a text that says which column was taken for what."""
    return ", ".join(
        f'{SHORT_NAMES.get(name, name)} "{table.columns[i].name}"' for name, i in places.items()
    )


def column_taken(attributes: Mapping[Any, Any], channel: str) -> str:
    """Return what a record's attribute ``columns`` says a channel was read from, or its name.

    Examples
    --------
    >>> read_as = {"columns": 'time "t", base "shaker table", face 1 "left"'}
    >>> column_taken(read_as, "box_acceleration"), column_taken({}, "box_acceleration")
    ('base "shaker table"', 'box_acceleration')
    """
    word = re.escape(SHORT_NAMES.get(channel, channel))
    ends = "|".join(map(re.escape, ("time", *SHORT_NAMES.values())))
    pattern = rf'(?:^|, )({word} ".*?")(?=, (?:{ends}) "|, by their order|$)'
    match = re.search(pattern, str(attributes.get("columns", "")))
    return match[1] if match else channel


def column_label(table: Columns, column: Column) -> str:
    """Return the names of file and column as a text for messages."""
    return f'{table.path}, column "{column.name}"'


def scaled_values(table: Columns, column: Column, factor: float) -> Floats:
    """Return a column as numbers times a unit's factor; raise naming a non-number's row."""
    wrong = np.flatnonzero(~np.isfinite(column.values))
    if len(wrong):
        row, value = wrong[0] + table.first_row, column.values[wrong[0]]
        more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        raise InputError(
            f"{column_label(table, column)}, row {row}: {value}{more}; expected numbers"
        )
    return column.values if factor == 1.0 else factor * column.values


def channel_places(
    table: Columns, columns: Mapping[str, str | int] | Sequence[str | int] | None
) -> dict[str, int]:
    """Return the column index of each channel and of the time, as asked for or by their order.

    The order is time, base, face 1, face 2; without time where the file says the sampling rate.
    """
    wanted = (*(() if table.sample_rate else ("time",)), *CHANNELS)
    if columns is None:
        if len(table.columns) > len(wanted):
            names = ", ".join(column.name for column in table.columns[:8])
            text = "expected columns=, which of them are time and channels"
            raise InputError(f"{table.path}: {len(table.columns)} columns {names}; {text}")
        return dict(zip(wanted, range(len(table.columns)), strict=False))
    places = places_asked_for(table, columns, wanted, ("time", *CHANNELS))
    if "time" in wanted and "time" not in places:
        named = [i for i, one in enumerate(table.columns) if one.name.lower() in NAMES["time"]]
        places["time"] = (named or [0])[0]
    return places


def places_asked_for(
    table: Columns,
    columns: Mapping[str, str | int] | Sequence[str | int],
    order: Sequence[str],
    names: Sequence[str],
) -> dict[str, int]:
    """Return the column index of each quantity that a caller asks for, by the quantity's name."""
    if not isinstance(columns, Mapping):
        if isinstance(columns, str) or len(columns) > len(order):
            raise InputError(f"columns = {columns!r}: expected {', '.join(order)} in that order")
        columns = dict(zip(order, columns, strict=False))
    if unknown := sorted(set(columns) - set(names)):
        raise InputError(f"columns: {unknown[0]!r}; expected names of {', '.join(names)}")
    return {name: column_index(table, wish) for name, wish in columns.items()}


def channels_by_name(table: Columns) -> dict[str, int]:
    """Return the column index of time and channels by their usual names; empty if no channel."""
    known = places_by_name(table, NAMES)
    return known if set(known) & set(CHANNELS) else {}


def places_by_name(table: Columns, names: Mapping[str, Sequence[str]]) -> dict[str, int]:
    """Return the column index of each quantity whose usual names are among the headings."""
    plain = [re.sub(r"[\W_]", "", column.name.lower()) for column in table.columns]
    return {
        name: plain.index(one)
        for name, all_names in names.items()
        for one in all_names
        if one in plain
    }


def column_index(table: Columns, wish: str | int) -> int:
    """Return the index of a column that is asked for by name or number."""
    names = [column.name for column in table.columns]
    if wish in names:
        return names.index(str(wish))
    number = isinstance(wish, int) and not isinstance(wish, bool)
    if number and 0 <= int(wish) < len(names):
        return int(wish)
    text = f"expected one of {', '.join(names[:12])}, or 0 to {len(names) - 1}"
    raise InputError(f"{table.path}: no column {wish!r}; {text}")
