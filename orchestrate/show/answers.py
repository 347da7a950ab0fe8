"""Report sections of any result: its picture, its numbers, its signs, and where it comes from."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version

from ..errors import InputError
from ..flags import flag_word
from ..lazy import xr
from ..model.ranges import EXCITATION, STRUCTURE
from ..units import OVER_OMEGA, display_scale_of, in_display_units
from .kinds import require_kind
from .labels import expand_title
from .page import Section, Table, format_number
from .plot import plot

WORDS = {-1: "not in this record", 0: "no", 1: "yes"}
MOVED = "{0.meaning.values}: {0.formula.values} ({0.source.values}). Also moved by: "
MOVED += "{0.moved_by.values}."
PACKAGES = ("numpy", "scipy", "xarray", "fmpy", "matplotlib")
BY_RECORD = ("detect", "fit")  # their question is the record, which has a digest
LONGEST = 160  # letters of an attribute
ORIGIN = {  # attributes, and what a reader calls them
    "title": "title",
    "record_file": "record",
    "record_sha256": "SHA-256 of the record",
    "guess_file": "guess",
    "sensors": "sensors",
    "source": "computed by",
}


def title_of(answer: xr.Dataset) -> str:
    return expand_title(
        str(answer.attrs.get("title") or require_kind(answer)), with_structure=False
    )


def answer_section(answer: xr.Dataset) -> Section:
    title = title_of(answer)
    tables = [table for table in (scalar_table(answer), parameter_table(answer)) if table.rows]
    try:
        return Section(title, picture=plot(answer), caption=title, tables=tables)
    except InputError:
        return Section(title, tables=tables)


def scalar_table(answer: xr.Dataset) -> Table:
    rows = []
    for name, array in in_display_units(answer).data_vars.items():
        if not array.dims and array.dtype.kind in "iufb":
            value = format_number(float(array), str(array.attrs.get("units", "")), 5)
            meaning = str(array.attrs.get("long_name", ""))
            rows.append((str(name), meaning, flag_word(array) or value))
    return Table(("name", "what it is", "value"), rows[:60])


def parameter_table(answer: xr.Dataset) -> Table:
    rows = []
    for name, quantity in {**STRUCTURE, **EXCITATION}.items():
        if name in answer.attrs and not isinstance(answer.attrs[name], str):
            factor, unit = display_scale_of(answer, quantity.unit)
            value = float(answer.attrs[name]) / factor
            shown = OVER_OMEGA if unit == "eta" else unit
            rows.append((name, quantity.description, format_number(value, shown, 6)))
    return Table(("parameter", "what it is", "value"), rows)


def signs_section(answer: xr.Dataset) -> Section:
    known = [answer.sel(sign=sign) for sign in answer.sign.values]
    known = [one for one in known if bool((one.exceeds >= 0).any())]
    rows = [
        (
            str(one.meaning.values),
            *(
                format_values_by_sensor(one[name].values)
                for name in ("value", "floor", "sound_highest")
            ),
            " · ".join(WORDS[int(number)] for number in one.exceeds.values),
        )
        for one in known
    ]
    marked = [number for number, one in enumerate(known) if bool((one.exceeds == 1).any())]
    columns = ("sign", "value", "by noise", "sound structure", "stands out")
    moved = [MOVED.format(known[number]) for number in marked]
    both = ", for sensor 1 and sensor 2" if answer.sizes["channel"] > 1 else ""
    text = (
        "A sign stands out where it is above twice what noise and a sound structure with the same "
        "noise show. Indicators do not use the model; each also has other causes. "
        f"Numbers have no unit{both}. "
        f"Noise from {answer.attrs.get('noise_from', 'the record')}; sound structure: "
        f"{answer.attrs.get('sound_from', '')}, seeds {answer.attrs.get('seeds', '')}."
    )
    caption = "Signs of the record over what noise and a sound structure show"
    table = Table(columns, rows, frozenset(marked))
    return Section("Signs that need no model", [text], moved, plot(answer), caption, [table])


def format_values_by_sensor(values: Iterable[float]) -> str:
    return " · ".join(format_number(float(value)) for value in values)


def origin_section(answers: Sequence[xr.Dataset]) -> Section:
    rows: list[tuple[str, str]] = []
    for number, answer in enumerate(answers, 1):
        begin = f"{number}. " if len(answers) > 1 else ""
        rows += [(begin + name, text) for name, text in describe_origin(answer)]
    found = {name: installed_version(name) for name in PACKAGES}
    versions = [f"{name} {number}" for name, number in found.items() if number]
    rows.append(("versions", ", ".join([f"Python {platform.python_version()}", *versions])))
    table = Table(("what", "value"), rows)
    return Section("Where it comes from", tables=[table], place="appendix")


def describe_origin(answer: xr.Dataset) -> list[tuple[str, str]]:
    attributes = {str(name): str(text) for name, text in answer.attrs.items()}
    rows = [(label, attributes[name]) for name, label in ORIGIN.items() if attributes.get(name)]
    if "history" in attributes:
        rows.append(("computed on", attributes["history"].partition(": ")[0]))
    if "call" in attributes and attributes.get("analysis") not in BY_RECORD:
        rows.append(("what was asked", attributes["call"]))
    for name in sorted(attributes):
        if name.startswith("fmu_guid"):
            model = attributes.get(name.replace("guid", "model"), "")
            rows.append((f"FMU {model}".rstrip(), attributes[name]))
    if "identity" in attributes:
        digest = hashlib.sha256(attributes["identity"].encode()).hexdigest()[:16]
        rows.append(("identity of question, FMU and code", digest))
    cut = {name: f"{text[:LONGEST]} ..." for name, text in rows if len(text) > LONGEST}
    return [(name, cut.get(name, text)) for name, text in rows]


def installed_version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
