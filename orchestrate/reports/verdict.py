"""Report sections of a verdict on a beam: statement, evidence, fits, parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..constants import TURN
from ..figures.diagnosis import PARTED, draw_detect, draw_misfit
from ..units import scale_of, units_of, with_units
from .page import MISSING, Picture, Section, Table, Verdict, format_number, format_with_error

if TYPE_CHECKING:
    import xarray as xr

TONES = {"delaminated": "bad", "no opening seen": "good", "not described": "unclear"}
ALWAYS_ASSUMED = (
    "Two masses stand for the beam: waves and higher modes are left out.",
    "Impacts take no time and lose energy by one number e.",
)
WORTH = (
    "This page is the result of a calculation on one record. It is no certificate, for flight or "
    "for anything else. Faces that are pressed together, or glued in part, may be delaminated and "
    "not open in a test."
)
NAMES_OF_CHANNELS = (
    "Base is what the beam is fastened to, the shaker's table or a clamp; its acceleration is "
    "called box_acceleration in Python and in files of this package. Face 1 and face 2 are the "
    "outer faces of both halves, with sensor 1 and sensor 2: acceleration1 and acceleration2."
)
BEST = 3  # hypotheses in the table of parameters


def make_verdict(answer: xr.Dataset) -> Verdict:
    """Return the verdict of a ``detect`` result: its word and one sentence."""
    word = str(answer.verdict.values)
    return Verdict(
        f"{word[0].upper()}{word[1:]}.", SENTENCES[word](answer), TONES.get(word, "open")
    )


def format_range(answer: xr.Dataset) -> str:
    """Format the levels and frequencies that the record covers."""
    felt, unit = scale_of(answer, "m/s2")
    level = f"{format_number(scalar(answer, 'level_high') / felt)} {unit.replace('m/s2', 'm/s²')}"
    ends = scalar(answer, "frequency_low"), scalar(answer, "frequency_high")
    return f"up to {level} over {frequencies_text(answer, *ends)}"


def delaminated_statement(answer: xr.Dataset) -> str:
    """Return the statement on a delaminated beam."""
    ratio = scalar(answer, "ratio")
    better = (
        "" if math.isnan(ratio) else f", {format_number(ratio)} times closer than any sound one"
    )
    apart = "the faces are seen to move apart, and " if scalar(answer, "faces_apart") > 1.0 else ""
    return (
        f"The record is that of two halves that part and strike each other: {apart}the delaminated "
        f"structure describes it{better}."
    )


def no_opening_statement(answer: xr.Dataset) -> str:
    """Return the statement for no opening seen; it never says that the beam is intact."""
    smallest = scalar(answer, "smallest_opening")
    seen = ""
    if math.isfinite(smallest):
        shown = answer if units_of(answer).length else with_units(answer, "um")
        factor, unit = scale_of(shown, "m")
        opening = f"{format_number(smallest / factor)} {unit.replace('um', 'µm')}"
        seen = (
            f" Faces at the sensor that part by {opening} or more would have been seen; away from "
            "it an opening may be larger."
        )
    return f"No opening of the faces was seen {format_range(answer)}.{seen}"


def not_described_statement(answer: xr.Dataset) -> str:
    """Return the statement for a record that no hypothesis fits."""
    return (
        "None of the structures that were tried, sound or delaminated, describes this record: "
        "the beam, its clamp or the sensors do something else."
    )


def undecided_statement(answer: xr.Dataset) -> str:
    """Return the statement that the record does not suffice for a decision."""
    return "This record does not tell a delaminated beam from a sound one."


SENTENCES = {
    "delaminated": delaminated_statement,
    "no opening seen": no_opening_statement,
    "not described": not_described_statement,
    "undecided": undecided_statement,
}


def scalar(answer: xr.Dataset, name: str) -> float:
    """Return a scalar variable of a result by its name; NaN if the result lacks it."""
    return float(answer[name]) if name in answer else math.nan


def verdict_sections(answer: xr.Dataset) -> list[Section]:
    """Return all report sections on which a verdict rests."""
    made = [
        decision_section(answer),
        measured_record(answer),
        *(fits_section(answer), misfit_section(answer), parameter_section(answer)),
        assumption_section(answer),
    ]
    return [section for section in made if section is not None]


def measured_record(answer: xr.Dataset) -> Section | None:
    """Return a section on the record: sensors, unit, sampling, sweep; None where none is known."""
    words = {str(name): str(text) for name, text in answer.attrs.items()}
    unit = words.get("record_unit", "").replace("m/s2", "m/s²")
    rows = [
        ("file of the record", words.get("record_file", "")),
        ("columns of the file", words.get("record_columns", "")),
        ("sensors", words.get("sensors", "")),
        ("unit of its accelerations", words.get("record_unit_note", "") or unit),
        ("sampling rate", known_text(answer, "sample_rate", "Hz", 6)),
        ("duration", known_text(answer, "record_duration", "s", 4)),
        ("sweep", sweep_text(answer)),
        ("level of the base", level_text(answer)),
        ("file of the guess", words.get("guess_file", "")),
        ("command that made it", words.get("command", "")),
    ]
    known = [row for row in rows if row[1]]
    if not known:
        return None
    return Section("The record", [NAMES_OF_CHANNELS], tables=[Table(("what", "value"), known)])


def known_text(answer: xr.Dataset, name: str, unit: str, digits: int) -> str:
    """Format a scalar variable in its own unit; empty if the answer has none of that name."""
    value = scalar(answer, name)
    return format_number(value, unit, digits) if math.isfinite(value) else ""


def sweep_text(answer: xr.Dataset) -> str:
    """Format the range and direction of the sweep, and the part of it that was compared."""
    low, high = scalar(answer, "sweep_low"), scalar(answer, "sweep_high")
    if not math.isfinite(low + high):
        return ""
    direction = {"up": "upwards", "down": "downwards", "up and down": "up and down"}
    way = direction.get(str(answer.attrs.get("direction", "")), "")
    whole = f"{frequencies_text(answer, low, high)} {way}".rstrip()
    if "frequency" not in answer.coords:
        return whole
    ends = float(answer.frequency.min()), float(answer.frequency.max())
    return f"{whole}; compared with models: {frequencies_text(answer, *ends)}"


def frequencies_text(answer: xr.Dataset, low: float, high: float) -> str:
    """Format a range of frequencies in Hz in the units that were asked for."""
    turn, word = scale_of(answer, "Hz")
    first, last = (format_number(end / turn, digits=4) for end in (low, high))
    return f"{first} to {last} {'Omega/omega' if word == 'eta' else word}"


def level_text(answer: xr.Dataset) -> str:
    """Format the range of the base's levels in the units that were asked for."""
    ends = [scalar(answer, name) for name in ("level_low", "level_high")]
    if not all(map(math.isfinite, ends)):
        return ""
    felt, unit = scale_of(answer, "m/s2")
    low, high = (format_number(end / felt) for end in ends)
    return f"{low} to {high} {unit.replace('m/s2', 'm/s²')} (peak)"


def decision_section(answer: xr.Dataset) -> Section:
    """Return a section on what decided the verdict and what would change it."""
    reason, settle = (str(answer.attrs.get(name, "")) for name in ("reason", "settle"))
    points = [f"What decided: {make_sentence(reason)}"] if reason else []
    odds = scalar(answer, "odds")
    simulated = str(answer.attrs.get("simulated", ""))
    if simulated:
        points.append(f"{make_sentence(simulated)} Both models were fitted to each of them.")
    elif math.isfinite(odds) and odds > 0.0:
        points.append(
            "The odds of the delaminated against the best sound structure are "
            f"{format_odds(odds)}. They were counted in records put together of blocks of this "
            "one, by how often the ratio of misfits is large enough to decide."
        )
    if settle:
        points.append(f"What would change or settle it: {make_sentence(settle)}")
    return Section("Why", [WORTH], points)


def format_odds(odds: float) -> str:
    """Format odds as a ratio, "24 to 1".

    Examples
    --------
    >>> format_odds(23.7), format_odds(2001.0), format_odds(0.0005)
    ('24 to 1', '2000 to 1', '1 to 2000')
    """
    larger = f"{float(f'{max(odds, 1.0 / odds):.2g}'):g}"
    return f"{larger} to 1" if odds >= 1.0 else f"1 to {larger}"


def make_sentence(words: str) -> str:
    """Return words as a sentence, with a capital at the beginning and a full stop.

    Examples
    --------
    >>> make_sentence("gains agree"), make_sentence("They do.")
    ('Gains agree.', 'They do.')
    """
    return f"{words[:1].upper()}{words[1:].rstrip('.')}."


def fits_section(answer: xr.Dataset) -> Section | None:
    """Return a section with the measurement over the fits; None without fits."""
    if "measured" not in answer or "fitted" not in answer:
        return None
    words = "What was measured, and what the best structures of each kind do, order by order"
    return Section(
        "The measurement over the fits",
        picture=Picture.from_figure(draw_detect(answer), words),
        tables=[hypothesis_table(answer)],
    )


def misfit_section(answer: xr.Dataset) -> Section | None:
    """Return a section with the misfit over frequency; None without it."""
    if "misfit_at" not in answer:
        return None
    words = "Misfit of each structure over the frequency of the excitation"
    text = (
        "The misfit is the distance of a structure's motion from the measured one. It is 1 where "
        "they differ by as much as noise and the usual error of a good model explain."
    )
    picture = Picture.from_figure(draw_misfit(answer), words)
    return Section("Where the structures differ from the measurement", [text], picture=picture)


def hypothesis_table(answer: xr.Dataset) -> Table:
    """Return a table of the hypotheses, the best fit first."""
    ordered = answer.sortby("misfit")
    rows = []
    for position in range(ordered.sizes["hypothesis"]):
        one = ordered.isel(hypothesis=position)
        row = [str(one.hypothesis.values), format_number(float(one.misfit))]
        row.append(f"{int(np.isfinite(one.minima).sum())}" if "minima" in one else MISSING)
        row.append(format_number(scalar(one, "evaluations"), digits=6))
        rows.append(tuple(row))
    columns = ("structure", "misfit", "minima found", "motions computed")
    return Table(
        columns, rows, frozenset(deciding_hypotheses(answer, [row[0] for row in rows])[:1])
    )


def deciding_hypotheses(answer: xr.Dataset, names: Sequence[str]) -> list[int]:
    """Return the indices of the hypotheses on which the verdict rests."""
    parted = {"delaminated": True, "no opening seen": False}.get(str(answer.verdict.values))
    return [index for index, name in enumerate(names) if name.startswith(PARTED) == parted]


def parameter_section(answer: xr.Dataset) -> Section | None:
    """Return a section with the parameters and errors that are stated; None without any."""
    if "value" not in answer or "parameter" not in answer.dims:
        return None
    shown = sort_by_misfit(answer)
    names = [str(one.hypothesis.values) if "hypothesis" in one.coords else "value" for one in shown]
    units = dict(zip(answer.parameter.values, answer.unit.values, strict=True))
    meaning = dict(zip(answer.parameter.values, answer.meaning.values, strict=True))
    rows = [
        (
            f"{name}, {meaning[name]}",
            *(format_parameter(one.sel(parameter=name), str(units[name])) for one in shown),
        )
        for name in answer.parameter.values
    ]
    if all(entry == MISSING for row in rows for entry in row[1:]):
        return None
    columns = [0] + [
        column for column in range(1, 1 + len(shown)) if any(row[column] != MISSING for row in rows)
    ][:BEST]
    known = [
        tuple(row[column] for column in columns)
        for row in rows
        if any(row[column] != MISSING for column in columns[1:])
    ]
    heads = ("parameter", *(names[column - 1] for column in columns[1:]))
    text = (
        "Errors are standard errors from blocks of the record and from what the structure misses. "
        f"What a structure does not have, or the record does not hold, has a dash ({MISSING})."
    )
    return Section("Parameters", [text], tables=[Table(heads, known)])


def sort_by_misfit(answer: xr.Dataset) -> list[xr.Dataset]:
    """Return the hypotheses of a result one by one, the best fit first."""
    if "hypothesis" not in answer.dims:
        return [answer]
    ordered = answer.sortby("misfit")
    return [ordered.isel(hypothesis=position) for position in range(ordered.sizes["hypothesis"])]


def format_parameter(at: xr.Dataset, unit: str) -> str:
    """Format a parameter of one hypothesis with its error; a dash if it has none."""
    factor, word = scale_of(at, unit)
    if word == "eta":  # a half's own frequency is no ratio to itself
        factor, word = 1.0, unit
    value, error = float(at.value) / factor, scalar(at, "standard_error") / factor
    return format_with_error(value, error, word) if math.isfinite(value) else MISSING


def assumption_section(answer: xr.Dataset) -> Section:
    """Return a section with the verdict's assumptions."""
    own = [text.strip() for text in str(answer.attrs.get("assumed", "")).split(";")]
    points = [*ALWAYS_ASSUMED, *describe_guess(answer), *map(make_sentence, filter(None, own))]
    return Section("What was assumed", points=points)


def describe_guess(answer: xr.Dataset) -> list[str]:
    """Return lines on the guess with which the search began; its masses were kept."""
    numbers = {name: float(answer.attrs.get(name, math.nan)) for name in ("m1", "m2", "k1", "k2")}
    if not all(value > 0.0 for value in numbers.values()):
        return []
    masses = " and ".join(format_number(numbers[name], "kg") for name in ("m1", "m2"))
    halves = (math.sqrt(numbers[f"k{i}"] / numbers[f"m{i}"]) / TURN for i in (1, 2))
    frequencies = " and ".join(format_number(f, "Hz") for f in halves)
    return [f"Guessed of both halves: masses of {masses}, which were kept, and {frequencies}."]
