"""Commands of the laboratory: shake and analyse."""

from __future__ import annotations

import inspect
import math
import warnings
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from ..errors import InputError
from ..lazy import xr
from ..units import text_of, with_units
from .answer import Asked
from .command import Command, Options, Question, option, option_names
from .grammar import (
    Density,
    Listed,
    floats,
    parse_breakpoints,
    positive_number,
    read_earlier_result,
    read_pairs,
)
from .options import Beside, OfSensors, OfStructure
from .output import (
    Files,
    Formats,
    InColumns,
    InFolder,
    InUnits,
    Reading,
    Results,
    Stored,
    digest,
    parse_endings,
    unit_note,
)
from .text import Columns, columns_of, extents, impact_lines, table

if TYPE_CHECKING:
    from ..model import Structure

KINDS = {  # of excitation: the class, or the reader, whose arguments are its options
    "swept_sine": "SweptSine",
    "stepped_sine": "SteppedSine",
    "random": "Random",
    "shock": "Shock",
    "hammer": "Hammer",
    "record": "read_record",
}

SweepEnds = Annotated[Any, floats("FIRST:LAST in Hz, such as 8:20", ":", (2,))]
Knock = Annotated[Any, floats("PEAK:WIDTH in N and s, two numbers such as 20:0.004", ":", (2,))]
LEVELS = ("g", "acceleration")
LEVEL_OF = {"shock": "peak", "random": "rms"}  # the argument that the level is, if another


def arguments_of(function: str) -> dict[str, bool]:
    """Return the arguments of a public function or class, and whether each is needed."""
    import orchestrate

    parameters = inspect.signature(getattr(orchestrate, function)).parameters.values()
    return {one.name: one.default is inspect.Parameter.empty for one in parameters}


class OfExcitation(Options):
    """Options of an excitation."""

    heading, rank = "the box's acceleration, or a knock", 1
    remark = "one of the first six"
    takes = (
        "SweptSine: rate spacing; SteppedSine: settle_cycles measured_cycles; "
        "Random: seed; Shock: length delay; Hammer: at half; read_record: unit scale"
    )
    if_given = True
    swept_sine: SweepEnds = option("frequencies, Hz; downwards too", value="FIRST:LAST")
    stepped_sine: Listed = option("frequencies, Hz; or a list A,B,...", value="FIRST:LAST:STEP")
    random: Density = option(
        "density as HZ:VALUE,HZ:VALUE,... in (m/s2)^2/Hz, or in g2/Hz with that behind it",
        value="PSD",
    )
    shock: str | None = option("half-sine, sawtooth or trapezoid", value="SHAPE")
    hammer: Knock = option("largest force, N, and width of a knock, s", value="PEAK:WIDTH")
    record: Any = option("measured: .csv, .txt, .uff, .unv, .mat, .wav, .nc", value="FILE")
    g: str | None = option(
        "peak acceleration, in 9.80665 m/s2; of sines a profile HZ:VALUE,HZ:VALUE,... too; "
        "of random its rms, to which the density is scaled",
        value="LEVEL",
    )
    acceleration: str | None = option(
        "peak acceleration, m/s2; of sines a profile HZ:VALUE,HZ:VALUE,... too", value="LEVEL"
    )
    duration: float | None = option("of all, s")
    column: str | None = option(
        "of a record: the box's, by name or number from 0 (default: by usual names, or 1)",
        value="NAME",
    )

    def read_excitation(self) -> Any:
        """Return the excitation that the options describe, such as a ``SweptSine``."""
        import orchestrate

        kind = self.excitation_kind()
        settings = self.given(OfExcitation)
        main = settings.pop(kind)
        if kind == "record":
            if column := settings.pop("column", None):
                column = int(column) if column.isdecimal() else column
                settings["channels"] = {"box_acceleration": column}
            record = orchestrate.read_record(main, **settings)
            if note := unit_note(record.attrs):
                print(f"{main}: {note}")
            return orchestrate.Sampled.from_record(record)
        if kind == "hammer":
            return orchestrate.Hammer(peak=main[0], width=main[1], **settings)
        has_level = any(settings.pop(name, None) is not None for name in LEVELS)
        if kind != "random" or has_level:
            level = self.read_level()
            settings[LEVEL_OF.get(kind, "acceleration")] = level
            if kind in LEVEL_OF and not isinstance(level, float):
                raise InputError(f"{option_names([kind])}: expected one number for its level")
        names = {"stepped_sine": "frequencies", "random": "psd", "shock": "shape"}
        settings |= {names[kind]: main} if kind in names else {"first": main[0], "last": main[1]}
        return getattr(orchestrate, KINDS[kind])(**settings)

    def excitation_kind(self) -> str:
        """Return which kind of excitation is chosen; raise for options of another kind."""
        given = self.given(OfExcitation)
        chosen = [name for name in KINDS if name in given]
        if len(chosen) != 1:
            words = option_names(chosen, " and ") or "nothing"
            names = option_names(KINDS)
            raise InputError(f"excitation: {words} given; expected one of {names}")
        takes = {name: arguments_of(called) for name, called in KINDS.items()}
        leveled = ["swept_sine", "stepped_sine", "shock", "random"]
        owners = {**dict.fromkeys(LEVELS, leveled), "column": ["record"]}
        for name in given.keys() - KINDS.keys():
            own = owners.get(name) or [one for one in KINDS if name in takes[one]]
            if chosen[0] not in own:
                words = option_names(own, " or ")
                raise InputError(f"{option_names([name])}: expected only with {words}")
        for name in ("duration", "length"):
            if takes[chosen[0]].get(name) and name not in given:
                raise InputError(f"{option_names(chosen)}: expected --{name} with it, in s")
        return chosen[0]

    def read_level(self) -> Any:
        """Return the peak acceleration, m/s2: a number, or a profile over frequency."""
        from ..constants import GRAVITY

        chosen = [name for name in LEVELS if getattr(self, name) is not None]
        if len(chosen) != 1:
            words = option_names(chosen, " and ") or "nothing"
            raise InputError(f"level: {words} given; expected one of --g and --acceleration")
        text, unit = getattr(self, chosen[0]), GRAVITY if chosen[0] == "g" else 1.0
        if ":" not in text:
            return unit * positive_number(f"--{chosen[0]}", text)
        return tuple((f, unit * value) for f, value in parse_breakpoints(f"--{chosen[0]}", text))


class Shake(OfStructure, OfExcitation, OfSensors, Beside, Asked, Stored, Results):
    """As in the laboratory: motion and impacts under sines, random, shock or a record."""

    calls = "shake"
    shaker: str | None = option("its electrodynamic shaker, level controlled", value="FILE")
    examples = """
  {program} shake --structure beam --swept-sine 8:20 --duration 60 --g 0.02 --beside
  {program} shake --structure beam --swept-sine 5:50 --rate 1 --spacing log --g 5:0.01,50:0.05
  {program} shake --structure beam --stepped-sine 10:14:0.1 --settle-cycles 150 --g 0.02
  {program} shake --structure beam --random 5:0.1,100:0.1 --duration 30 --seed 1
  {program} shake --structure beam --random 5:1e-3,100:1e-3g2/Hz --g 0.3 --duration 30
  {program} shake --structure beam --swept-sine 8:20 --duration 60 --g 0.02 --shaker shaker_1kN
  {program} shake --structure beam --shock half-sine --length 0.011 --g 5
  {program} shake --structure beam --hammer 20:0.004 --half 2 --at 0.1 --duration 5
  {program} shake --structure beam --record base.csv --unit g
  {program} shake --structure beam --swept-sine 8:20 --duration 60 --g 0.02 --sensor 2000
The last one also writes what accelerometers read, a record for diagnose, analyse and channels."""

    def ask(self) -> tuple[Structure, Question]:
        from .. import Shaker
        from ..running.job import refuse_family

        structure, shaker = self.read_structure(), self.shaker
        if self.read_sensor() is not None:  # before anything is computed
            refuse_family("--sensor", structure)
        excitation = self.read_excitation()
        if (self.sample_rate or math.inf) < (needed := excitation.usual_rate) / 10.0:
            text = f"--sample-rate {self.sample_rate:g}: too few samples to show the excitation"
            warnings.warn(f"{text}; the default is {needed:g}", stacklevel=2)
        return structure, {
            "excitation": excitation,
            **self.keywords(),
            "shaker": None if shaker is None else Shaker.from_file(shaker),
        }

    def write_more(self, files: Files, question: Question, data: xr.Dataset) -> None:
        """Write what sensors read of the motion, as a record."""
        from .. import measure, write_record

        if (sensor := self.read_sensor()) is None:
            return
        path = files.beside(f"sensors_{digest(sensor.label, sensor.rate)}")
        record = measure(data, sensor, excitation=None if self.shaker else question["excitation"])
        for ending in dict.fromkeys(("nc", *(one for one in files.formats if one != "xlsx"))):
            print(f"{write_record(record, path.with_suffix(f'.{ending}'))}: what the sensors read")

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        channels = "box_acceleration", "force1", "force2"
        driven = [name for name in channels if name in data and data[name].any()]
        yield from extents(data, f"{' '.join(driven)} a1_abs a2_abs x_rel")
        if "transient_time" in data:
            yield f"a linear transient decays within {float(data.transient_time):.3g} s"
        elif data.control_aborted.notnull():
            end = float(data.control_aborted)
            yield f"warning: the level could not be held; the control aborted at {end:.4g} s"
        yield from impact_lines(data)


MASSES = {"box_acceleration": "box", "acceleration1": "mass 1", "acceleration2": "mass 2"}


def peak_cells(data: xr.Dataset, values: xr.DataArray, unit: str) -> list[str]:
    """Return each channel's largest value with the frequency, and the time, at which it is."""
    cells = []
    for channel in values.channel.values:
        flat = values.sel(channel=channel).stack(every=[d for d in values.dims if d != "channel"])
        peak = flat.isel(every=int(flat.fillna(-1.0).values.argmax()))
        size = text_of(data, peak, unit, ".4g").removesuffix(" 1")
        when = f", {float(peak.time):.4g} s" if "time" in peak.coords else ""
        cells.append(f"{size} at {text_of(data, peak.frequency, 'Hz', '.5g')}{when}")
    return cells


def columns_of_analysis(name: str, data: xr.Dataset) -> Columns:
    """Return the columns of the table that is printed of an analysis, a row for each channel."""
    if name in ("orders", "harmonics"):  # of the box they are those of the excitation
        data = data.drop_sel(channel="box_acceleration", errors="ignore")
    columns: Columns = {"channel": [MASSES[str(channel)] for channel in data.channel.values]}
    if name == "frf":
        h1 = data.magnitude.sel(estimator="H1").where(data.excited > 0)
        columns["largest |H1|"] = peak_cells(data, h1, str(data.magnitude.units))
        at = {"frequency": h1.fillna(-1.0).argmax("frequency")}
        of_peak = data[["random_error", "coherence"]].isel(at)
        medians = data.coherence.where(data.excited > 0).median("frequency")
        return columns | columns_of(of_peak.assign(median=medians), "random_error coherence median")
    if name == "psd":
        largest = peak_cells(data, data.psd, "m2/s4/Hz")
        columns["largest density"] = [cell.replace("m2/s4", "(m/s2)2") for cell in largest]
        return columns | columns_of(data, "rms")
    if name == "orders":
        orders = data.order.values
        parts = {f"order {n:g}": data.amplitude.sel(order=n) for n in orders}
        return columns | {title: peak_cells(data, part, "m/s2") for title, part in parts.items()}
    if name == "harmonics":
        columns["largest distortion"] = peak_cells(data, data.distortion, "1")
        medians = data.distortion.median(set(data.distortion.dims) - {"channel"})
        return columns | columns_of(data.assign(median=medians), "median")
    if name == "density":
        names = "skewness skewness_error kurtosis kurtosis_error standard_deviation"
        return columns | columns_of(data, names)
    variable = {"spectrogram": "amplitude", "shock": "maximax"}[name]
    return columns | {"largest amplitude": peak_cells(data, data[variable], "m/s2")}


ANALYSES = {  # that --show names: the public function, and what it shows
    "frf": ("frf", "frequency response and coherence"),
    "psd": ("psd", "power spectral density"),
    "orders": ("track_orders", "orders of a swept sine"),
    "harmonics": ("harmonics", "harmonics and their distortion"),
    "spectrogram": ("spectrogram", "spectra over the time"),
    "shock": ("shock_spectrum", "shock response spectrum"),
    "density": ("probability_density", "probability density, skewness"),
}
SHOWN = ", ".join(f"{name} ({text})" for name, (_, text) in ANALYSES.items())


def analyse(name: str, record: xr.Dataset, path: Path, settings: Mapping[str, Any]) -> xr.Dataset:
    """Call the public function of an analysis on a record; errors begin with the file's name."""
    import orchestrate

    try:
        result: xr.Dataset = getattr(orchestrate, ANALYSES[name][0])(record, **settings)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return result


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
    begin: float | None = option("time it begins at, s", name="--from")
    to: float | None = option("time it ends at, s")


class Analyse(
    AnalysedRecords, OfSensors, InColumns, Reading, Settings, InUnits, Formats, InFolder, Command
):
    """What an analyser shows of a record: responses, spectra, orders, shock spectra."""

    examples = """
  {program} analyse results/shake.nc --show frf,psd --resolution 0.5
  {program} analyse swept.nc --label delaminated --beside bonded=whole.nc --show orders,harmonics
  {program} analyse swept.nc --sensor 2000 --beside measured=bench.csv --show orders
  {program} analyse measured.csv --unit g --channels time=0,base=3,face1=4
  {program} analyse run.wav --scale 500 --show spectrogram,density --from 2 --to 30
  {program} analyse shock.nc --show shock --damping 0.05 --format nc,csv"""

    def __call__(self) -> None:
        from ..files import open_folder
        from ..running.store import write_netcdf
        from ..show.analysis import draw

        names = parse_endings("--show", self.show, tuple(ANALYSES))
        Files.from_options(self, "", fresh=True)  # before records are read
        settings = self.settings_by_analysis(names)
        paths = self.paths_by_label()
        whole = {label: self.read_record_file(path) for label, path in paths.items()}
        self.warn_without_sensor(whole)
        records = {label: self.cut(record, paths[label]) for label, record in whole.items()}
        for label, record in records.items():
            if note := unit_note(record.attrs):
                print(f"{paths[label]}: {note}")
        units = self.read_record_units()
        reading: list[Any] = [self.begin, self.to, *self.given(OfSensors).values()]
        reading += self.given(InColumns, Reading).items()
        for name in names:
            results = {
                label: analyse(name, record, paths[label], settings[name])
                for label, record in records.items()
            }
            shown = {label: with_units(data, units) for label, data in results.items()}
            for label, data in shown.items():
                print(f"{f'{label}: ' if label else ''}{ANALYSES[name][1]}")
                print(*table(columns_of_analysis(name, data)), sep="\n")
            self.print_units_note(*shown.values())
            read = {label: str(path) for label, path in paths.items()}
            stem = f"analyse_{name}_{self.record.stem}_{digest(read, settings[name], *reading)}"
            open_folder(self.output)
            for label, data in results.items():
                words = "".join(letter if letter.isalnum() else "-" for letter in label)
                ending = f"_{words}" if len(results) > 1 else ""
                files = Files.from_options(self, f"{stem}{ending}", fresh=True)
                write_netcdf(data, files.result)
                files.write(shown[label])
            (label, first), *others = shown.items()
            picture = Files.from_options(self, stem, fresh=True)
            picture.write_pictures(partial(draw, first, label, dict(others)))

    def warn_without_sensor(self, records: Mapping[str, xr.Dataset]) -> None:
        """Warn if simulated accelerations without impulses are compared with measured ones.

        Raise where sensors are given, and no motion is simulated.
        """
        simulated = [label for label, record in records.items() if "impulse" in record]
        if self.sensor is not None and not simulated:
            raise InputError(
                f"--sensor {self.sensor}: of simulated motions; expected a result of shake, or a "
                "record without it"
            )
        if self.sensor is None and 0 < len(simulated) < len(records):
            warnings.warn(
                f"{', '.join(simulated)}: accelerations between impacts, compared with a record "
                "whose sensors feel the impulses too; --sensor HZ:RATE compares like with like",
                stacklevel=2,
            )

    def settings_by_analysis(self, names: tuple[str, ...]) -> dict[str, dict[str, Any]]:
        """Return each analysis's keywords; raise for an option that none of them takes."""
        chosen = self.given(Settings)
        takes = {name: arguments_of(function) for name, (function, _) in ANALYSES.items()}
        for one in chosen:
            owners = [name for name in takes if one in takes[name]]
            if not set(owners) & set(names):
                raise InputError(f"--{one}: expected only with --show {' or '.join(owners)}")
        return {name: {o: chosen[o] for o in chosen if o in takes[name]} for name in names}

    def paths_by_label(self) -> dict[str, Path]:
        """Return a dict from label to record file, from FILE and ``--beside``; FILE comes first."""
        label = self.label or (self.record.stem if self.beside else "")
        beside = read_pairs("--beside", self.beside, "LABEL=FILE, such as bonded=whole.nc")
        if label in beside:
            expected = "expected another label"
            raise InputError(
                f"--beside {label}={beside[label]}: a second record {label}; {expected}"
            )
        return {label: self.record, **{name: Path(path) for name, path in beside.items()}}

    def cut(self, record: xr.Dataset, path: Path) -> xr.Dataset:
        """Apply ``--sensor`` to a simulated record; cut it from ``--from`` to ``--to``."""
        from .. import measure

        if (sensor := self.read_sensor()) is not None and "impulse" in record:
            record = measure(record, sensor)
        begin, end = self.begin, self.to
        if "time" not in record.coords or begin is end is None:
            return record
        part = record.sel(time=slice(begin, end))
        if not part.sizes["time"]:
            ends = f"{float(record.time[0]):.6g} to {float(record.time[-1]):.6g} s"
            raise InputError(f"{path}: nothing between --from and --to; it has {ends}")
        return part

    def read_record_file(self, path: Path) -> xr.Dataset:
        """Read a record from a file of any format."""
        from .. import read_record

        if path.suffix.lower() == ".nc":
            stored = read_earlier_result("FILE" if path == self.record else "--beside", path)
            units = {stored[name].attrs.get("units", "m/s2") for name in MASSES if name in stored}
            return stored if units <= {"m/s2"} else read_record(path)
        reading = self.given(InColumns, Reading)
        if path.suffix.lower() != ".wav":  # the scale is of the others
            reading.pop("scale", None)
        return read_record(path, **reading)
