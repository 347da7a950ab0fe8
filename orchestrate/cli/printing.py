"""How commands print a result: its variables by what their attributes say, and tables.

Which variables: ``shows`` and ``summary_lines`` of a command's class.
Sentences that one command prints stand with it.
"""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from .. import units
from ..flags import flag_word, flag_words, runs_of_true
from ..lazy import xr

MOST_WORDS = 4  # of a variable that are counted, the most frequent ones
PARAMETERS = ("eta", "frequency", "level")  # shown in Hz and g unless other units are asked for
SIDES = ("direction", "structure")  # dimensions that are no parameter
HINTS = {  # words of results, alone or of a variable, and what to do
    "no convergence": "Newton's method found no motion beyond, however short the step, as where an "
    "impact or a flight grazes; a shorter --longest, with a larger --most, looks closer",
    "most points": "a larger --most goes on",
    "above_fold: yes": "the averaged theory has no motion below the resonance from its fold on",
    "decision: undecided": "the speed had not settled; give a longer --time",
    "decision: settled at the resonance": "neither passed nor captured",
    "stability: undecided": "runs of the FMU have other impacts: it may not be a motion",
    "multiplicity_decided: undecided": "slow to converge or nearly periodic; --transient 5000 "
    "decides most",
}
COLUMN = re.compile(r"([^ ,+:][^,+:]*)(?:\+(\w+))?(?::([^,]+))?")  # a variable, its error, format

Parts = tuple[str, str, str]  # a name, a number, a unit

# -- variables ------------------------------------------------------------------------------------


def describe(data: xr.Dataset, names: str) -> Iterator[str]:
    """Yield lines on some variables of a result, those that it has, in display units.

    - of words and whole numbers how often each occurs, and where along a parameter,
    - of other numbers over parameters the largest, and where it is,
    - of a motion the range, and over the time the root mean square; none of a mass 2 at a wall.
    """
    parameters = {*data.impacts_per_period.dims} if "impacts_per_period" in data else set()
    left_out = ("x2", "a2") if data.attrs.get("wall") else ()
    known = (name for name in names.split() if name in data and not name.startswith(left_out))
    for array in (data[name] for name in known):
        if not array.notnull().any():
            continue
        unit = str(array.attrs.get("units", "1"))
        if array.ndim and ("flag_meanings" in array.attrs or array.dtype.kind in "iU"):
            yield from count_lines(data, array)
        elif {*array.dims} <= parameters:
            top = data.isel(array.argmax(...))
            value = top[array.name]
            text = flag_word(value) or units.format_quantity(data, value, unit, ".4g")
            if array.name == "xi_rel_max":
                text = format_largest_gap(top)
            dims = map(str, reversed(array.dims))
            where = ", ".join(format_parameter(top, dim, top[dim].item()) for dim in dims)
            yield f"{short_meaning(array)}: {text}{f' at {where}' if where else ''}"
        else:
            ends, root = (float(array.min()), float(array.max())), float((array**2).mean()) ** 0.5
            text = units.format_quantity_range(data, *ends, unit)
            mean = f", rms {units.format_quantity(data, root, unit, '.4g')}"
            yield f"{short_meaning(array)}: {text}{mean if 'time' in array.dims else ''}"


def short_meaning(array: xr.DataArray) -> str:
    if array.name == "xi_rel_max":
        return "largest gap"
    return re.split("[,;:]", str(array.attrs.get("long_name", array.name)))[0]


def count_lines(data: xr.Dataset, array: xr.DataArray) -> Iterator[str]:
    """Yield how often each word or whole number of a variable occurs, where, and what to do."""
    sides, others = [str(d) for d in array.dims if d in SIDES], {*map(str, array.dims)} - {*SIDES}
    along = "".join(others & {*map(str, data.coords)}) if len(others) == 1 else ""
    if along:
        data, array = data.sortby(along), array.sortby(along)
    known = Counter(array.values[array.notnull().values].tolist()).most_common()
    words = flag_words(array.attrs) if "flag_meanings" in array.attrs else {}
    name = str(array.name).replace("_", " ")

    def format_share(count: int) -> str:
        return f"{count:,} ({100.0 * count / array.size:.0f} %)"

    for one, count in known[:MOST_WORDS]:
        word = one if isinstance(one, str) else words.get(int(one), f"{name} {one:g}")
        word = {"yes": name, "no": f"no {name}"}.get(word, word)
        holds = array == one
        line = f"{word}: {format_share(count)}"
        for case in itertools.product(*(holds[dim].values.tolist() for dim in sides)):
            part = holds.sel(dict(zip(sides, case, strict=True)))
            if along and part.any():
                which = "".join(f", {side}" for side in case)
                line += f"{which} at {format_ranges(data, along, part.values, 3)}"
        yield line
        yield from hint_lines([f"{array.name}: {word}"])
    if rest := sum(count for _, count in known[MOST_WORDS:]):
        yield f"another {name}: {format_share(rest)}"


def hint_lines(words: Iterable[str]) -> Iterator[str]:
    """Yield what to do about those words of a result after which more can be done."""
    yield from (f"{word.rpartition(': ')[2]}: {HINTS[word]}" for word in words if word in HINTS)


def impact_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield number and fastest of a motion's impacts, and how many begin permanent contact."""
    count = data.sizes["impact"]
    if not count:
        yield "no impacts"
        return
    first = int(data.impact_velocity.values.argmax())
    speed = units.format_quantity(data, data.impact_velocity[first], "m/s", ".4g")
    hardest = f"at {format_time(data, float(data.impact_time[first]))}"
    if not units.shows_lengths_as_ratios(data):
        hardest = f"{float(data.impulse[first]):.4g} N s {hardest}"
    sticks = int(data.sticks.sum())
    yield f"{count} impacts, the fastest at {speed} ({hardest}); {sticks} begin permanent contact"


# -- tables ---------------------------------------------------------------------------------------


def table_lines(
    data: xr.Dataset,
    names: str,
    form: str = ".6g",
    *,
    prefix: str = "",
    most: int | None = None,
    needs: str = "",
) -> Iterator[str]:
    """Yield the table of some variables: a row for each value of all dimensions of the first one.

    The coordinates of these dimensions come first. Numbers are in display units; a variable may
    have an error and a format of its own: ``"jumps+standard_error:.5f, decided"``. Rows without a
    value of the variable ``needs`` are left out, and those after ``most`` counted.
    """
    columns = COLUMN.findall(names)
    dims = [*map(str, data[prefix + columns[0][0]].dims)]
    columns = [*((dim, "", "") for dim in dims if dim in data.coords), *columns]
    rows = data.stack(line=dims, create_index=False) if dims else data.expand_dims("line")
    rows = rows.transpose("line", ...)
    if needs:
        rows = rows.isel(line=rows[needs].notnull().values)
    cells: dict[str, list[str]] = {}
    for name, error, own in columns:
        title, texts = column_of(rows, name, prefix, error, own or form)
        cells.setdefault(title, texts)
    yield from text_table_lines(cells, most)


def listing_lines(data: xr.Dataset, of: str, names: str) -> Iterator[str]:
    """Yield the table of what a result lists along a dimension, of variables that begin so."""
    if data.sizes.get(of):
        yield f"{of.replace('_', ' ')}s"
        yield from table_lines(data, names, prefix=f"{of}_")
    else:
        yield f"no {of.replace('_', ' ')} in this range"


def text_table_lines(columns: Mapping[str, list[str]], most: int | None = None) -> Iterator[str]:
    rows = list(zip(*columns.values(), strict=True))
    shown = [tuple(columns), *rows[:most]]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    for row in shown:
        cells = (f"{cell:{width}}" for cell, width in zip(row, widths, strict=True))
        yield f"  {'  '.join(cells)}".rstrip()
    if more := len(rows) + 1 - len(shown):
        yield f"  ... and {more} more"


def column_of(
    rows: xr.Dataset, name: str, prefix: str, error: str, form: str
) -> tuple[str, list[str]]:
    """Return title and cells of a variable with a value, or several, for each row."""
    array = rows[prefix + name]
    values = array.values
    if name == "xi_rel_max":
        return "largest gap", [format_largest_gap(rows.isel(line=i)) for i in range(len(values))]
    if name in PARAMETERS and not error:
        parts = [parameter_parts(rows, name, float(one), form) for one in values]
        before, _, unit = parts[0] if parts else (name, "", "")
        title = before or ("frequency" if name == "eta" else name)
        return f"{title} {unit}".rstrip(), [number for _, number, _ in parts]
    factor, word = units.display_scale_and_label(rows, str(array.attrs.get("units", "1")))
    if "flag_meanings" in array.attrs:
        words = flag_words(array.attrs)
        texts = [words[int(value)] for value in values]
    elif array.ndim > 1:
        texts = [", ".join(format(number, form) for number in row) for row in values]
    elif error:
        pairs = zip(values / factor, rows[error].values / factor, strict=True)
        texts = [format_with_error(*pair, form) for pair in pairs]
    elif array.dtype.kind == "f":
        texts = [format(value / factor, form).replace("nan", "") for value in values]
    else:
        texts = [str(value) for value in values]
    return f"{name} {word.replace('SI', '')}".rstrip(), texts


# -- parameters and ranges ------------------------------------------------------------------------


def format_time(data: xr.Dataset, time: float, form: str = ".4g") -> str:
    """Format a time in display units, as tau where a result in ratios was asked in none."""
    if units.shows_lengths_as_ratios(data) and not units.display_units_of(data).time:
        return f"tau = {time:{form}}"
    return units.format_quantity(data, time, "s", form)


def varied_parameter_name(data: xr.Dataset) -> str:
    (name,) = {str(dim) for dim in data.impacts_per_period.dims} - {*SIDES, "attractor"}
    return name


def format_parameter(data: xr.Dataset, name: str, *values: Any, form: str = ".6g") -> str:
    """Format a parameter's value, or both ends of a range, in display units.

    ``12.5 Hz``, ``e = 0.7``, ``12.5 to 13 Hz``, ``e = 0.7 to 0.8``; words as they are.
    """
    if isinstance(values[0], str):
        return values[0]
    parts = [parameter_parts(data, name, float(value), form) for value in values]
    before, _, unit = parts[0]
    numbers = " to ".join(dict.fromkeys(number for _, number, _ in parts))
    return f"{f'{before} = ' if before else ''}{numbers} {unit}".rstrip()


def format_full_range(data: xr.Dataset, name: str) -> str:
    return format_parameter(data, name, data[name].min(), data[name].max())


def parameter_parts(data: xr.Dataset, name: str, value: float, form: str = ".6g") -> Parts:
    """Return a parameter's name (may be empty), formatted value and unit for display."""
    chosen, omega = units.display_units_of(data), units.omega_of(data)
    if name == "eta" and chosen.frequency not in ("", "eta") and math.isfinite(omega):
        name, value = "frequency", value * omega
    if name == "frequency":
        shown = data if chosen.frequency else units.with_units(data, "Hz")
        number, unit = units.format_number_and_unit(shown, value, "rad/s", form)
        return ("eta", number, "") if unit == "eta" else ("", number, unit)
    if name == "level":
        shown = data if chosen.acceleration else units.with_units(data, "g")
        return ("", *units.format_number_and_unit(shown, value, "m/s2", form))
    unit = data[name].attrs.get("units", "1") if name in data.variables else "1"
    return (name, *units.format_number_and_unit(data, value, str(unit), form))


def flag_mask(values: xr.DataArray, word: str) -> xr.DataArray:
    """Return a Boolean array: where a CF flag variable has the number of a word."""
    number = values.attrs["flag_meanings"].split().index(word)
    return values == values.attrs["flag_values"][number]


def format_ranges(data: xr.Dataset, name: str, flags: Any, max_ranges: int = 8) -> str:
    """Format the widest ranges of a dataset's parameter in which flags are true; or nowhere."""
    values, runs = data[name].values, runs_of_true(flags)
    if not runs:
        return "nowhere"
    longest = sorted(sorted(runs, key=lambda run: run[0] - run[1])[:max_ranges])
    before, _, unit = parameter_parts(data, name, float(values[longest[0][0]]))
    texts = []
    for run in longest:
        ends = (parameter_parts(data, name, float(values[i])) for i in dict.fromkeys(run))
        texts.append(" to ".join(number for _, number, _ in ends))
    left = len(runs) - len(longest)
    words = f"{before} = " * bool(before) + ", ".join(texts)
    return f"{words} {unit}".rstrip() + (f" and {left} shorter ranges" if left else "")


def format_largest_gap(data: xr.Dataset) -> str:
    """Format a response's largest gap over a eta^2, as length too if the box's motion is known."""
    ratio, unit = float(data.xi_rel_max), units.unit_of_xi(data)
    length = math.nan if unit is None else ratio * float(unit)
    if not math.isfinite(length) or units.shows_lengths_as_ratios(data):
        return f"xi_Rel = {ratio:.6g}"
    return f"xi_Rel = {ratio:.6g}, {units.format_quantity(data, length, 'm', '.4g')}"


def format_with_error(value: float, error: float, form: str = ".5g") -> str:
    return f"{value:{form}} +- {error:.2g}" if math.isfinite(value) else "none"
