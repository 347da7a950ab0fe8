"""Report sections of any result: its picture, its numbers, its signs, and where it comes from."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Sequence
from contextlib import suppress
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
    title, scalars, parameters = title_of(answer), [], []
    for key, array in in_display_units(answer).data_vars.items():
        if not array.dims and array.dtype.kind in "iufb":
            text = format_number(float(array), str(array.attrs.get("units", "")), 5)
            meaning = str(array.attrs.get("long_name", ""))
            scalars.append((str(key), meaning, flag_word(array) or text))
    for name, quantity in {**STRUCTURE, **EXCITATION}.items():
        if name in answer.attrs and not isinstance(answer.attrs[name], str):
            factor, unit = display_scale_of(answer, quantity.unit)
            value = float(answer.attrs[name]) / factor
            text = format_number(value, OVER_OMEGA if unit == "eta" else unit, 6)
            parameters.append((name, quantity.description, text))
    named = (("name", scalars[:60]), ("parameter", parameters))
    tables = [Table((head, "what it is", "value"), rows) for head, rows in named if rows]
    try:
        return Section(title, picture=plot(answer), caption=title, tables=tables)
    except InputError:
        return Section(title, tables=tables)


def signs_section(answer: xr.Dataset) -> Section:
    known = [answer.sel(sign=sign) for sign in answer.sign.values]
    known = [one for one in known if bool((one.exceeds >= 0).any())]
    rows = []
    for one in known:
        sensors = (one[name].values for name in ("value", "floor", "sound_highest"))
        numbers = (" · ".join(map(format_number, values)) for values in sensors)
        stands_out = " · ".join(WORDS[int(number)] for number in one.exceeds.values)
        rows.append((str(one.meaning.values), *numbers, stands_out))
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


def origin_section(answers: Sequence[xr.Dataset]) -> Section:
    rows: list[tuple[str, str]] = []
    for number, answer in enumerate(answers, 1):
        known = {str(name): str(text) for name, text in answer.attrs.items()}
        texts = [(label, known[name]) for name, label in ORIGIN.items() if known.get(name)]
        if "history" in known:
            texts.append(("computed on", known["history"].partition(": ")[0]))
        if "call" in known and known.get("analysis") not in BY_RECORD:
            texts.append(("what was asked", known["call"]))
        for name in sorted(known):
            if name.startswith("fmu_guid"):
                model = known.get(name.replace("guid", "model"), "")
                texts.append((f"FMU {model}".rstrip(), known[name]))
        if "identity" in known:
            digest = hashlib.sha256(known["identity"].encode()).hexdigest()[:16]
            texts.append(("identity of question, FMU and code", digest))
        begin = f"{number}. " if len(answers) > 1 else ""
        for label, text in texts:
            rows.append((begin + label, text[:LONGEST] + " ..." * (len(text) > LONGEST)))
    versions = [f"Python {platform.python_version()}"]
    for name in PACKAGES:
        with suppress(PackageNotFoundError):
            versions.append(f"{name} {version(name)}")
    rows.append(("versions", ", ".join(versions)))
    table = Table(("what", "value"), rows)
    return Section("Where it comes from", tables=[table], place="appendix")
