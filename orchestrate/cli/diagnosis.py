"""Commands ``diagnose``, whether beams are delaminated by their records, and ``plan``, a test."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from ..errors import InputError
from ..lazy import xr
from ..units import Units, range_text, text_of, with_readable_lengths, with_units
from .command import Command, Options, Question, option
from .grammar import Listed, floats, with_option_names
from .options import OfSensors, OfStructure
from .output import (
    Files,
    InColumns,
    Reading,
    Results,
    digest,
    file_checksum,
    result_name,
    unit_note,
)
from .text import columns_of, parameter_column, table

if TYPE_CHECKING:
    from ..model import Structure

log = logging.getLogger(__name__)
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
        """Return the file's path, and the number of the sweep where there are several."""
        return f"{self.path}{f', sweep {self.number}' if self.number else ''}"


EXPECTED = "a factor for face 1, or for both faces, such as 1.57 or 0.53,0.6"
Participation = Annotated[tuple[float, ...] | None, floats(EXPECTED, ",", (1, 2))]


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
    participation: Participation = option(
        "of the sensors on face 1 and face 2: the beam's mode there over that of a mass on a "
        "spring, 1.57 at the tip of a cantilever (default: fitted)",
        value="G,...",
    )


class Diagnose(DiagnosedRecords, OfStructure, InColumns, Reading, Command, Results):
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
  a record of a swept sine over the beam's resonance: the acceleration of its base (the shaker's
  table, the clamp; in Python and in files of this package box_acceleration) and of one face of
  the beam, or of both faces (acceleration1, acceleration2); and better with a guess of the beam
  in a file, within some 10 %: masses and natural frequencies of both halves, see 'quantities'.
  Several records are of several beams, those of --other of the same one; several sweeps in a file
  give a verdict each, and the signs compare their levels.
what it gives:
  delaminated      the faces part and strike each other
  no opening seen  up to the level and over the frequencies of the record; never "intact"
  not described    the beam, its clamp or the sensors do something else
  undecided        this record does not tell; the report says which one would
  and for each record a report to read, print and sign (.html), the answers (.nc), a picture"""

    def __call__(self) -> None:
        import orchestrate

        Files.from_options(self, "", fresh=True)  # before records are read
        if self.structure is None and self.set:
            raise InputError("--set: of a guess; expected --structure FILE.toml with it")
        guess = None if self.structure is None else self.read_structure()
        others = [self.read_one_record(path) for path in self.other]
        if others and len(self.records) > 1:
            raise InputError("--other: of one beam; expected one record with it")
        log.info("reading %s", ", ".join(path.name for path in self.records))
        records, refused = self.read_all_records()
        names = {one: self.file_stem(one, guess) for one in records}
        verdicts = self.compute_verdicts(records, names, guess, others) if records else {}
        units = self.read_record_units()
        for sweep, verdict in verdicts.items():
            for line in self.verdict_lines(sweep, with_units(verdict, units)):
                print(line)
            log.info("%s: signs, pictures and page", sweep.path.name)
            same = [
                data for one, data in records.items() if one.path == sweep.path and one != sweep
            ]
            signs = orchestrate.signs(records[sweep], other=[*others, *same], structure=guess)
            self.write_files(names[sweep], {"": verdict, "_signs": signs})
        if refused:
            count = len({one.path for one in records}) + len(refused)
            raise InputError(f"{len(refused)} of {count} records refused: {'; '.join(refused)}")

    def file_stem(self, sweep: Sweep, guess: Structure | None) -> str:
        """Return the name of a record's results, unique for content, guess and reading."""
        read_as = [self.channels, self.participation, *self.given(Reading).items()]
        number = f"_sweep{sweep.number}" if sweep.number else ""
        others = [file_checksum(path) for path in self.other]
        part = digest(file_checksum(sweep.path), others, guess and guess.parameters(), read_as)
        return f"diagnose_{sweep.path.stem}{number}_{part}"

    def read_all_records(self) -> tuple[dict[Sweep, xr.Dataset], list[str]]:
        """Read all record files; return a dict of sweeps, and an error line per refused file."""
        from ..diagnosis.fit import checked_data
        from ..diagnosis.order_windows import split_sweeps

        records: dict[Sweep, xr.Dataset] = {}
        refused: list[str] = []
        paths = list(dict.fromkeys(self.records))
        for path in paths:
            try:
                record = self.read_one_record(path)
                checked_data(record)
                parts = split_sweeps(record)
                records |= {
                    Sweep(path, n * (len(parts) > 1)): one for n, one in enumerate(parts, 1)
                }
            except InputError as error:
                line = str(error)
                refused.append(line if line.startswith(str(path)) else f"{path}: {line}")
        if refused and len(paths) == 1:
            raise InputError(refused[0])
        return records, refused

    def read_one_record(self, path: Path) -> xr.Dataset:
        """Read a record from a file; raise if it has no acceleration of either face."""
        from .. import read_record

        record = read_record(path, **self.given(InColumns, Reading))
        if "acceleration1" not in record and "acceleration2" not in record:
            taken = record.attrs.get("columns", "no columns")
            text = "expected a face's too: name its column by --channels, as base=Table,face1=Beam"
            raise InputError(f"{path}: no acceleration of a face in {taken}; {text}")
        return record

    def participation_by_sensor(self) -> dict[str, float] | None:
        """Return ``--participation G,...`` by face; None if it is not given."""
        faces = ("acceleration1", "acceleration2")
        return dict(zip(faces, self.participation, strict=False)) if self.participation else None

    def compute_verdicts(
        self,
        records: Mapping[Sweep, xr.Dataset],
        names: Mapping[Sweep, str],
        guess: Structure | None,
        others: Sequence[xr.Dataset] = (),
    ) -> dict[Sweep, xr.Dataset]:
        """Compute or load each beam's verdict; store with it where it comes from."""
        from .. import detect_all
        from ..running.store import write_netcdf

        named = {names[sweep]: [record, *others] for sweep, record in records.items()}
        running = self.running(self.output)
        factors = self.participation_by_sensor()
        verdicts = detect_all(named, guess, participation=factors, **running)
        described = {}
        for sweep, name in names.items():
            verdict = verdicts[name]
            words = self.origin_attributes(sweep.path, records[sweep])
            label = Sweep(Path(sweep.path.name), sweep.number)
            words["title"] = f"Verdict on {label}: {verdict.verdict.item()}"
            described[sweep] = verdict.assign_attrs(words)
            if not words.items() <= verdict.attrs.items():
                write_netcdf(described[sweep], self.output / f"{name}.nc")
        return described

    def origin_attributes(self, path: Path, record: xr.Dataset) -> dict[str, str]:
        """Return a verdict's attributes on its record, the guess's file and the command."""
        told = ("columns", "unit", "converted", "time_base")
        words = {f"record_{name}": record.attrs.get(name, "") for name in told}
        words |= {"record_file": path.name, "record_sha256": file_checksum(path)}
        words |= {"record_unit_note": unit_note(record.attrs), "command": self.command_line}
        words |= {"sensors": record.attrs.get("sensors", "")}
        words |= {"guess_file": str(self.structure or "")}
        return {name: text for name, text in words.items() if text}

    def write_files(self, stem: str, answers: Mapping[str, xr.Dataset]) -> None:
        """Write results, pictures and the HTML report of one record; print the files' paths."""
        from .. import plot, report
        from ..files import open_folder
        from ..running.store import write_netcdf

        folder, units = open_folder(self.output), self.read_record_units()
        for ending, answer in answers.items():
            files = Files.from_options(self, f"{stem}{ending}", fresh=True)
            if ending:  # the verdict is stored already
                write_netcdf(answer, files.result)
            shown = with_units(answer, units)
            files.write(shown, partial(plot, shown))
        page = folder / f"{stem}.html"
        print(report(*answers.values(), output=page, notes=self.notes or "", units=units))

    def verdict_lines(self, sweep: Sweep, verdict: xr.Dataset) -> Iterator[str]:
        """Yield a record's verdict in a few lines: what it is, its reason, what would settle it."""
        from ..show.verdict import make_verdict

        shown = make_verdict(verdict)
        yield f"{sweep}: {shown.word} {with_option_names(shown.sentence, self)}"
        for name, label in LINES.items():
            if verdict.attrs.get(name):
                yield f"  {label}: {with_option_names(verdict.attrs[name], self)}"


def plan_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield the recommended sweep, whether it decides, and what each rehearsed level shows."""
    level, second = (
        text_of(data, one, "m/s2", ".3g") for one in (data.recommended_level, data.second_level)
    )
    ends = range_text(data, float(data.recommended_first), float(data.recommended_last), "Hz")
    seconds, rate = float(data.recommended_duration), float(data.recommended_rate)
    twice = f"at {level}, then at {second}" if second != level else f"twice at {level}"
    yield f"sweep {ends} {twice}, {seconds:.0f} s each, {rate:.0f} samples a s"
    if second == level:
        yield "the highest of the levels: a second, higher one in --g would be a further check"
    if not data.counts and data.decides.any():
        yield "both verdicts are right at lower levels only, not at all above: see the table"
    elif not data.counts:
        yield "no verdict is right at these levels: raise --g, or lower the --noise"
    opens = float(data.opening_level)
    if opens > 0.0:
        times = float(data.recommended_level) / opens
        lowest = text_of(data, data.opening_level, "m/s2", ".3g")
        yield f"pressed together: it opens from {lowest}: {times:.2g} times less"
    elif not data.attrs["clearance"]:
        yield "faces that touch open at every level; try pressed ones too: --set preload=20um"
    rows = parameter_column(data, "level", data.level.values, ".3g")
    rows["verdict on the guess"] = [str(word) for word in data.verdict.values]
    rows["on its sound twin"] = [str(word) for word in data.sound_verdict.values]
    for name, cells in columns_of(data, "opening", form=".3g").items():
        rows[name.replace("opening", "largest gap")] = cells
    if data.overload.any():
        rows["sensor"] = ["overload" if flag else "" for flag in data.overload.values]
    yield from table(rows)


PlanEnds = Annotated[Any, floats("FIRST:LAST in Hz, such as 30:60", "[:,]", (2,))]


class Plan(OfStructure, OfSensors, Command, Results):
    """Plan a test: rehearse it, and recommend the lowest level at which the verdict is right."""

    calls = "plan_test"
    hz: PlanEnds = option(
        "the sweep's ends in Hz (default: 0.65 to 1.4 times the bonded resonance)",
        value="FIRST:LAST",
    )
    g: Listed = option(
        "levels, peak acceleration in g (default: nine from 0.01 to 1)", value="VALUES"
    )
    faces: Literal["1", "2", "both"] | None = option("faces with a sensor (default: both)")
    examples = """
  {program} plan --structure beam.toml
  {program} plan --structure beam.toml --hz 30:60 --g 0.05,0.1,0.2,0.5 --noise 30ug
  {program} plan --structure beam.toml --set clearance=-20um --range 50
  {program} plan --structure beam.toml --faces 1 --noise 1e-3
The sensors are by default as fast as the sweep needs, with a noise of 1e-3 (m/s2)/sqrt(Hz); a wider
bandwidth (--sensor) takes as many times longer."""

    def ask(self) -> tuple[Structure, Question]:
        structure = self.read_structure()
        from ..diagnosis.plan_test import USUAL_NOISE, usual_ends, usual_sensor

        last = (self.hz or usual_ends(structure))[-1]
        if self.sensor is not None and self.noise is None:
            self.noise = USUAL_NOISE
        sensor: Any = self.read_sensor(partial(usual_sensor, last))
        if self.faces in ("1", "2"):
            sensor = {f"acceleration{self.faces}": sensor or usual_sensor(last)}
        return structure, {**self.keywords(), "frequencies": self.hz, "sensor": sensor}

    def __call__(self) -> None:
        import orchestrate

        from ..files import open_folder
        from ..running.store import write_netcdf

        structure, question = self.ask()
        name = result_name("plan", self.structure, structure, question)
        files = Files.from_options(self, name, fresh=True)
        plan = orchestrate.plan_test(structure, **question, **self.running())
        units = self.read_units().with_defaults(Units("Hz", acceleration="g"))
        described = plan.assign_attrs(structure.parameters())
        (shown,) = with_readable_lengths(with_units(described, units))
        print(*plan_lines(shown), sep="\n")
        open_folder(self.output)
        write_netcdf(plan, files.result)
        files.write(shown, partial(orchestrate.plot, shown))
