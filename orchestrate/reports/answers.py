"""Report sections of any result: its picture, its scalar numbers, its signs."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..errors import InputError
from ..figures.labels import title_without_structure
from ..figures.plot import function_name, plot
from ..units import OVER_OMEGA, as_shown, scale_of
from .page import Picture, Section, Table, format_number
from .verdict import verdict_sections

if TYPE_CHECKING:
    import xarray as xr

WORDS = {-1: "not in this record", 0: "no", 1: "yes"}
MOST_ROWS = 60


def result_sections(answer: xr.Dataset) -> list[Section]:
    """Return all report sections of a result."""
    kind = function_name(answer)
    if kind == "detect":
        return verdict_sections(answer)
    if kind == "signs":
        return [signs_section(answer)]
    return [picture_section(answer)]


def draw_result(answer: xr.Dataset, words: str) -> Picture | None:
    """Return the picture of a result for the page; None if there is none of its kind."""
    try:
        return Picture.from_figure(plot(answer), words)
    except InputError:
        return None


def title_of(answer: xr.Dataset) -> str:
    """Return a result's title as a heading; pictures and tables tell of its structure."""
    return title_without_structure(str(answer.attrs.get("title") or function_name(answer)))


def picture_section(answer: xr.Dataset) -> Section:
    """Return a section with a result's picture and scalar numbers."""
    title = title_of(answer)
    tables = [table for table in (scalar_table(answer), parameter_table(answer)) if table.rows]
    return Section(title, picture=draw_result(answer, title), tables=tables)


def scalar_table(answer: xr.Dataset) -> Table:
    """Return a table of all scalar variables of a result."""
    rows = []
    for name, array in as_shown(answer).data_vars.items():
        if not array.dims and array.dtype.kind in "iufb":
            value = format_number(float(array), str(array.attrs.get("units", "")), 5)
            rows.append(
                (str(name), str(array.attrs.get("long_name", "")), flag_word(array) or value)
            )
    return Table(("name", "what it is", "value"), rows[:MOST_ROWS])


def flag_word(array: xr.DataArray) -> str:
    """Return the word that a scalar flag variable stands for; empty if it is no flag."""
    words = str(array.attrs.get("flag_meanings", "")).split()
    numbers = [int(number) for number in array.attrs.get("flag_values", [])]
    return words[numbers.index(int(array))] if words and int(array) in numbers else ""


def parameter_table(answer: xr.Dataset) -> Table:
    """Return a table of structure and excitation, from a result's attributes."""
    from ..structures.ranges import EXCITATION, STRUCTURE

    known = {**STRUCTURE, **EXCITATION}
    rows = []
    for name, quantity in known.items():
        if name in answer.attrs and not isinstance(answer.attrs[name], str):
            factor, unit = scale_of(answer, quantity.unit)
            value = float(answer.attrs[name]) / factor
            shown = OVER_OMEGA if unit == "eta" else unit
            rows.append((name, quantity.description, format_number(value, shown, 6)))
    return Table(("parameter", "what it is", "value"), rows)


def is_known(one: xr.Dataset) -> bool:
    """Return whether a sign's verdict is known for any sensor."""
    return bool((one.exceeds >= 0).any())


def format_sensors(values: Iterable[float]) -> str:
    """Format one number per sensor for a table's cell."""
    return " · ".join(format_number(float(value)) for value in values)


def signs_section(answer: xr.Dataset) -> Section:
    """Return a section on signs: values, noise floors, and other causes of those that stand out."""
    shown = [one for sign in answer.sign.values if is_known(one := answer.sel(sign=sign))]
    rows = [
        (
            str(one.meaning.values),
            *(format_sensors(one[name].values) for name in ("value", "floor", "sound_highest")),
            " · ".join(WORDS[int(number)] for number in one.exceeds.values),
        )
        for one in shown
    ]
    marked = [number for number, one in enumerate(shown) if bool((one.exceeds == 1).any())]
    columns = ("sign", "value", "noise alone", "sound structure", "stands out")
    moved = [
        f"{one.meaning.values}: {one.formula.values} ({one.source.values}). "
        f"Also moved by: {one.moved_by.values}."
        for one in (shown[number] for number in marked)
    ]
    both = ", for sensor 1 and sensor 2" if answer.sizes["channel"] > 1 else ""
    text = (
        "A sign stands out where it is above twice what noise and a sound structure with the same "
        "noise show. Signs know nothing of the model; each is moved by other things too. "
        f"Numbers have no unit{both}."
    )
    origin = f"Noise from {answer.attrs.get('noise_from', 'the record')}; sound structure: "
    origin += f"{answer.attrs.get('sound_from', '')}, seeds {answer.attrs.get('seeds', '')}."
    return Section(
        "Signs that need no model",
        [text, origin],
        moved,
        draw_result(answer, "Signs of the record over what noise and a sound structure show"),
        [Table(columns, rows, frozenset(marked))],
    )
