"""Commands of the laboratory: shake, analyse, channels and halves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import orchestrate

from ..constants import GRAVITY
from ..errors import InputError
from ..lazy import xr
from ..model import Shaker, Structure
from ..units import Units
from . import grammar, output, printing
from .answer import Files, FunctionCommand, Runs, States
from .command import NONE, Command, Keywords, Options, default_by_argument, option, option_names
from .notes import warn
from .options import Beside, OfSensors, OfStructure
from .output import Reading, ResultFiles, question_digest, unit_override_note


class ExcitationKind(NamedTuple):
    """How options become an excitation."""

    calls: str  # the class, or the reader, whose arguments are its options
    main: tuple[str, ...] = ()  # its arguments that the option of the kind itself is
    level: str = ""  # that which the level is


EXCITATIONS = {
    "swept_sine": ExcitationKind("SweptSine", ("first", "last"), "acceleration"),
    "stepped_sine": ExcitationKind("SteppedSine", ("frequencies",), "acceleration"),
    "random": ExcitationKind("Random", ("psd",), "rms"),
    "shock": ExcitationKind("Shock", ("shape",), "peak"),
    "hammer": ExcitationKind("Hammer", ("peak", "width")),
    "record": ExcitationKind("read_record"),
}
KNOCK = "PEAK:WIDTH in N and s, two numbers such as 20:0.004"
LEVELS = ("g", "acceleration")


class OfExcitation(Options):
    """Options of an excitation."""

    heading, rank = "the box's acceleration, or a knock", 1
    remark = "one of the first six"
    takes = (
        "SweptSine: rate spacing; SteppedSine: settle_cycles measured_cycles; "
        "Random: seed; Shock: length delay; Hammer: at half; read_record: unit scale"
    )
    if_given = True
    swept_sine: Any = option(
        "frequencies, Hz; downwards too",
        value="FIRST:LAST",
        read=grammar.numbers_reader("FIRST:LAST in Hz, such as 8:20", ":", (2,)),
    )
    stepped_sine: Any = option(
        "frequencies, Hz; or a list A,B,...", value="FIRST:LAST:STEP", read=grammar.parse_values
    )
    random: Any = option(
        "density as HZ:VALUE,HZ:VALUE,... in (m/s2)^2/Hz, or in g2/Hz with that behind it",
        value="PSD",
        read=grammar.parse_density,
    )
    shock: str | None = option("half-sine, sawtooth or trapezoid", value="SHAPE")
    hammer: Any = option(
        "largest force, N, and width of a knock, s",
        value="PEAK:WIDTH",
        read=grammar.numbers_reader(KNOCK, ":", (2,)),
    )
    record: Any = option("measured: .csv, .txt, .uff, .unv, .mat, .wav, .nc", value="FILE")
    g: str | None = option(
        "peak acceleration, in 9.80665 m/s2; of sines a profile HZ:VALUE,HZ:VALUE,... too; "
        "of random its rms, to which the density is scaled",
        value="LEVEL",
    )
    acceleration: str | None = option("the same in m/s2", value="LEVEL")
    duration: float | None = option("of all, s")
    column: str | None = option(
        "of a record: the box's, by name or number from 0 (default: by usual names, or 1)",
        value="NAME",
    )

    def read_excitation(self) -> Any:
        kind = self.checked_excitation_kind()
        calls, names, argument = EXCITATIONS[kind]
        settings = self.given_options(OfExcitation)
        main = settings.pop(kind)
        if kind == "record":
            if column := settings.pop("column", None):
                column = int(column) if column.isdecimal() else column
                settings["channels"] = {"box_acceleration": column}
            record = orchestrate.read_record(main, **settings)
            if note := unit_override_note(record.attrs):
                print(f"{main}: {note}")
            return orchestrate.Sampled.from_record(record)
        has_level = [settings.pop(name) for name in LEVELS if name in settings]
        if argument and (has_level or kind != "random"):
            settings[argument] = level = self.parse_level()
            if argument != "acceleration" and not isinstance(level, float):
                raise InputError(f"{option_names([kind])}: expected one number for its level")
        settings |= dict(zip(names, main if len(names) > 1 else (main,), strict=True))
        return getattr(orchestrate, calls)(**settings)

    def checked_excitation_kind(self) -> str:
        given = self.given_options(OfExcitation)
        chosen = [name for name in EXCITATIONS if name in given]
        if len(chosen) != 1:
            words, expected = option_names(chosen, " and ") or "nothing", option_names(EXCITATIONS)
            raise InputError(f"excitation: {words} given; expected one of {expected}")
        takes = {name: default_by_argument(kind.calls) for name, kind in EXCITATIONS.items()}
        leveled = [name for name, kind in EXCITATIONS.items() if kind.level]
        owners = {**dict.fromkeys(LEVELS, leveled), "column": ["record"]}
        for name in given.keys() - EXCITATIONS.keys() - owners.keys():
            owners[name] = [one for one in EXCITATIONS if name in takes[one]]
        self.refuse_without(owners, chosen)
        for name in ("duration", "length"):
            if takes[chosen[0]].get(name) is NONE and name not in given:
                raise InputError(f"{option_names(chosen)}: expected --{name} with it, in s")
        return chosen[0]

    def parse_level(self) -> Any:
        """Return the peak acceleration, m/s2: a number, or a profile over frequency."""
        chosen = self.given_option(*LEVELS)
        if chosen is None:
            raise InputError("level: nothing given; expected one of --g and --acceleration")
        text, unit = getattr(self, chosen), GRAVITY if chosen == "g" else 1.0
        if ":" not in text:
            return unit * grammar.parse_positive_number(f"--{chosen}", text)
        pairs = grammar.parse_breakpoints(f"--{chosen}", text)
        return tuple((frequency, unit * value) for frequency, value in pairs)


class Shake(
    OfStructure, OfExcitation, OfSensors, Beside, FunctionCommand, output.Stored, output.Results
):
    """As in the laboratory: motion and impacts under sines, random, shock or a record."""

    calls = "shake"
    shows = "box_acceleration force1 force2 a1_abs a2_abs x_rel transient_time"
    shaker: str | None = option("its electrodynamic shaker, level controlled", value="FILE")
    examples = """
  {program} shake --structure beam --swept-sine 8:20 --duration 60 --g 0.02 --sensor 2000
  {program} shake --structure beam --swept-sine 5:50 --rate 1 --spacing log --g 5:0.01,50:0.05
  {program} shake --structure beam --stepped-sine 10:14:0.1 --settle-cycles 150 --g 0.02
  {program} shake --structure beam --random 5:1e-3,100:1e-3g2/Hz --g 0.3 --duration 30
  {program} shake --structure beam --swept-sine 8:20 --duration 60 --g 0.02 --shaker shaker_1kN
  {program} shake --structure beam --shock half-sine --length 0.011 --g 5
  {program} shake --structure beam --hammer 20:0.004 --half 2 --at 0.1 --duration 5
  {program} shake --structure beam --record base.csv --unit g
--sensor also writes what accelerometers read, a record for diagnose, analyse and channels."""

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        yield from super().summary_lines(data)
        if "control_aborted" in data and data.control_aborted.notnull():
            end = float(data.control_aborted)
            yield f"warning: the level could not be held; the control aborted at {end:.4g} s"

    def read_question(self) -> tuple[Structure, Keywords]:
        from ..running.job import refuse_unsupported_structure

        structure, shaker = self.read_and_report_structure(), self.shaker
        if self.read_sensor() is not None:  # before anything is computed
            refuse_unsupported_structure("--sensor", structure)
        self.signal = self.read_excitation()
        if (self.sample_rate or math.inf) < (needed := self.signal.usual_rate) / 10.0:
            text = f"--sample-rate {self.sample_rate:g}: too few samples to show the excitation"
            warn(f"{text}; the default is {needed:g}")
        question = {"excitation": self.signal, **self.function_keywords()}
        question["shaker"] = None if shaker is None else Shaker.from_file(shaker)
        return structure, question

    def write_further_files(self, files: ResultFiles, shown: Runs, results: Runs) -> None:
        if (sensor := self.read_sensor()) is None:
            return
        excitation = None if self.shaker else self.signal
        # one file, one name
        own = "" if self.store else question_digest(sensor.label, sensor.rate)
        for state, data in results.items():
            path = files.path_with_suffixes(state, "sensors", own)
            record = orchestrate.measure(data, sensor, excitation=excitation)
            for ending in dict.fromkeys(("nc", *(one for one in files.formats if one != "xlsx"))):
                written = orchestrate.write_record(record, path.with_suffix(f".{ending}"))
                print(f"{written}: what the sensors read")


MASSES = {"box_acceleration": "box", "acceleration1": "mass 1", "acceleration2": "mass 2"}
ANALYSES = {  # of --show: the public function, what it shows; whose peaks, what else is printed
    "frf": ("frf", "frequency response and coherence", "magnitude", "random_error, coherence"),
    "psd": ("psd", "power spectral density", "psd", "rms"),
    "orders": ("track_orders", "orders of a swept sine", "amplitude", ""),
    "harmonics": ("harmonics", "harmonics and their distortion", "distortion", ""),
    "spectrogram": ("spectrogram", "spectra over the time", "amplitude", ""),
    "shock": ("shock_spectrum", "shock response spectrum", "maximax", ""),
    "density": (
        *("probability_density", "probability density, skewness", ""),
        "skewness, skewness_error, kurtosis, kurtosis_error, standard_deviation",
    ),
}
SHOWN = ", ".join(f"{name} ({row[1]})" for name, row in ANALYSES.items())


class Settings(Options):
    """Settings of analyses."""

    heading = "settings"
    takes = (
        "frf: resolution window overlap; track_orders: orders periods; harmonics: highest; "
        "shock_spectrum: damping; probability_density: bins"
    )
    if_given = True


class AnalysedRecords(Options):
    """Options of the records of an analysis."""

    heading, rank = "records", 0
    record: Path = option(
        "a result of shake (.nc), or a record: .csv, .txt, .uff, .unv, .mat, .lvm, .tdms, .wav or "
        ".nc",
        position=True,
        needed=True,
    )
    show: str = option(SHOWN, "frf,psd", value="A,B,...")
    label: str | None = option("what the record is, for the picture", value="WORDS")
    beside: list[str] = option(
        "another record in the same picture; may be repeated", (), value="LABEL=FILE"
    )
    begin: float | None = option("time it begins at, s", names=("--from",))
    to: float | None = option("time it ends at, s")


class Analyse(AnalysedRecords, OfSensors, Reading, Settings, output.Shown, FunctionCommand):
    """What an analyser shows of a record: responses, spectra, orders, shock spectra."""

    stores = False
    examples = """
  {program} analyse results/shake.nc --show frf,psd --resolution 0.5
  {program} analyse swept.nc --label delaminated --beside bonded=whole.nc --show orders,harmonics
  {program} analyse measured.csv --unit g --channels time=0,base=3,face1=4
  {program} analyse run.wav --scale 500 --show spectrogram,density --from 2 --to 30
  {program} analyse shock.nc --show shock --damping 0.05 --format nc,csv"""

    def __call__(self) -> None:
        names = output.parse_known_words("--show", self.show, tuple(ANALYSES))
        ResultFiles.from_options(self, "", fresh=True)  # before records are read
        takes = {name: default_by_argument(row[0]) for name, row in ANALYSES.items()}
        chosen = self.given_options(Settings)
        owners = {one: [name for name in takes if one in takes[name]] for one in chosen}
        self.refuse_without(owners, names, "--show ")
        self.paths = self.paths_by_label()
        whole = {label: self.read_record_file(path) for label, path in self.paths.items()}
        self.check_sensor_use(whole)
        self.records = {label: self.measure_and_cut(label, one) for label, one in whole.items()}
        for label, record in self.records.items():
            if note := unit_override_note(record.attrs):
                print(f"{self.paths[label]}: {note}")
        read = {label: str(path) for label, path in self.paths.items()}
        reading = [self.begin, self.to, *self.given_options(OfSensors).values()]
        reading += self.given_options(Reading).items()
        for self.analysis in names:
            self.calls, self.named = ANALYSES[self.analysis][0], f"analyse_{self.analysis}"
            question = {one: chosen[one] for one in chosen if one in takes[self.analysis]}
            self.compute_print_and_write([read, reading], question)

    def source_file_stems(self) -> list[str]:
        return [self.record.stem]

    def structures_by_state(self, structure: Any) -> dict[str, Any]:
        return self.records

    def compute(self, states: States, others: Any, question: Keywords, files: Files) -> Runs:
        results = {}
        for label, record in states.items():
            try:
                results[label] = getattr(orchestrate, self.calls)(record, **question)
            except InputError as error:
                raise InputError(f"{self.paths[label]}: {error}") from None
        return results

    def display_units(self, question: Keywords) -> Units:
        return self.record_display_units()

    def summary_lines(self, data: xr.Dataset) -> Iterator[str]:
        """Yield a row for each channel, and each order: the largest value, and where it is."""
        _, title, variable, others = ANALYSES[self.analysis]
        yield title
        if self.analysis in ("orders", "harmonics"):  # of the box they are those of the excitation
            data = data.drop_sel(channel="box_acceleration", errors="ignore")
        data = data.assign_coords(channel=[MASSES[str(one)] for one in data.channel.values])
        if variable:
            peaks = data[variable]
            if self.analysis == "frf":
                peaks = peaks.sel(estimator="H1", drop=True).where(data.excited > 0)
            along = [dim for dim in peaks.dims if dim not in ("channel", "order")]
            data = data.assign({variable: peaks}).isel(peaks.fillna(-1.0).argmax(along))
            where = "at:.5g, time:.4g" if "time" in data.coords else "at:.5g"
            others = f"{variable}:.4g, {where}{others and f', {others}'}"
            data = data.assign(at=data.frequency)
        yield from printing.table_lines(data, others)

    def draw(self, results: Runs, question: Keywords, *_: xr.Dataset) -> Any:
        from ..show.analysis import draw

        (label, first), *others = results.items()
        return draw(first, label, dict(others))

    def check_sensor_use(self, records: Mapping[str, xr.Dataset]) -> None:
        """Raise if sensors are given and no motion is simulated; warn of unlike accelerations."""
        simulated = [label for label, record in records.items() if "impulse" in record]
        if self.sensor is not None and not simulated:
            text = "of simulated motions; expected a result of shake, or a record without it"
            raise InputError(f"--sensor {self.sensor}: {text}")
        if self.sensor is None and 0 < len(simulated) < len(records):
            warn(
                f"{', '.join(simulated)}: accelerations between impacts, compared with a record "
                "whose sensors feel the impulses too; --sensor HZ:RATE compares like with like"
            )

    def paths_by_label(self) -> dict[str, Path]:
        """Return a dict from label to record file, from FILE and ``--beside``; FILE comes first."""
        label = self.label or (self.record.stem if self.beside else "")
        beside = grammar.parse_pairs("--beside", self.beside, "LABEL=FILE, such as bonded=whole.nc")
        if label in beside:
            text = f"a second record {label}; expected another label"
            raise InputError(f"--beside {label}={beside[label]}: {text}")
        return {label: self.record, **{name: Path(path) for name, path in beside.items()}}

    def measure_and_cut(self, label: str, record: xr.Dataset) -> xr.Dataset:
        """Apply ``--sensor`` to a simulated record; cut it from ``--from`` to ``--to``."""
        if (sensor := self.read_sensor()) is not None and "impulse" in record:
            record = orchestrate.measure(record, sensor)
        if "time" not in record.coords or self.begin is self.to is None:
            return record
        part = record.sel(time=slice(self.begin, self.to))
        if not part.sizes["time"]:
            ends = f"{float(record.time[0]):.6g} to {float(record.time[-1]):.6g} s"
            text = f"nothing between --from and --to; it has {ends}"
            raise InputError(f"{self.paths[label]}: {text}")
        return part

    def read_record_file(self, path: Path) -> xr.Dataset:
        if path.suffix.lower() == ".nc":
            flag = "FILE" if path == self.record else "--beside"
            stored = grammar.load_earlier_result(flag, path)
            units = {stored[name].attrs.get("units", "m/s2") for name in MASSES if name in stored}
            return stored if units <= {"m/s2"} else orchestrate.read_record(path)
        reading = self.given_options(Reading)
        if path.suffix.lower() != ".wav":  # the scale is of the others
            reading.pop("scale", None)
        return orchestrate.read_record(path, **reading)


class Halves(Reading, Command):
    """Fit a structure to knocks of a hammer on each half, and write it as TOML file."""

    calls, takes = "halves", "resolution estimator"
    records: list[Path] = option(
        "knocks on half 1 and on half 2, a file each; or on a sound beam, with --thicknesses",
        position=True,
        needed=True,
    )
    thicknesses: Any = option(
        "of layers 1 and 2 of a sound beam, in any unit",
        value="H1,H2",
        read=grammar.numbers_reader("H1,H2, two numbers such as 3,2", ",", (2,)),
    )
    output: Path | None = option("where to write the structure", value="FILE.toml")
    examples = """
  {program} halves half1.csv half2.csv --output beam.toml
  {program} halves sound.uff --thicknesses 3,2 --output beam.toml
  {program} halves half1.csv half2.csv --channels knocks.toml
A record has a column of force, in N, and the acceleration of the half that is struck. Knock so
softly that the halves do not strike each other: 2/pi x peak x width below 2 pi f m x gap. The file
is a guess: --structure of diagnose, plan and others; complete it by e and clearance."""

    def __call__(self) -> None:
        if len(self.records) > 2:
            raise InputError(f"{self.records[-1]}: expected one record of each half")
        reading = self.given_options(Reading)
        records = [orchestrate.read_record(path, **reading) for path in self.records]
        if len({*map(output.file_checksum, self.records)}) < len(records):
            text = f"the same numbers as {self.records[0]}; expected one record of each half"
            raise InputError(f"{self.records[-1]}: {text}")
        if len(records) == 2 and all("force1" in one and "force2" not in one for one in records):
            print(f"{self.records[1]}: taken for knocks on half 2, as the second record")
            names = {"force1": "force2", "acceleration1": "acceleration2"}
            if "acceleration2" in records[1]:  # both faces are measured
                del names["acceleration1"]
            records[1] = records[1].rename({n: new for n, new in names.items() if n in records[1]})
        try:
            fits = orchestrate.halves(*records, **self.function_keywords())
        except InputError as error:
            name, _, text = str(error).partition(": ")
            path = dict(zip(("record", "other"), self.records, strict=False)).get(name, name)
            raise InputError(f"{path}: {text}" if text else name) from None
        fitted = "mass+mass_error, frequency+frequency_error, damping+damping_error"
        print(*printing.table_lines(fits, f"{fitted}, misfit:.1%", ".5g"), sep="\n")
        print("e = {e:g} and clearance = {clearance:g} m are assumed".format(**fits.attrs))
        if self.output is not None:
            print(self.output)


class Channels(Reading, Command):
    """List the columns of a record, and as which channels they are read; write that as a file."""

    record: Path = option("as for analyse", position=True, needed=True)
    output: Path | None = option(
        "where to write how the columns are read, as TOML: to complete with units, sensitivities, "
        "delays and sensors, and to give as --channels",
        value="FILE.toml",
    )
    examples = """
  {program} channels run.csv
  {program} channels run.csv --channels base=Table,face1=3 --unit face1=g --output setup.toml
  {program} channels run.csv --channels setup.toml
diagnose, analyse and others take --channels setup.toml too. Where the channels cannot be read as
they are, the last line says what is missing."""

    def __call__(self) -> None:
        from ..laboratory.columns import BY_ORDER

        reading = self.given_options(Reading)
        found = orchestrate.channels(self.record, **reading, output=self.output)
        names = "column, role, known, quantity, unit, rms:.4g"
        print(*printing.table_lines(found, names), sep="\n")
        proposed = found.role[(found.known == BY_ORDER).values]
        if said := ", ".join(f'"{one.column.item()}" as {one.item()}' for one in proposed):
            warn(
                f"{self.record}: a proposal by the columns' order: {said}; see that it is right, "
                "and say it by --channels, in full or as a file (--output)"
            )
        if rate := found.attrs["sample_rate"]:
            print(f"{rate:.6g} samples a second")
        if refused := found.attrs["refused"]:
            print(f"not to be read so: {grammar.with_option_names(refused, self)}")
        if self.output is not None:
            print(self.output)
