"""``diagnose``: records in, a verdict on each beam and a report out."""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..units import with_units
from .options import Commands, add_set, plain_float, structure_of
from .output import (
    FORMATS,
    PLOTS,
    add_results,
    add_units,
    check_output,
    digest,
    draw_picture,
    endings_of,
    export_formats,
    record_units,
    running_of,
    unit_note,
    units_ending,
    with_ending,
)

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Structure

EXAMPLES = """  {program} diagnose record.csv --structure beam.toml
  {program} diagnose left.csv right.uff --structure beam.toml --set e=0.4 --jobs 2
  {program} diagnose up.csv --other down.csv --other louder.csv --structure beam.toml
  {program} diagnose export.txt --columns 0,3,4 --unit g --sample-rate 2000 --structure beam.toml

what it needs:
  a record of a swept sine over the beam's resonance: the acceleration of its base (the shaker's
  table, the clamp; in Python and in files of this package box_acceleration) and of one face of
  the beam, or of both faces (acceleration1, acceleration2); and a guess of the beam in a file,
  within some 10 %: masses of both halves and their natural frequencies, see 'quantities'.
  Several records are of several beams, and give a verdict each.
what it gives:
  delaminated      the faces part and strike each other
  no opening seen  up to the level and over the frequencies of the record; never "intact"
  not described    the beam, its clamp or the sensors do something else
  undecided        this record does not tell; the report says which one would
  and for each record a report to read, print and sign (.html), the answers (.nc), a picture"""
LINES = {  # attributes of a verdict that are printed below it, and what stands before them
    "reason": "decided by",
    "simulated": "simulated records",
    "settle": "to settle it",
    "record_columns": "columns",
    "record_unit_note": "unit",
}
CHANNELS = {  # in the order of --columns, and what they are called towards the user
    "time": "time",
    "box_acceleration": "base",
    "acceleration1": "face 1",
    "acceleration2": "face 2",
}


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "whether a measured beam is delaminated: a verdict, its evidence, a report"
    parser = commands.add("diagnose", run, text, EXAMPLES)
    files = "measured: .csv, .txt, .uff, .unv, .mat, .nc; one beam each"
    parser.add_argument("records", type=Path, nargs="+", metavar="FILE", help=files)
    guess = parser.add_argument_group("the guess")
    guess.add_argument(
        "--structure", metavar="FILE", help="TOML file with a [structure], or the name of a set"
    )
    add_set(guess, "one of its parameters, such as f1=42; may be repeated")
    option = parser.add_argument_group("records").add_argument
    other = "record of the same beam at another level or in the other direction, for the signs"
    option("--other", type=Path, action="append", default=[], metavar="FILE", help=other)
    option("--unit", metavar="UNIT", help="m/s2, g ... (default: what the file says)")
    columns = "of time, base, face 1 and face 2, by name or number from 0 (default: by usual names)"
    option("--columns", metavar="A,B,...", help=columns)
    rate = "where the file has no times; then --columns begins with the base"
    option("--sample-rate", type=plain_float, metavar="HZ", help=rate)
    option = parser.add_argument_group("report").add_argument
    option("--notes", default="", metavar="WORDS", help="below the title: which beam, who, when")
    add_units(parser)
    add_results(parser, store=False)


def run(arguments: argparse.Namespace) -> None:
    """Diagnose records: a verdict on each beam, its evidence and a report."""
    formats = endings_of("--format", arguments.format, FORMATS)
    plots = endings_of("--plot", arguments.plot, PLOTS)
    check_output(arguments.output)
    guess = guess_of(arguments)
    others = [read(arguments, path) for path in arguments.other]
    if others and len(arguments.records) > 1:
        raise InputError("--other: of one beam; expected one record with it")
    records, refused = read_all(arguments)
    names = {path: name_of(path, guess, arguments) for path in records}
    verdicts = verdicts_of(arguments, records, names, guess) if records else {}
    units = record_units(arguments)
    for path, verdict in verdicts.items():
        print_verdict(path, with_units(verdict, units))
        signs = signs_of(records[path], others, guess)
        write(arguments, names[path], {"": verdict, "_signs": signs}, formats, plots)
    if refused:
        count = len(records) + len(refused)
        raise InputError(f"{len(refused)} of {count} records refused: {'; '.join(refused)}")


def name_of(path: Path, guess: Structure, arguments: argparse.Namespace) -> str:
    """Return the name of a record's files, which depends on content, guess and reading options."""
    read_as = [arguments.columns, arguments.unit, arguments.sample_rate]
    return f"diagnose_{path.stem}_{digest(checksum(path), guess.parameters(), read_as)}"


def checksum(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def guess_of(arguments: argparse.Namespace) -> Structure:
    """Return the guess of the beam, from ``--structure``.

    Raises
    ------
    InputError
        Where there is none: no usual structure is a guess of somebody's beam.
    """
    if arguments.structure is None:
        text = "expected a TOML file with a guess of the beam, within some 10 %"
        raise InputError(f"--structure: nothing given; {text}")
    return structure_of(arguments)


def read_all(arguments: argparse.Namespace) -> tuple[dict[Path, xr.Dataset], list[str]]:
    """Read all records; return them by their files, and a line on each one that is refused.

    Raises
    ------
    InputError
        Where there is one record alone, and it is refused.
    """
    from ..diagnosis.fit import checked_data

    records: dict[Path, xr.Dataset] = {}
    refused: list[str] = []
    paths = list(dict.fromkeys(arguments.records))
    for path in paths:
        try:
            record = read(arguments, path)
            checked_data(record)
            records[path] = record
        except InputError as error:
            line = str(error)
            refused.append(line if line.startswith(str(path)) else f"{path}: {line}")
    if refused and len(paths) == 1:
        raise InputError(refused[0])
    return records, refused


def read(arguments: argparse.Namespace, path: Path) -> xr.Dataset:
    """Read a record from its file; raise if no face's acceleration is in it."""
    from .. import read_record

    columns = columns_of(arguments)
    record = read_record(
        path, columns=columns, unit=arguments.unit, sample_rate=arguments.sample_rate
    )
    if "acceleration1" not in record and "acceleration2" not in record:
        taken = record.attrs.get("columns", "no columns")
        text = "expected a face's beside the base's, such as --columns 0,1,2 or Time,Table,Beam"
        raise InputError(f"{path}: no acceleration of a face in {taken}; {text}")
    return record


def columns_of(arguments: argparse.Namespace) -> dict[str, str | int] | None:
    """Parse ``--columns``: the channels' columns, by name or number; None if it is not given.

    Raises
    ------
    InputError
    """
    if arguments.columns is None:
        return None
    texts = [text.strip() for text in arguments.columns.split(",")]
    names = list(CHANNELS)[arguments.sample_rate is not None :]
    if not 2 <= len(texts) <= len(names) or not all(texts):
        words = ", ".join(CHANNELS[name] for name in names)
        expected = f"expected columns of {words}, the last one if it is there"
        raise InputError(f"--columns {arguments.columns}: {expected}")
    numbers = (int(text) if text.isdecimal() else text for text in texts)
    return dict(zip(names, numbers, strict=False))


def verdicts_of(
    arguments: argparse.Namespace,
    records: Mapping[Path, xr.Dataset],
    names: Mapping[Path, str],
    guess: Structure,
) -> dict[Path, xr.Dataset]:
    """Compute the verdict on each record, or take it from disk; store where it comes from too."""
    from .. import detect_all
    from ..running.store import write_netcdf

    named = {names[path]: record for path, record in records.items()}
    running = running_of(arguments, arguments.output)
    verdicts = detect_all(named, guess, **running)
    described = {}
    for path, name in names.items():
        verdict = verdicts[name]
        words = origin_attributes(arguments, path, records[path])
        words["title"] = f"Verdict on {path.name}: {verdict.verdict.item()}"
        described[path] = verdict.assign_attrs(words)
        if not words.items() <= verdict.attrs.items():
            write_netcdf(described[path], arguments.output / f"{name}.nc")
    return described


def origin_attributes(
    arguments: argparse.Namespace, path: Path, record: xr.Dataset
) -> dict[str, str]:
    """Return a verdict's attributes on its record, the guess's file and the command."""
    words = {
        "record_file": path.name,
        "record_sha256": checksum(path),
        "record_columns": record.attrs.get("columns", ""),
        "record_unit": record.attrs.get("unit", ""),
        "record_unit_note": unit_note(record.attrs),
        "sensors": record.attrs.get("sensors", ""),
        "guess_file": str(arguments.structure),
        "command": getattr(arguments, "command_line", ""),
    }
    return {name: text for name, text in words.items() if text}


def signs_of(record: xr.Dataset, others: list[xr.Dataset], guess: Structure) -> xr.Dataset:
    """Compute the model-free signs of a record."""
    from .. import signs

    return signs(record, other=others, structure=guess)


def write(
    arguments: argparse.Namespace,
    stem: str,
    answers: Mapping[str, xr.Dataset],
    formats: tuple[str, ...],
    plots: tuple[str, ...],
) -> None:
    """Write answers, pictures and the report; print the paths of the files."""
    from .. import plot, report
    from ..files import open_folder
    from ..running.store import write_netcdf

    folder, units = open_folder(arguments.output), record_units(arguments)
    for ending, answer in answers.items():
        place = folder / f"{stem}{ending}.nc"
        if ending:  # the verdict is stored already
            write_netcdf(answer, place)
        shown, named = with_units(answer, units), with_ending(place, units_ending(arguments))
        pictures = draw_picture(named, plots, True, partial(plot, shown))
        for file in (place, *export_formats(shown, named, formats, fresh=True), *pictures):
            print(file)
    page, notes = folder / f"{stem}.html", arguments.notes
    print(report(*answers.values(), output=page, notes=notes, units=units))


def print_verdict(path: Path, verdict: xr.Dataset) -> None:
    """Print the verdict and what it rests on, in a few lines."""
    from ..reports.verdict import verdict_of

    said = verdict_of(verdict)
    print(f"{path}: {said.word} {said.sentence}")
    for name, label in LINES.items():
        if verdict.attrs.get(name):
            print(f"  {label}: {verdict.attrs[name]}")
