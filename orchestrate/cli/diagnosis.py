"""Commands ``diagnose``, whether beams are delaminated by their records, and ``plan``, a test."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple

import orchestrate

from ..errors import InputError
from ..lazy import xr
from ..model import Structure
from ..units import Units, with_units
from . import grammar, output, printing
from .answer import FunctionCommand
from .command import Command, Keywords, Options, option
from .options import OfSensors, OfStructure
from .output import Reading, ResultFiles, file_checksum, question_digest, unit_override_note

log = logging.getLogger(__name__)
RECOMMENDED = (  # variables of a plan
    "recommended_level second_level recommended_first recommended_last recommended_duration "
    "opening_level"
)
LINES = {  # attributes of a verdict that are printed below it, and what stands before them
    "wiring": "wiring",
    "reason": "decided by",
    "settle": "to settle it",
    "record_columns": "columns",
    "record_unit_note": "unit",
    "record_converted": "converted",
    "record_time_base": "times",
}


class Sweep(NamedTuple):
    """One sweep of a record's file."""

    path: Path
    number: int = 0

    def __str__(self) -> str:
        return f"{self.path}{f', sweep {self.number}' if self.number else ''}"


PARTICIPATION = "a factor for face 1, or for both faces, such as 1.57 or 0.53,0.6"


class DiagnosedRecords(Options):
    """Options of the records of a diagnosis."""

    heading, rank = "records", 0
    records: list[Path] = option(
        ".csv, .txt, .uff, .unv, .mat, .lvm, .tdms, .nc; one beam each", position=True, needed=True
    )
    other: list[Path] = option(
        "record of the same beam at another level or in the other direction: the verdict is on "
        "all; may be repeated",
        (),
    )
    participation: Any = option(
        "of the sensors on face 1 and face 2: the beam's mode there over that of a mass on a "
        "spring, 1.57 at the tip of a cantilever (default: fitted)",
        value="G,...",
        read=grammar.numbers_reader(PARTICIPATION, ",", (1, 2)),
    )


class Diagnose(DiagnosedRecords, OfStructure, Reading, Command, output.Results):
    """Whether a measured beam is delaminated: a verdict, its evidence, a report."""

    structure: Any = option(
        "guess of the beam: TOML file with a [structure], or the name of a set (default: halves of "
        "equal mass around the record's resonance)",
        value="SET|FILE",
    )
    notes: str | None = option(
        "below the title of the report: which beam, who, when", value="WORDS"
    )
    examples = """
  {program} diagnose record.csv --structure beam.toml
  {program} diagnose left.csv right.uff --structure beam.toml --set e=0.4 --jobs 2
  {program} diagnose up.csv --other down.csv --other louder.csv --structure beam.toml
  {program} diagnose export.txt --channels 0,3,4 --unit g --structure beam.toml
  {program} diagnose laser.csv --unit face=mm/s --sensitivity "base=100 mV/g" --structure beam.toml

what it needs:
  a record of a swept sine over the beam's resonance: the acceleration of its base (shaker's table,
  clamp) and of one face or both (acceleration1, acceleration2); better with a guess of the beam,
  within some 10 %: masses and natural frequencies of both halves, see 'quantities'. Several sweeps
  in a file give a verdict each, and the signs compare their levels.
what it gives:
  delaminated      the faces part and strike each other
  no opening seen  up to the level and over the frequencies of the record; never "intact"
  not described    the beam, its clamp or the sensors do something else
  undecided        this record does not tell; the report says which one would
  and for each record a report to read, print and sign (.html), the answers (.nc), a picture"""

    def __call__(self) -> None:
        ResultFiles.from_options(self, "", fresh=True)  # before records are read
        if self.structure is None and self.set:
            raise InputError("--set: of a guess; expected --structure FILE.toml with it")
        guess = None if self.structure is None else self.read_and_report_structure()
        others = [self.read_record_with_face(path) for path in self.other]
        if others and len(self.records) > 1:
            raise InputError("--other: of one beam; expected one record with it")
        log.info("reading %s", ", ".join(path.name for path in self.records))
        records, refused = self.read_sweeps_and_refusals()
        names = {one: self.file_stem(one, guess) for one in records}
        beams = {names[sweep]: [record, *others] for sweep, record in records.items()}
        faces = ("acceleration1", "acceleration2")
        factors = dict(zip(faces, self.participation or (), strict=False)) or None
        how: Any = {"participation": factors, **self.running_keywords(self.output)}
        verdicts = orchestrate.detect_all(beams, guess, **how) if beams else {}
        for sweep, record in records.items():
            verdict = self.with_origin(sweep, record, verdicts[names[sweep]])
            same = [one for key, one in records.items() if key.path == sweep.path and key != sweep]
            signs = partial(orchestrate.signs, record, other=[*others, *same], structure=guess)
            self.print_and_write(sweep, names[sweep], verdict, signs)
        if refused:
            count = len({one.path for one in records}) + len(refused)
            raise InputError(f"{len(refused)} of {count} records refused: {'; '.join(refused)}")

    def file_stem(self, sweep: Sweep, guess: Structure | None) -> str:
        """Return the name of a record's results, unique for content, guess and reading."""
        read_as = [self.channels, self.participation, *self.given_options(Reading).items()]
        checksums = [file_checksum(path) for path in (sweep.path, *self.other)]
        number = f"_sweep{sweep.number}" if sweep.number else ""
        return f"diagnose_{sweep.path.stem}{number}_{question_digest(checksums, guess, read_as)}"

    def read_sweeps_and_refusals(self) -> tuple[dict[Sweep, xr.Dataset], list[str]]:
        from ..diagnosis.fit import checked_record_data
        from ..diagnosis.order_windows import split_sweeps

        records: dict[Sweep, xr.Dataset] = {}
        refused: list[str] = []
        paths = list(dict.fromkeys(self.records))
        for path in paths:
            try:
                record = self.read_record_with_face(path)
                checked_record_data(record)
                parts = split_sweeps(record)
                several = len(parts) > 1
                records |= {Sweep(path, n * several): one for n, one in enumerate(parts, 1)}
            except InputError as error:
                line = str(error)
                refused.append(line if line.startswith(str(path)) else f"{path}: {line}")
        if refused and len(paths) == 1:
            raise InputError(refused[0])
        return records, refused

    def read_record_with_face(self, path: Path) -> xr.Dataset:
        record = orchestrate.read_record(path, **self.given_options(Reading))
        if "acceleration1" not in record and "acceleration2" not in record:
            taken = record.attrs.get("columns", "no columns")
            text = "expected a face's too: name its column by --channels, as base=Table,face1=Beam"
            raise InputError(f"{path}: no acceleration of a face in {taken}; {text}")
        return record

    def with_origin(self, sweep: Sweep, record: xr.Dataset, verdict: xr.Dataset) -> xr.Dataset:
        """Return a verdict with what it is on: record, guess and command."""
        label = sweep._replace(path=Path(sweep.path.name))
        told = ("columns", "unit", "converted", "time_base")
        words = {
            **{f"record_{name}": record.attrs.get(name) for name in told},
            **{"record_file": str(label.path), "record_sha256": file_checksum(sweep.path)},
            "record_unit_note": unit_override_note(record.attrs),
            "command": self.command_line,
            "sensors": record.attrs.get("sensors"),
            "guess_file": str(self.structure or ""),
            "title": f"Verdict on {label}: {verdict.verdict.item()}",
        }
        return verdict.assign_attrs({name: text for name, text in words.items() if text})

    def print_and_write(self, sweep: Sweep, stem: str, verdict: xr.Dataset, signs: Any) -> None:
        """Print and write a verdict, then its signs, from the function that computes them."""
        from ..show.verdict import make_verdict

        units = self.record_display_units()
        words = make_verdict(with_units(verdict, units))
        print(f"{sweep}: {words.word} {grammar.with_option_names(words.sentence, self)}")
        for name, label in LINES.items():
            if text := verdict.attrs.get(name):
                print(f"  {label}: {grammar.with_option_names(text, self)}")
        log.info("%s: signs, pictures and page", sweep.path.name)
        answers = {"": verdict, "_signs": signs()}
        for ending, answer in answers.items():
            files = ResultFiles.from_options(self, f"{stem}{ending}", fresh=True)
            output.write_unstored_netcdf(files, answer)
            shown = with_units(answer, units)
            files.write_tables(shown)
            files.write_pictures(partial(orchestrate.plot, shown))
        more: Any = {"notes": self.notes or "", "units": units}
        print(orchestrate.report(*answers.values(), output=self.output / f"{stem}.html", **more))


class Plan(OfStructure, OfSensors, FunctionCommand, output.Results):
    """Plan a test: rehearse it, and recommend the lowest level at which the verdict is right."""

    calls, named, stores = "plan_test", "plan", False
    hz: Any = option(
        "the sweep's ends in Hz (default: 0.65 to 1.4 times the bonded resonance)",
        value="FIRST:LAST",
        read=grammar.numbers_reader("FIRST:LAST in Hz, such as 30:60", "[:,]", (2,)),
    )
    g: Any = option(
        "levels, peak acceleration in g (default: nine from 0.01 to 1)",
        value="VALUES",
        read=grammar.parse_values,
    )
    faces: Literal["1", "2", "both"] | None = option("faces with a sensor (default: both)")
    examples = """
  {program} plan --structure beam.toml
  {program} plan --structure beam.toml --hz 30:60 --g 0.05,0.1,0.2,0.5 --noise 30ug
  {program} plan --structure beam.toml --set clearance=-20um --range 50
  {program} plan --structure beam.toml --faces 1 --noise 1e-3
The sensors are by default as fast as the sweep needs, with a noise of 1e-3 (m/s2)/sqrt(Hz)."""

    def read_question(self) -> tuple[Structure, Keywords]:
        structure = self.read_and_report_structure()
        from ..diagnosis.plan_test import USUAL_NOISE, default_sensor, default_sweep_range

        last = (self.hz or default_sweep_range(structure))[-1]
        if self.sensor is not None and self.noise is None:
            self.noise = USUAL_NOISE
        sensor: Any = self.read_sensor(partial(default_sensor, last))
        if self.faces in ("1", "2"):
            sensor = {f"acceleration{self.faces}": sensor or default_sensor(last)}
        return structure, {**self.function_keywords(), "frequencies": self.hz, "sensor": sensor}

    def display_units(self, question: Keywords) -> Units:
        return self.read_units().with_defaults(Units("Hz", acceleration="g"))

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        yield from printing.describe(data, RECOMMENDED)
        if data.recommended_rate.notnull():
            yield f"recommended sampling: {float(data.recommended_rate):.0f} samples a second"
        if data.second_level == data.recommended_level:
            yield "the highest of the levels: a second, higher one in --g would be a further check"
        if not data.counts and data.decides.any():
            yield "both verdicts are right at lower levels only, not at all above: see the table"
        elif not data.counts:
            yield "no verdict is right at these levels: raise --g, or lower the --noise"
        if not data.attrs["clearance"]:
            yield "faces that touch open at every level; try pressed ones too: --set preload=20um"
        titles = {"verdict": "verdict on the guess", "sound_verdict": "on its sound twin"}
        names = ", ".join([*titles.values(), "opening", "overload"])
        yield from printing.table_lines(data.rename(titles), names, ".3g")
