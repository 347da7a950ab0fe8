"""Columns of a file as they stand there, and which of them are a record's channels.

Columns with usual names (:data:`.headings.NAMES`) are known; those assigned by position are
reported as a guess, unread ones give a warning.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np

from ..errors import InputError
from .conversion import (
    ACCELERATIONS,
    LENGTHS,
    OF_FORCES,
    OF_MOTIONS,
    SPEEDS,
    VOLTAGES,
    ByChannel,
    factor_and_derivatives,
    normalize_unit,
    si_factor,
    text_by_channel,
)
from .headings import NAMES, SWEPT, TIMES, describe_text, split_heading
from .pieces import Floats
from .record import CHANNELS, FORCES, SHORT_NAMES
from .record_checks import doubt_about_time_unit, first_skipped_row, is_ascending
from .signals import HERTZ, checked_quantity

Named: TypeAlias = "Mapping[str, str | int] | Sequence[str | int] | None"  # columns by a caller
MOST_NAMES = 12  # of columns in a message
USUAL_UNITS = "m/s2, g, mm/s, um", "100 mV/g"  # and the sensitivity of a sensor in volts
LARGEST = 1e100  # of a number in SI units: derivatives and spectra of larger ones leave the range


@dataclass(frozen=True)
class Column:
    """Hold a column of a file: its name, unit and numbers."""

    name: str
    unit: str  # as it stands there; empty where there is none
    values: Floats  # NaN in a column of texts
    text: str = ""  # the first one of such a column
    sensitivity: str = ""  # of a voltage, as it stands there: 100 mV/g


Used = Mapping[str, Column]  # by channel


@dataclass(frozen=True)
class Columns:
    """Hold all columns of a file."""

    path: str
    columns: list[Column]
    sample_rate: float | None = None  # Hz, where the file says it
    first_row: int = 0  # number of the first values in the file's own count
    attributes: dict[str, Any] = field(default_factory=dict)  # what our own records say

    def with_sample_rate(self, sample_rate: float | None) -> Columns:
        """Return the same columns, sampled at a rate in Hz; None: at the file's own."""
        if sample_rate is None:
            return self
        try:
            return replace(self, sample_rate=checked_quantity(HERTZ, "sample_rate", sample_rate))
        except InputError as error:
            raise InputError(f"{self.path}: {error}") from None


BY_USER, BY_NAME, LEFT, BY_ORDER = "by the caller", "by its name", "what is left", "by its order"


@dataclass(frozen=True)
class ColumnAssignment:
    """Index of the column of the time and of each channel, and how that is known."""

    indices: dict[str, int]
    known: dict[str, str]  # one of the words above, by channel

    def format(self, table: Columns) -> str:
        texts = []
        for name, index in self.indices.items():
            guess = f" ({BY_ORDER})" if self.known[name] == BY_ORDER else ""
            texts.append(f'{SHORT_NAMES.get(name, name)} "{table.columns[index].name}"{guess}')
        return ", ".join(texts)

    def warn_of_guesses(self, table: Columns, option: str = "channels=") -> None:
        """Warn of columns that were assigned by their order, or ignored."""
        if not (BY_NAME in self.known.values() or LEFT in self.known.values()):
            return
        proposed = {n: i for n, i in self.indices.items() if self.known[n] == BY_ORDER}
        said = [f'"{table.columns[i].name}" as {SHORT_NAMES[n]}' for n, i in proposed.items()]
        unread = [f'"{table.columns[i].name}"' for i in unassigned_columns(table, self.indices)]
        texts = [f"read {BY_ORDER}: {', '.join(said)}" if said else ""]
        texts += [f"not read: {', '.join(unread)}" if unread else ""]
        if text := "; ".join(filter(None, texts)):
            text = f"{table.path}: {text}; {option} says which column is which"
            text += self.suggest_arguments(table) if unread else ""
            warnings.warn(text, UserWarning, stacklevel=5)

    def suggest_arguments(self, table: Columns) -> str:
        """Return a text with arguments that read unassigned columns as the missing channels."""
        missing = [name for name in list(CHANNELS)[:3] if name not in self.indices]
        new = dict(zip(missing, unassigned_columns(table, self.indices), strict=False))
        names = [column.name for column in table.columns]
        unique = {i: name if names.count(name) == 1 else i for i, name in enumerate(names)}
        indices = {name: i for name, i in (self.indices | new).items() if name != "time"}
        columns = format_by_channel([*indices], {n: str(unique[i]) for n, i in indices.items()})
        bare = [name for name, i in indices.items() if not table.columns[i].unit]
        unit = f" with unit={format_by_channel(bare, {})}" if bare else ""
        return f", such as channels={columns}{unit}" if new else ""


def convert_to_si(
    table: Columns, columns: Named, unit: ByChannel, sensitivity: ByChannel, setup_file: str
) -> tuple[Floats | None, dict[str, Floats], dict[str, int], dict[str, str]]:
    """Convert a file's columns to SI.

    Return times in s or None, the channels, how many derivatives make the acceleration of each,
    and a record's attributes.
    """
    assignment = assign_columns(table, columns)
    indices = dict(assignment.indices)
    check_unassigned_counters(table, indices)
    assignment.warn_of_guesses(table)
    warn_of_lines_left_out(table)
    read_as = {"columns": assignment.format(table)}
    clock = indices.pop("time", None)
    units = text_by_channel("unit", unit, list(indices), ("time",))
    time = None if clock is None else times_in_s(table, table.columns[clock], units.get("time", ""))
    if not indices:
        text = f"no channel; expected one of {', '.join(CHANNELS)}"
        text += "" if time is None else " besides the times, or sample_rate= if there are no times"
        raise InputError(f"{table.path}: {text}")
    stated = text_by_channel("sensitivity", sensitivity, list(indices))
    used = {name: table.columns[place] for name, place in indices.items()}
    of_all = isinstance(sensitivity, str) and "=" not in sensitivity and {*units} - {"time"}
    # not all are in volts where some are
    check_units(table.path, used, units, {} if of_all else stated, setup_file)
    check_sensitivities(table.path, used, units, stated)
    channels, derivatives = {}, {}
    for name, column in used.items():
        own = units.get(name, column.unit)
        sensor = stated.get(name, column.sensitivity)
        label = column_label(table, column)
        tables = OF_FORCES if name in FORCES else OF_MOTIONS
        factor, derivatives[name] = factor_and_derivatives(label, own, sensor, tables)
        if name in stated and normalize_unit(own or "V") not in VOLTAGES:
            expected = f"expected volts: a sensitivity does not act on a column in {own}"
            raise InputError(f"{label}: sensitivity {sensor}; {expected}")
        channels[name] = scaled_values(table, column, factor)
    return time, channels, derivatives, read_as | unit_attributes(used, units)


def check_units(
    path: str, used: Used, units: Mapping[str, str], stated: Mapping[str, str], setup_file: str
) -> None:
    """Raise where columns have no unit, with the argument that states it for each."""
    known = {n: units.get(n, one.unit) or stated.get(n, one.sensitivity) for n, one in used.items()}
    if unknown := [name for name, text in known.items() if not text]:
        words = {n: SHORT_NAMES.get(n, n).replace(" ", "") for n in (*units, *unknown)}
        order = [n for n in ("time", *used) if n in words]
        usual, volts = ("N, kN", "22 mV/N") if {*unknown} <= {*FORCES} else USUAL_UNITS
        volts = f', or V or mV with sensitivity="{volts}"'
        text = f"no unit; expected one such as {usual}{volts}: give it by unit="
        sections = ", ".join(f"[{words[n]}]" for n in unknown)
        there = f', or in {setup_file} write unit = "..." below {sections}' if setup_file else ""
        argument = format_by_channel(order, units)
        columns = format_file_and_columns(path, used, unknown)
        raise InputError(f"{columns}: {text}{argument}{there}")


def check_sensitivities(
    path: str, used: Used, units: Mapping[str, str], stated: Mapping[str, str]
) -> None:
    """Raise where columns in volts have no sensitivity, with the argument that states it."""
    volts = {n: units.get(n, one.unit) for n, one in used.items()}
    volts = {n: unit for n, unit in volts.items() if normalize_unit(unit) in VOLTAGES}
    if bare := [name for name in volts if not stated.get(name, used[name].sensitivity)]:
        usual = [] if {*bare} <= {*FORCES} else ["100 mV/g or 50 mV/(mm/s)"]
        usual += ["22 mV/N"] if {*bare} & {*FORCES} else []
        text = f"in {volts[bare[0]]}, without a sensitivity; expected one such as "
        option = format_by_channel([n for n in used if n in (*stated, *bare)], stated)
        text = f"{text}{', of forces '.join(usual)}: give it by sensitivity={option}"
        raise InputError(f"{format_file_and_columns(path, used, bare)}: {text}")


def format_file_and_columns(path: str, used: Used, names: Sequence[str]) -> str:
    columns = (f'column "{used[name].name}" ({SHORT_NAMES[name]})' for name in names)
    return f"{path}, {', '.join(columns)}"


def format_by_channel(names: Sequence[str], values: Mapping[str, str]) -> str:
    """Format an argument by channel, to be completed: ``"base=V,face1=..."``."""
    words = (SHORT_NAMES.get(name, name).replace(" ", "") for name in names)
    pairs = zip(words, (values.get(name) or "..." for name in names), strict=True)
    return f'"{",".join(map("=".join, pairs))}"'


def times_in_s(table: Columns, column: Column, unit: str) -> Floats | None:
    """Return times in s, by ``unit`` or the file's; None of texts if the sampling rate is known."""
    label = column_label(table, column)
    if column.text and table.sample_rate is None:
        text = f"{describe_text(column.text)}; expected numbers in s, or sample_rate="
        raise InputError(f"{label}, row {table.first_row}: {text}")
    if column.text:
        return None
    time = scaled_values(table, column, si_factor(label, unit or column.unit or "s", TIMES))
    if not (unit or column.unit) and (doubt := doubt_about_time_unit(time)):
        warnings.warn(f"{label}: {doubt}", UserWarning, stacklevel=4)
    return time


def unit_attributes(channels: Mapping[str, Column], units: Mapping[str, str]) -> dict[str, str]:
    """Return a record's attributes ``unit``, ``unit_in_file`` (if it differs), ``time_unit``."""
    own = ", ".join(dict.fromkeys(one.unit for one in channels.values() if one.unit))
    used = ", ".join(dict.fromkeys(units.get(name, one.unit) for name, one in channels.items()))
    stated = [(one.unit, units.get(name, one.unit)) for name, one in channels.items() if one.unit]
    differs = any(normalize_unit(unit) != normalize_unit(other) for unit, other in stated)
    words = {"unit_in_file": own if differs else "", "time_unit": units.get("time", "")}
    return {"unit": used} | {name: text for name, text in words.items() if text}


def source_column_label(attributes: Mapping[Any, Any], channel: str) -> str:
    """Return the column that a channel was read from by a record's attributes, or its name."""
    word = re.escape(SHORT_NAMES.get(channel, channel))
    ends = "|".join(map(re.escape, ("time", *SHORT_NAMES.values())))
    pattern = rf'(?:^|, )({word} ".*?")(?=, (?:{ends}) "| \({BY_ORDER}\)|$)'
    match = re.search(pattern, str(attributes.get("columns", "")))
    return match[1] if match else channel


def column_label(table: Columns, column: Column) -> str:
    """Return the names of file and column as a text for messages."""
    return f'{table.path}, column "{column.name}"'


def scaled_values(table: Columns, column: Column, factor: float) -> Floats:
    """Return a column's numbers times a unit's factor; raise naming the row of another field."""
    if column.text:
        text = f"{describe_text(column.text)}; expected numbers"
        raise InputError(f"{column_label(table, column)}, row {table.first_row}: {text}")
    values = column.values if factor == 1.0 else factor * column.values
    wrong = np.flatnonzero(~(np.abs(values) <= LARGEST))
    if len(wrong):
        row, value = wrong[0] + table.first_row, column.values[wrong[0]]
        more = f" and {len(wrong) - 1} more" if len(wrong) > 1 else ""
        expected = f"expected numbers of sizes up to {LARGEST:g} in SI units"
        raise InputError(f"{column_label(table, column)}, row {row}: {value}{more}; {expected}")
    return values


def assign_columns(table: Columns, columns: Named) -> ColumnAssignment:
    """Decide which columns are the time and the channels.

    - A caller's columns are taken as stated; the time, if not stated, by its name, else the first.
    - Columns with usual names are what these say; several with one name are refused.
    - The only column left is the base or the face, if only that is missing.
    - Where the base or a force is known and no face, one or two columns left are the faces in
      their order; more are not read.
    - Where no name is known, all are taken in their order; more columns than channels are refused.
    """
    refuse_unnamed_spectra(table, columns)
    wanted = (*(() if table.sample_rate else ("time",)), *CHANNELS)[: 3 + (not table.sample_rate)]
    if columns is not None:
        indices = requested_column_indices(table, columns, wanted, ("time", *CHANNELS))
        if "time" in wanted and "time" not in indices:
            indices["time"] = column_indices_by_name(table, {"time": NAMES["time"]}).get("time", 0)
        return ColumnAssignment(indices, dict.fromkeys(indices, BY_USER))
    known = assign_columns_by_name(table)
    if known.indices.keys() & set(CHANNELS):
        return known
    indices = column_indices_by_order(table, wanted)
    return ColumnAssignment(indices, dict.fromkeys(indices, BY_ORDER))


def column_indices_by_order(table: Columns, wanted: Sequence[str]) -> dict[str, int]:
    """Return the column index of each quantity by order; refuse directions and further columns."""
    numbers = [i for i, one in enumerate(table.columns) if not one.text]
    if "time" in wanted:
        numbers = sorted({0, *numbers})  # a time that is a text is refused later
    else:
        numbers = [i for i in numbers if not is_ascending(table.columns[i].values)]
    names = (table.columns[i].name.lower() for i in numbers)
    stems = [name[:-1] for name in names if name.endswith(("x", "y", "z"))]
    some = dict(zip(wanted, (one.name for one in table.columns), strict=False))
    expected = f"expected channels=, such as channels={format_by_channel(wanted[:3], some)}"
    if len(stems) > len(set(stems)):
        text = f"directions of one sensor among the columns {format_column_names(table)}"
        raise InputError(f"{table.path}: {text}; {expected}")
    if len(numbers) > len(wanted):
        text = f"{len(table.columns)} columns {format_column_names(table)}"
        raise InputError(f"{table.path}: {text}; {expected}")
    return dict(zip(wanted, numbers, strict=False))


def check_unassigned_counters(table: Columns, assigned: Mapping[str, int]) -> None:
    """Raise if an unassigned column is a counter that skips numbers."""
    for i, column in enumerate(table.columns):
        row = None if i in assigned.values() or column.text else first_skipped_row(column.values)
        if row is not None:
            text = f"{column.values[row]:.9g} after {column.values[row - 1]:.9g}"
            expected = "expected equal steps: samples are lost, cut the record there"
            label = column_label(table, column)
            raise InputError(f"{label}, row {row + table.first_row}: {text}; {expected}")


def refuse_unnamed_spectra(table: Columns, columns: Named) -> None:
    """Raise of a file with spectra unless its times and channels are named, by users or usually."""
    if not (spectra := table.attributes.get("spectra")):
        return
    usual = column_indices_by_name(table, NAMES if columns is None else {"time": NAMES["time"]})
    by_user = columns is not None and ("time" in columns or not isinstance(columns, Mapping))
    if columns is None:
        named = "time" in usual and len(usual) > 1
    else:
        named = by_user or bool(usual) or table.sample_rate is not None
    if not named:
        text = "expected accelerations over time: channels= names them where the file has some"
        raise InputError(f"{table.path}: {spectra}; {text}")


def warn_of_lines_left_out(table: Columns) -> None:
    """Warn of lines after the numbers that hold no numbers."""
    if text := table.attributes.get("left_out"):
        warnings.warn(f"{table.path}, {text}", UserWarning, stacklevel=4)


def unassigned_columns(table: Columns, indices: Mapping[str, int]) -> list[int]:
    """Return the indices of unassigned columns that may be channels by their unit, or have none."""
    units = {"", *ACCELERATIONS, *SPEEDS, *LENGTHS, *VOLTAGES}
    return [
        i
        for i, one in enumerate(table.columns)
        if not (i in indices.values() or one.text or is_ascending(one.values))
        and normalize_unit(one.unit) in units
    ]


def format_column_names(table: Columns) -> str:
    """Return the names of a file's first columns, and how many more there are, as a text."""
    names = [column.name for column in table.columns]
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more


def requested_column_indices(
    table: Columns,
    columns: Mapping[str, str | int] | Sequence[str | int],
    order: Sequence[str],
    names: Sequence[str],
) -> dict[str, int]:
    """Return the column index of each quantity that a caller asks for, by the quantity's name."""
    if not isinstance(columns, Mapping):
        if isinstance(columns, str) or len(columns) > len(order):
            raise InputError(f"channels = {columns!r}: expected {', '.join(order)} in that order")
        columns = dict(zip(order, columns, strict=False))
    if unknown := sorted(set(columns) - set(names)):
        raise InputError(f"channels: {unknown[0]!r}; expected names of {', '.join(names)}")
    return {name: column_index(table, wish) for name, wish in columns.items()}


def assign_columns_by_name(table: Columns) -> ColumnAssignment:
    """Assign time and channels by their usual names, then the columns left."""
    indices = column_indices_by_name(table, NAMES)
    if "time" not in indices and not table.sample_rate:
        units = [normalize_unit(one.unit) for one in table.columns]
        density = [unit for unit in units if re.fullmatch(r".+/\W*hz", unit)]
        if density or "hz" in units or column_indices_by_name(table, {"frequency": SWEPT}):
            kind = "a spectral density" if density else "an FRF, a spectrum or a resonance curve"
            text = f"{kind} over the frequency in the columns {format_column_names(table)}"
            expected = "expected accelerations over time; read_curve reads resonance curves"
            raise InputError(f"{table.path}: {text}; {expected}")
    known = dict.fromkeys(indices, BY_NAME)
    rest = unassigned_columns(table, indices)
    channels = (*rest, *(i for name, i in indices.items() if name != "time"))
    if len({bool(table.columns[i].unit) for i in channels}) != 1:
        return ColumnAssignment(indices, known)
    missing = [name for name in ("box_acceleration", "acceleration1") if name not in indices]
    if len(missing) == len(rest) == 1 and not FORCES.keys() & indices.keys():
        return ColumnAssignment(indices | {missing[0]: rest[0]}, known | {missing[0]: LEFT})
    faces = [name for name in ("acceleration1", "acceleration2") if name not in indices]
    if {"box_acceleration", *FORCES} & indices.keys() and 0 < len(rest) <= len(faces) == 2:
        proposed = dict(zip(faces, rest, strict=False))
        return ColumnAssignment(indices | proposed, known | dict.fromkeys(proposed, BY_ORDER))
    return ColumnAssignment(indices, known)


def column_indices_by_name(table: Columns, names: Mapping[str, str]) -> dict[str, int]:
    """Return the column index of each quantity by its usual names; raise where several have one."""
    plain = [re.sub(r"[\W_]", "", column.name.lower()) for column in table.columns]
    indices = {}
    for name, pattern in names.items():
        fits = [i for i, one in enumerate(plain) if re.fullmatch(pattern, one)]
        fits = [i for i in fits if not table.columns[i].text] or fits
        fits = [i for i in fits if table.columns[i].name == name] or fits
        if len(fits) > 1:
            which = ", ".join(f'"{table.columns[i].name}"' for i in fits)
            text = f"columns {which} may each be {SHORT_NAMES.get(name, name)}"
            raise InputError(f"{table.path}: {text}; expected channels=, which of them is which")
        if fits:
            indices[name] = fits[0]
    return indices


def column_index(table: Columns, wish: str | int) -> int:
    """Return the index of a column that is asked for by name, heading or number."""
    names = [column.name for column in table.columns]
    if wish in names:
        return names.index(str(wish))
    headings = [(column.name, column.unit) for column in table.columns]
    if isinstance(wish, str) and split_heading(wish) in headings:
        return headings.index(split_heading(wish))
    if isinstance(wish, str) and wish.isdecimal():
        wish = int(wish)
    number = isinstance(wish, int) and not isinstance(wish, bool)
    if number and 0 <= int(wish) < len(names):
        return int(wish)
    text = f"expected one of {format_column_names(table)}, or 0 to {len(names) - 1}"
    raise InputError(f"{table.path}: no column {wish!r}; {text}")
