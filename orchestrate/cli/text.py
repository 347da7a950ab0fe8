"""Format what commands print: parameters, ranges, counts, tables of a result's variables."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from ..flags import flag_words, runs_of
from ..lazy import xr
from ..units import (
    as_shown,
    is_in_ratios,
    length_of_ratio,
    omega_of,
    range_text,
    scale_of,
    shown_number,
    text_of,
    units_of,
    with_units,
)

LENGTHS = ("m", "m/s", "m/s2")
MOST_ROWS = 10  # of a table that is printed
Columns = dict[str, list[str]]  # of a table: cells by title

# -- tables ---------------------------------------------------------------------------------------


def table(columns: Mapping[str, Iterable[str]], most: int = MOST_ROWS) -> Iterator[str]:
    """Yield the lines of a table, titles first, at most as many rows."""
    rows = list(zip(*columns.values(), strict=True))
    shown = [tuple(columns), *rows[:most]]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    for row in shown:
        cells = (f"{cell:{width}}" for cell, width in zip(row, widths, strict=True))
        yield f"  {'  '.join(cells)}".rstrip()
    if len(rows) > most:
        yield f"  ... and {len(rows) - most} more"


def columns_of(data: xr.Dataset, names: str, prefix: str = "", form: str = ".6g") -> Columns:
    """Return columns of variables along one dimension, in display units."""
    columns: Columns = {}
    for name in names.split():
        array = data[prefix + name]
        values, unit = array.values, str(array.attrs.get("units", "1"))
        factor, word = scale_of(data, unit)
        title = f"{name} {word}" if word not in ("1", "SI") else name
        if "flag_meanings" in array.attrs:
            words = flag_words(array.attrs)
            columns[title] = [words[int(value)] for value in values]
        elif array.ndim > 1:
            columns[title] = [",".join(f"{number:.6g}" for number in row) for row in values]
        elif array.dtype.kind == "f":
            columns[title] = [format(value / factor, form) for value in values]
        else:
            columns[title] = [str(value) for value in values]
    return columns


def parameter_column(data: xr.Dataset, name: str, values: Any, form: str = ".6g") -> Columns:
    """Return the column of a parameter's values in display units."""
    parts = [parameter_parts(data, name, float(value), form) for value in values]
    before, _, unit = parts[0] if parts else (name, "", "")
    title = f"{before or ('frequency' if name == 'eta' else name)} {unit}".rstrip()
    return {title: [number for _, number, _ in parts]}


def extents(data: xr.Dataset, names: str) -> Iterator[str]:
    """Yield the range of each named variable, in display units, by what it is."""
    for name in names.split():
        array = data[name]
        if array.size:
            low, high = float(array.min()), float(array.max())
            unit = str(array.attrs.get("units", "1"))
            meaning = str(array.attrs.get("long_name", name)).partition(",")[0]
            text = without_unit(data, range_text(data, low, high, unit), unit)
            yield f"{meaning}: {text.removesuffix(' 1')}"


def without_unit(data: xr.Dataset, text: str, unit: str) -> str:
    """Return a text without its unit of length where a result has the paper's ratios."""
    return text.removesuffix(f" {unit}") if unit in LENGTHS and is_in_ratios(data) else text


def length_text(data: xr.Dataset, value: float | xr.DataArray, unit: str, form: str = ".6g") -> str:
    """Format a length, speed or acceleration in display units; as a ratio without one."""
    return without_unit(data, text_of(data, value, unit, form), unit)


def time_text(data: xr.Dataset, time: float, form: str = ".4g") -> str:
    """Format a time in display units, as tau where a result in ratios was asked in none."""
    if is_in_ratios(data) and not units_of(data).time:
        return f"tau = {time:{form}}"
    return text_of(data, time, "s", form)


def table_of_one(data: xr.Dataset, name: str) -> Iterator[str]:
    """Yield all variables of a result at one parameter value as a table."""
    yield f"one value, {format_parameter(data, name, float(data[name][0]))}: a table and no picture"
    shown, order = as_shown(data.isel({name: 0})), {"structure", "direction"} & {*data.dims}
    arrays = {key: one for key, one in shown.data_vars.items() if {*one.dims} <= order}
    columns = {"": [str(key) for key in arrays]}
    for case in itertools.product(*(data[dim].values.tolist() for dim in sorted(order)[::-1])):
        at = dict(zip(sorted(order)[::-1], case, strict=True))
        cells = [float(one.sel({dim: at[str(dim)] for dim in one.dims})) for one in arrays.values()]
        columns[" ".join(case) or "value"] = [f"{cell:.6g}" for cell in cells]
    units = (str(one.attrs.get("units", "1")).removeprefix("1") for one in arrays.values())
    yield from table(columns | {"unit": [*units]}, len(arrays))


def impact_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield number and fastest of a motion's impacts, and how many begin permanent contact."""
    count = data.sizes["impact"]
    if not count:
        yield "no impacts"
        return
    first = int(data.impact_velocity.values.argmax())
    speed = length_text(data, data.impact_velocity[first], "m/s", ".4g")
    hardest = f"at {time_text(data, float(data.impact_time[first]))}"
    if not is_in_ratios(data):
        hardest = f"{float(data.impulse[first]):.4g} N s {hardest}"
    sticks = int(data.sticks.sum())
    yield f"{count} impacts, the fastest at {speed} ({hardest}); {sticks} begin permanent contact"


def attractor_table(data: xr.Dataset) -> Iterator[str]:
    """Yield a table of attractors: share, period, impacts, gap, how decided, a state."""
    data = data.isel(attractor=data.multiplicity.notnull().values)
    gaps = [format_largest_gap(data.isel(attractor=i)) for i in range(data.sizes["attractor"])]
    names = "share multiplicity impacts_per_period decided_by"
    columns = {"number": [str(number) for number in data.attractor.values]}
    columns |= columns_of(data, names, form=".4g") | {"largest gap": gaps}
    (state,) = columns_of(data, "state").values()
    unit = "" if is_in_ratios(data) else " (SI)"
    yield from table(columns | {f"state at phase 0{unit}": state})


ENDS = {  # of a branch, beyond which there may be more of it: what was tried, and what to do
    "no convergence": "Newton's method found no motion beyond, however short the step, as where an "
    "impact or a flight grazes; a shorter --longest, with a larger --most, looks closer",
    "most points": "a larger --most goes on",
}


def end_lines(ends: Collection[str]) -> Iterator[str]:
    """Yield what to do about those ends of branches that need not be one."""
    yield from (f"{end}: {text}" for end, text in ENDS.items() if end in ends)


# -- parameters and ranges ------------------------------------------------------------------------


def varied_parameter(data: xr.Dataset) -> str:
    """Return the name of the parameter along which a result lies."""
    others = {"direction", "structure", "attractor"}
    (name,) = {str(dim) for dim in data.impacts_per_period.dims} - others
    return name


def format_parameter(
    data: xr.Dataset, name: str, value: float | xr.DataArray, form: str = ".6g"
) -> str:
    """Format a parameter's value in display units: ``12.5 Hz``, ``e = 0.7``."""
    before, number, unit = parameter_parts(data, name, float(value), form)
    return f"{before} = {number} {unit}".rstrip() if before else f"{number} {unit}"


def format_range(data: xr.Dataset, name: str, low: float, high: float) -> str:
    """Format a range of a parameter in display units: ``12.5 to 13 Hz``, ``e = 0.7 to 0.8``."""
    before, first, unit = parameter_parts(data, name, low)
    last = parameter_parts(data, name, high)[1]
    numbers = first if first == last else f"{first} to {last}"
    return f"{before} = {numbers} {unit}".rstrip() if before else f"{numbers} {unit}"


def parameter_parts(
    data: xr.Dataset, name: str, value: float, form: str = ".6g"
) -> tuple[str, str, str]:
    """Return a parameter's name (may be empty), formatted value and unit for display."""
    units, omega = units_of(data), omega_of(data)
    if name == "eta" and units.frequency not in ("", "eta") and math.isfinite(omega):
        name, value = "frequency", value * omega
    if name == "frequency":
        shown = data if units.frequency else with_units(data, "Hz")
        number, unit = shown_number(shown, value, "rad/s", form)
        return ("eta", number, "") if unit == "eta" else ("", number, unit)
    if name == "level":
        shown = data if units.acceleration else with_units(data, "g")
        return ("", *shown_number(shown, value, "m/s2", form))
    return (name, *shown_number(data, value, unit_of(data, name), form))


def unit_of(data: xr.Dataset, name: str) -> str:
    """Return the SI unit of a dataset's parameter; empty where it has none."""
    unit = str(data[name].attrs.get("units", "")) if name in data.variables else ""
    return unit.removeprefix("1")


def flag_word(value: xr.DataArray) -> str:
    """Return the word of a scalar CF flag variable."""
    return flag_words(value.attrs)[int(value)]


def has_flag(values: xr.DataArray, word: str) -> xr.DataArray:
    """Return a Boolean array: where a CF flag variable has the number of a word."""
    number = values.attrs["flag_meanings"].split().index(word)
    return values == values.attrs["flag_values"][number]


def format_ranges(data: xr.Dataset, name: str, flags: Any, max_ranges: int = 8) -> str:
    """Format the widest ranges of a dataset's parameter in which flags are true."""
    values, runs = data[name].values, runs_of(flags)
    longest = sorted(sorted(runs, key=lambda run: run[0] - run[1])[:max_ranges])
    ends = [
        [parameter_parts(data, name, float(values[i])) for i in dict.fromkeys(run)]
        for run in longest
    ]
    before, _, unit = ends[0][0] if ends else ("", "", "")
    text = ", ".join(" to ".join(number for _, number, _ in run) for run in ends)
    left = len(runs) - len(longest)
    words = f"{before} = {text}" if before else text
    return f"{words} {unit}".rstrip() + (f" and {left} shorter ranges" if left else "")


def format_share(count: int, whole: int, word: str = "") -> str:
    number = f"{count:,} {word}".rstrip()
    return f"{number} ({100.0 * count / whole:.0f} %)"


def format_largest_gap(data: xr.Dataset, form: str = ".6g") -> str:
    """Format a response's largest gap over a eta^2, as length too if the box's motion is known."""
    ratio, length = float(data.xi_rel_max), length_of_ratio(data)
    parts = [f"xi_Rel = {ratio:{form}}"]
    if length is not None and math.isfinite(float(length)) and not is_in_ratios(data):
        parts.append(text_of(data, ratio * float(length), "m", ".4g"))
    return ", ".join(parts)
