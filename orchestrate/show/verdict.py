"""Report sections of a verdict on a beam: statement, evidence, fits, parameters."""

from __future__ import annotations

import math

import numpy as np

from ..constants import TURN
from ..lazy import xr
from ..units import display_scale_of, display_units_of, with_units
from .diagnosis import PARTED, draw_misfit, draw_orders_and_fits
from .page import MISSING, Section, Table, Verdict, format_number, format_with_error

TONES = {"delaminated": "bad", "no opening seen": "good", "not described": "unclear"}
ALWAYS_ASSUMED = (
    "Two masses stand for the beam: waves and higher modes are left out.",
    "Impacts take no time and lose energy by one number e.",
)
NAMES_OF_CHANNELS = (
    "Base is what the beam is fastened to, the shaker's table or a clamp; its acceleration is "
    "called box_acceleration in Python and in files of this package. Face 1 and face 2 are the "
    "outer faces of both halves, with sensor 1 and sensor 2: acceleration1 and acceleration2."
)


def make_verdict(answer: xr.Dataset) -> Verdict:
    word = str(answer.verdict.values)
    sentences = {
        "delaminated": delaminated_statement(answer),
        "no opening seen": no_opening_statement(answer),
        "not described": (
            "None of the structures that were tried, sound or delaminated, describes this record: "
            "the beam, its clamp or the sensors do something else."
        ),
        "undecided": "This record does not tell a delaminated beam from a sound one.",
    }
    statement = sentences[word]
    texts = []
    for best in fits_with_values(answer)[:1]:
        for name in best.parameter.values[best.unit.values == "Hz"]:
            text = format_fitted_value(best.sel(parameter=name), "Hz")
            texts += [f"{name} = {text}"] if text != MISSING else []
    if texts:
        statement += f" Natural frequencies fitted: {', '.join(texts)}."
    if wiring := answer.attrs.get("wiring"):
        statement = f"The wiring is doubtful: {wiring}. As it is: {statement}"
    return Verdict(make_sentence(word), statement, TONES.get(word, "open"))


def delaminated_statement(answer: xr.Dataset) -> str:
    level = base_level_text(answer, scalar_or_nan(answer, "opening_level"))
    lowest = f" from {level} on" if level else ""
    times = scalar_or_nan(answer, "ratio") if fits_with_values(answer) else math.nan
    closer = f": {format_number(times)} times closer to the record than any sound beam"
    sized = f" Two masses size it{closer}." if math.isfinite(times) else ""
    return f"The record is that of two halves that part and strike each other{lowest}.{sized}"


def no_opening_statement(answer: xr.Dataset) -> str:
    """Return the statement for no opening seen; it never says that the beam is intact."""
    smallest = scalar_or_nan(answer, "smallest_opening")
    seen = ""
    if math.isfinite(smallest):
        shown = answer if display_units_of(answer).length else with_units(answer, "um")
        factor, unit = display_scale_of(shown, "m")
        opening = f"{format_number(smallest / factor)} {unit.replace('um', 'µm')}"
        seen = (
            f" Faces at the sensor that part by {opening} or more would have been seen; away from "
            "it an opening may be larger."
        )
    level = base_level_text(answer, scalar_or_nan(answer, "level_high"))
    ends = scalar_or_nan(answer, "frequency_low"), scalar_or_nan(answer, "frequency_high")
    covered = f"up to {level} over {frequency_range_text(answer, *ends)}"
    return f"No opening of the faces was seen {covered}.{seen}"


def scalar_or_nan(answer: xr.Dataset, name: str) -> float:
    """Return a scalar variable of a result by its name; NaN if the result lacks it."""
    return float(answer[name]) if name in answer else math.nan


def verdict_sections(answer: xr.Dataset) -> list[Section]:
    reason, settle = (str(answer.attrs.get(name, "")) for name in ("reason", "settle"))
    points = [f"What decided: {make_sentence(reason)}"] if reason else []
    if settle:
        points.append(f"What would change or settle it: {make_sentence(settle)}")
    sections: list[Section | None] = [Section("Why", points=points, place="front")]
    if "measured" in answer and "fitted" in answer:
        picture = draw_orders_and_fits(answer.assign_attrs(title=""))
        picture.set_size_inches(max(7.6, 0.7 * picture.get_figwidth()), 4.0)  # near that on paper
        words = "What was measured, and what the best structures of each kind do, order by order."
        heading = "The measurement over the fits"
        sections.append(Section(heading, picture=picture, caption=words, place="front"))
    makers = (record_section, parameter_section, misfit_section, assumption_section)
    sections += [section_of(answer) for section_of in makers]
    return [section for section in sections if section is not None]


def record_section(answer: xr.Dataset) -> Section | None:
    words = {str(name): str(text) for name, text in answer.attrs.items()}
    unit = words.get("record_unit", "").replace("m/s2", "m/s²")
    levels = scalar_or_nan(answer, "level_low"), scalar_or_nan(answer, "level_high")
    rows = [
        ("file of the record", words.get("record_file", "")),
        ("columns of the file", words.get("record_columns", "")),
        ("sensors", words.get("sensors", "")),
        ("participation of the sensors", participation_text(answer)),
        ("unit of its numbers", words.get("record_unit_note", "") or unit),
        ("converted", words.get("record_converted", "")),
        ("times", words.get("record_time_base", "")),
        ("sampling rate", number_text(answer, "sample_rate", "Hz", 6)),
        ("duration", number_text(answer, "record_duration", "s", 4)),
        ("sweep", sweep_text(answer)),
        ("level of the base, peak", base_level_text(answer, *levels)),
        ("file of the guess", words.get("guess_file", "")),
        ("command that made it", words.get("command", "")),
    ]
    known = [row for row in rows if row[1]]
    if not known:
        return None
    return Section("The record", tables=[Table(("what", "value"), known)], place="front")


def participation_text(answer: xr.Dataset) -> str:
    """Format the sensors' participation factors of the best stated fit; empty where none is."""
    if "participation" not in answer:
        return ""
    stated = answer.where(answer.participation.notnull().any("channel"), drop=True)
    if not stated.sizes["hypothesis"]:
        return ""
    best = stated.isel(hypothesis=int(np.argmin(stated.misfit.values)))
    pairs = zip(best.participation.values, best.participation_error.values, strict=True)
    return ", ".join(format_with_error(value, error) for value, error in pairs)


def number_text(answer: xr.Dataset, name: str, unit: str, digits: int) -> str:
    value = scalar_or_nan(answer, name)
    return format_number(value, unit, digits) if math.isfinite(value) else ""


def sweep_text(answer: xr.Dataset) -> str:
    low, high = scalar_or_nan(answer, "sweep_low"), scalar_or_nan(answer, "sweep_high")
    if not math.isfinite(low + high):
        return ""
    direction = {"up": "upwards", "down": "downwards", "up and down": "up and down"}
    way = direction.get(str(answer.attrs.get("direction", "")), "")
    whole = f"{frequency_range_text(answer, low, high)} {way}".rstrip()
    if "frequency" not in answer.coords:
        return whole
    ends = float(answer.frequency.min()), float(answer.frequency.max())
    return f"{whole}; compared with models: {frequency_range_text(answer, *ends)}"


def frequency_range_text(answer: xr.Dataset, low: float, high: float) -> str:
    turn, word = display_scale_of(answer, "Hz")
    first, last = (format_number(end / turn, digits=4) for end in (low, high))
    return f"{first} to {last} {'Omega/omega' if word == 'eta' else word}"


def base_level_text(answer: xr.Dataset, *levels: float) -> str:
    """Format levels of the base in the unit that was asked for; empty where one is not known."""
    felt, unit = display_scale_of(answer, "m/s2")
    numbers = " to ".join(format_number(level / felt) for level in levels)
    return f"{numbers} {unit.replace('m/s2', 'm/s²')}" if all(map(math.isfinite, levels)) else ""


def make_sentence(words: str) -> str:
    return f"{words[:1].upper()}{words[1:].rstrip('.')}."


def misfit_section(answer: xr.Dataset) -> Section | None:
    if "misfit_at" not in answer:
        return None
    columns, rows = ("structure", "misfit", "distinct fits", "motions computed"), []
    for one in fits_by_misfit(answer):
        minima = f"{int(np.isfinite(one.minima).sum())}" if "minima" in one else MISSING
        computed = format_number(scalar_or_nan(one, "evaluations"), digits=6)
        misfit = format_number(float(one.misfit))
        rows.append((str(one.hypothesis.values), misfit, minima, computed))
    # the best fit on which the verdict rests stands out
    parted = {"delaminated": True, "no opening seen": False}.get(str(answer.verdict.values))
    deciding = [i for i, row in enumerate(rows) if row[0].startswith(PARTED) == parted][:1]
    text = (
        "The misfit is the distance of a structure's motion from the measured one. It is 1 where "
        "they differ by as much as noise and the usual error of a good model explain."
    )
    return Section(
        "Where the structures differ from the measurement",
        [text],
        picture=draw_misfit(answer),
        caption="Misfit of each structure over the frequency of the excitation",
        tables=[Table(columns, rows, frozenset(deciding))],
        place="appendix",
    )


def parameter_section(answer: xr.Dataset) -> Section | None:
    if not (shown := fits_with_values(answer)[:3]):
        return None
    names = [str(one.hypothesis.values) if "hypothesis" in one.coords else "value" for one in shown]
    rows = []
    for name in map(str, answer.parameter.values):
        about = answer.sel(parameter=name)
        unit, words = str(about.unit.values), f"{name}, {about.meaning.values}"
        texts = [format_fitted_value(one.sel(parameter=name), unit) for one in shown]
        if any(text != MISSING for text in texts):
            rows.append((words, *texts))
    text = (
        "Errors are standard errors from blocks of the record and from what the structure misses. "
        f"What a structure does not have, or the record does not hold, has a dash ({MISSING})."
    )
    table = Table(("parameter", *names), rows)
    return Section("Parameters", [text], tables=[table], place="appendix") if rows else None


def fits_with_values(answer: xr.Dataset) -> list[xr.Dataset]:
    if "value" not in answer or "parameter" not in answer.dims:
        return []
    return [one for one in fits_by_misfit(answer) if np.isfinite(one.value).any()]


def fits_by_misfit(answer: xr.Dataset) -> list[xr.Dataset]:
    if "hypothesis" not in answer.dims:
        return [answer]
    ordered = answer.sortby("misfit")
    return [ordered.isel(hypothesis=position) for position in range(ordered.sizes["hypothesis"])]


def format_fitted_value(at: xr.Dataset, unit: str) -> str:
    factor, word = display_scale_of(at, unit)
    if word == "eta":  # a half's own frequency is no ratio to itself
        factor, word = 1.0, unit
    value, error = float(at.value) / factor, scalar_or_nan(at, "standard_error") / factor
    return format_with_error(value, error, word) if math.isfinite(value) else MISSING


def assumption_section(answer: xr.Dataset) -> Section:
    own = [text.strip() for text in str(answer.attrs.get("assumed", "")).split(";")]
    points = list(ALWAYS_ASSUMED)
    m1, m2, k1, k2 = (float(answer.attrs.get(x, math.nan)) for x in ("m1", "m2", "k1", "k2"))
    if min(m1, m2, k1, k2) > 0.0:  # the guess with which the search began
        masses = " and ".join(format_number(m, "kg") for m in (m1, m2))
        halves = (math.sqrt(k1 / m1) / TURN, math.sqrt(k2 / m2) / TURN)
        frequencies = " and ".join(format_number(f, "Hz") for f in halves)
        points.append(
            f"Guessed of both halves: masses of {masses}, which were kept, and {frequencies}."
        )
    points += map(make_sentence, filter(None, own))
    return Section("What was assumed", [NAMES_OF_CHANNELS], points, place="appendix")
