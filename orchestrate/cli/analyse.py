"""Command ``analyse``: FRF, PSD, orders, harmonics and other analyses of vibration records."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..units import scale_of, text_of, with_units
from .grammar import parse_orders, plain_float
from .options import Commands
from .output import (
    FORMATS,
    PLOTS,
    add_file_options,
    add_units_option,
    check_output,
    digest,
    draw_picture,
    export_formats,
    parse_endings,
    print_units_note,
    read_record_units,
    unit_note,
    units_ending,
    with_ending,
)
from .question import read_earlier_result

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} analyse results/shake.nc --show frf,psd --resolution 0.5
  {program} analyse swept.nc --label delaminated --beside bonded=whole.nc --show orders,harmonics
  {program} analyse swept.nc --sensor 2000 --beside measured=bench.csv --show orders
  {program} analyse measured.csv --unit g --columns time=0,box_acceleration=3,acceleration1=4
  {program} analyse run.wav --scale 500 --show spectrogram,density --from 2 --to 30
  {program} analyse shock.nc --show shock --damping 0.05 --format nc,csv"""
SPECTRAL = ("resolution", "window")
SWEPT = ("orders", "periods")
READING = ("unit", "columns", "sample_rate", "scale")


@dataclass(frozen=True)
class Analysis:
    """One analysis that ``--show`` names: its public function, its options and its title."""

    function: str  # of the public face
    options: tuple[str, ...]  # of the command that it takes
    text: str  # what it shows


ANALYSES = {
    "frf": Analysis("frf", (*SPECTRAL, "overlap"), "frequency response and coherence"),
    "psd": Analysis("psd", (*SPECTRAL, "overlap"), "power spectral density"),
    "orders": Analysis("track_orders", SWEPT, "orders of a swept sine"),
    "harmonics": Analysis("harmonics", ("highest", "periods"), "harmonics and their distortion"),
    "spectrogram": Analysis("spectrogram", SPECTRAL, "spectra over the time"),
    "shock": Analysis("shock_spectrum", ("damping",), "shock response spectrum"),
    "density": Analysis("probability_density", ("bins",), "probability density, skewness"),
}
MASSES = {"box_acceleration": "box", "acceleration1": "mass 1", "acceleration2": "mass 2"}
Reporter = Callable[["xr.Dataset"], Iterator[str]]


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``analyse`` with all its options."""
    text = "what an analyser shows of a record: responses, spectra, orders, shock spectra"
    parser = commands.add("analyse", run, text, EXAMPLES)
    record = "a result of shake (.nc), or a record: .csv, .txt, .uff, .unv, .mat, .wav, .nc"
    parser.add_argument("record", type=Path, metavar="FILE", help=record)
    shown = ", ".join(f"{name} ({one.text})" for name, one in ANALYSES.items())
    parser.add_argument(
        "--show", default="frf,psd", metavar="A,B,...", help=f"{shown} (default: %(default)s)"
    )
    option = parser.add_argument_group("records").add_argument
    option("--label", default="", metavar="WORDS", help="what the record is, for the picture")
    beside = "another record in the same picture; may be repeated"
    option("--beside", action="append", default=[], metavar="LABEL=FILE", help=beside)
    sensor = "of results of shake what accelerometers of this bandwidth read, with the impulses of "
    sensor += "impacts; RATE: samples a second (default: accelerations between impacts)"
    option("--sensor", metavar="HZ[:RATE]", help=sensor)
    option("--from", dest="begin", type=plain_float, metavar="S", help="time it begins at, s")
    option("--to", dest="end", type=plain_float, metavar="S", help="time it ends at, s")
    add_reading_options(parser)
    add_analysis_options(parser)
    add_units_option(parser)
    add_file_options(parser, store=False)
    option = parser.add_argument_group("results").add_argument
    folder_help = "folder of the results (default: results)"
    option("--output", type=Path, default=Path("results"), metavar="FOLDER", help=folder_help)


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Add ``--unit``, ``--columns``, ``--sample-rate``, ``--scale``: how to read record files."""
    group = parser.add_argument_group("how to read records", "what files but NetCDF may not say")
    option = group.add_argument
    option("--unit", metavar="UNIT", help="of accelerations: m/s2, g, mg ...")
    columns = "columns by name or number from 0: CHANNEL=COLUMN,... with the channels time, {}"
    names = ", ".join(MASSES)
    option("--columns", metavar="A=X,B=Y", help=columns.format(names))
    option("--sample-rate", type=plain_float, metavar="HZ", help="where there is no time")
    option("--scale", type=plain_float, metavar="X", help="m/s2 at the full scale of WAV files")


def add_analysis_options(parser: argparse.ArgumentParser) -> None:
    """Add the analyses' own options, such as ``--resolution``, ``--orders`` and ``--damping``."""
    option = parser.add_argument_group("settings").add_argument
    lines = "distance of the lines, Hz, of frf, psd and spectrogram"
    option("--resolution", type=plain_float, metavar="HZ", help=lines)
    option("--window", metavar="WORD", help="hann (default), flattop, boxcar and others")
    option("--overlap", type=plain_float, metavar="X", help="part of a segment, of frf and psd")
    orders = "orders 1 to N, or a list of them such as 0.5,1,2 (default: 3)"
    option("--orders", metavar="N", help=orders)
    option("--highest", type=plain_float, metavar="N", help="order of harmonics (default: 5)")
    periods = "of the excitation, in a window of orders and harmonics (default: 16)"
    option("--periods", type=plain_float, metavar="X", help=periods)
    ratio = "of the oscillators of shock (default: 0.05)"
    option("--damping", type=plain_float, metavar="X", help=ratio)
    option("--bins", type=plain_float, metavar="N", help="of density (default: 100)")


def run(arguments: argparse.Namespace) -> None:
    """Run ``analyse``: compute the chosen analyses of all records; print, store and draw them."""
    names = parse_endings("--show", arguments.show, tuple(ANALYSES))
    formats = parse_endings("--format", arguments.format, FORMATS)
    plots = parse_endings("--plot", arguments.plot, PLOTS)
    settings = keywords_by_analysis(arguments, names)
    check_output(arguments.output)
    paths = paths_by_label(arguments)
    records = {label: read_cut_record(arguments, path) for label, path in paths.items()}
    for label, record in records.items():
        if note := unit_note(record.attrs):
            print(f"{paths[label]}: {note}")
    warn_without_sensor(arguments, records)
    units = read_record_units(arguments)
    for name in names:
        results = {
            label: analyse(ANALYSES[name], record, paths[label], settings[name])
            for label, record in records.items()
        }
        shown = {label: with_units(data, units) for label, data in results.items()}
        print_result(name, shown)
        print_units_note(arguments, *shown.values())
        read = {label: str(path) for label, path in paths.items()}
        digits = digest(read, settings[name], *record_options(arguments))
        stem = f"analyse_{name}_{arguments.record.stem}_{digits}"
        place = arguments.output / f"{stem}.nc"
        write_files(place, results, shown, formats, plots, units_ending(arguments))


def warn_without_sensor(arguments: argparse.Namespace, records: Mapping[str, xr.Dataset]) -> None:
    """Warn if simulated accelerations without impulses are compared with measured ones."""
    simulated = [label for label, record in records.items() if "impulse" in record]
    if arguments.sensor is None and 0 < len(simulated) < len(records):
        warnings.warn(
            f"{', '.join(simulated)}: accelerations between impacts, beside a record whose sensors "
            "feel the impulses too; --sensor HZ:RATE compares like with like",
            stacklevel=2,
        )


def record_options(arguments: argparse.Namespace) -> list[Any]:
    """Return the options' values that decide how a record is read and cut, for a file name."""
    return [getattr(arguments, name) for name in ("begin", "end", "sensor", *READING)]


def keywords_by_analysis(
    arguments: argparse.Namespace, names: tuple[str, ...]
) -> dict[str, dict[str, Any]]:
    """Return a dict of keywords for each analysis; raise for an option that none of them takes."""
    owned = {option for one in ANALYSES.values() for option in one.options}
    chosen = {option for option in owned if getattr(arguments, option) is not None}
    for option in sorted(chosen):
        owners = [name for name, one in ANALYSES.items() if option in one.options]
        if not set(owners) & set(names):
            raise InputError(f"--{option}: expected with --show {' or '.join(owners)} alone")
    settings = {
        name: {o: getattr(arguments, o) for o in ANALYSES[name].options if o in chosen}
        for name in names
    }
    if arguments.orders is not None and "orders" in names:
        settings["orders"]["orders"] = parse_orders("--orders", arguments.orders)
    return settings


def paths_by_label(arguments: argparse.Namespace) -> dict[str, Path]:
    """Return a dict from label to record file, from FILE and ``--beside``; FILE comes first."""
    label = arguments.label or (arguments.record.stem if arguments.beside else "")
    paths = {label: arguments.record}
    for text in arguments.beside:
        name, equals, path = text.partition("=")
        if not (name and equals and path):
            raise InputError(f"--beside {text}: expected LABEL=FILE, such as bonded=whole.nc")
        if name in paths:
            raise InputError(f"--beside {text}: a second record {name}; expected another label")
        paths[name] = Path(path)
    return paths


def read_cut_record(arguments: argparse.Namespace, path: Path) -> xr.Dataset:
    """Read a record file and keep its samples between ``--from`` and ``--to``."""
    record = read_record_file(arguments, path)
    if "time" not in record.coords or arguments.begin is arguments.end is None:
        return record
    part = record.sel(time=slice(arguments.begin, arguments.end))
    if not part.sizes["time"]:
        ends = f"{float(record.time[0]):.6g} to {float(record.time[-1]):.6g} s"
        raise InputError(f"{path}: nothing between --from and --to; it has {ends}")
    return part


def read_record_file(arguments: argparse.Namespace, path: Path) -> xr.Dataset:
    """Read a record from a file of any format; apply ``--sensor`` to a simulated one."""
    from .. import read_record

    if path.suffix.lower() == ".nc":
        stored = read_earlier_result("FILE" if path == arguments.record else "--beside", path)
        units = {stored[name].attrs.get("units", "m/s2") for name in MASSES if name in stored}
        if arguments.sensor is not None and "impulse" in stored:
            return apply_sensor(stored, arguments.sensor)
        return stored if units <= {"m/s2"} else read_record(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file; expected a record")
    reading = {n: getattr(arguments, n) for n in READING if getattr(arguments, n) is not None}
    if path.suffix.lower() != ".wav":  # the scale is of the others
        reading.pop("scale", None)
    if "columns" in reading:
        reading["columns"] = parse_columns(reading["columns"])
    return read_record(path, **reading)


def apply_sensor(history: xr.Dataset, text: str) -> xr.Dataset:
    """Return what accelerometers of ``--sensor HZ[:RATE]`` would read of a simulated motion."""
    from .. import Sensor, measure

    try:
        numbers = [plain_float(part) for part in text.split(":")]
    except ValueError:
        numbers = []
    if not 1 <= len(numbers) <= 2:
        raise InputError(f"--sensor {text}: expected HZ or HZ:RATE, such as 10000:25600")
    rate = numbers[1] if len(numbers) > 1 else None
    return measure(history, Sensor(bandwidth=numbers[0], sample_rate=rate))


def parse_columns(text: str) -> dict[str, str | int]:
    """Parse ``CHANNEL=COLUMN,...`` into a dict from channel to column name or number."""
    pairs = [part.partition("=") for part in text.split(",")]
    if not all(name.strip() and equals and column.strip() for name, equals, column in pairs):
        raise InputError(f"--columns {text}: expected CHANNEL=COLUMN,... such as acceleration1=4")
    plain = ((name.strip(), column.strip()) for name, _, column in pairs)
    return {name: int(column) if column.isdecimal() else column for name, column in plain}


def analyse(
    analysis: Analysis, record: xr.Dataset, path: Path, settings: Mapping[str, Any]
) -> xr.Dataset:
    """Call the public function of an analysis on a record; errors begin with the file's name."""
    import orchestrate

    try:
        result: xr.Dataset = getattr(orchestrate, analysis.function)(record, **settings)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return result


def write_files(
    place: Path,
    results: dict[str, xr.Dataset],
    shown: dict[str, xr.Dataset],
    formats: tuple[str, ...],
    plots: tuple[str, ...],
    units: str = "",
) -> None:
    """Write each record's result to NetCDF and other formats, and one picture of all; print
    paths.
    """
    from ..figures.analysis import draw
    from ..files import open_folder
    from ..running.store import write_netcdf

    open_folder(place.parent)
    for label, data in results.items():
        words = "".join(letter if letter.isalnum() else "-" for letter in label)
        ending = f"_{words}" if len(results) > 1 else ""
        path = write_netcdf(data, place.with_name(f"{place.stem}{ending}.nc"))
        table = with_ending(path, units)
        for file in (path, *export_formats(shown[label], table, formats, fresh=True)):
            print(file)
    (label, first), *others = shown.items()
    picture = with_ending(place, units)
    for file in draw_picture(picture, plots, True, lambda: draw(first, label, dict(others))):
        print(file)


# -- what is said ---------------------------------------------------------------------------------


def print_result(name: str, results: dict[str, xr.Dataset]) -> None:
    """Print an analysis' title and its most important numbers, a line per record and channel."""
    print(f"{ANALYSES[name].text}:")
    for label, data in results.items():
        for line in REPORTERS[name](data):
            print(f"  {label + ': ' if label else ''}{line}")


def iterate_channels(data: xr.Dataset, box: bool = True) -> Iterator[tuple[str, xr.Dataset]]:
    """Yield each channel's printed name and part of a result; no base if not ``box``."""
    for channel in map(str, data.channel.values):
        if box or channel != "box_acceleration":
            yield MASSES[channel], data.sel(channel=channel)


def at_maximum(values: xr.DataArray) -> xr.DataArray:
    """Return the entry of an array with the largest value, as a scalar with its coordinates."""
    flat = values.stack(every=values.dims)
    return flat.isel(every=int(flat.fillna(-1.0).values.argmax()))


def format_frequency(data: xr.Dataset, peak: xr.Dataset | xr.DataArray) -> str:
    """Format a value's frequency coordinate as text in the result's display unit."""
    return text_of(data, peak.frequency, "Hz", ".5g")


def frf_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a line per channel: the FRF's peak, its frequency, random error and coherence."""
    if not data.excited.any():
        yield "the box does not move"
        return
    for name, part in iterate_channels(data):
        band = part.where(data.excited > 0, drop=True)
        peak = band.isel(frequency=int(band.magnitude.sel(estimator="H1").values.argmax()))
        height = float(peak.magnitude.sel(estimator="H1"))
        yield (
            f"{name}: |H1| has its largest value {height:.4g} at {format_frequency(data, peak)}, "
            f"random error {100.0 * float(peak.random_error):.2g} %; coherence "
            f"{float(peak.coherence):.4f} there, {float(band.coherence.median()):.4f} in the median"
        )


def psd_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a line per channel: rms, largest spectral density and its frequency."""
    for name, part in iterate_channels(data):
        at = text_of(data, part.psd.idxmax(), "Hz", ".5g")
        rms = text_of(data, part.rms, "m/s2", ".4g")
        density = text_of(data, part.psd.max(), "m2/s4/Hz", ".4g").replace("m2/s4", "(m/s2)2")
        yield f"{name}: {rms} rms, largest density {density} at {at}"


def order_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a line per channel: each order's largest amplitude and its frequency."""
    for name, part in iterate_channels(data, box=False):
        peaks, (unit_size, unit) = [], scale_of(data, "m/s2")
        for order in map(float, part.order.values):
            peak = at_maximum(part.amplitude.sel(order=order))
            size = f"{float(peak) / unit_size:.4g}"
            peaks.append(f"order {order:g} {size} at {format_frequency(data, peak)}")
        yield f"{name}: largest amplitudes in {unit}: {', '.join(peaks)}"


def harmonic_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a line per channel: median and largest harmonic distortion, and where it is largest."""
    for name, part in iterate_channels(data, box=False):
        peak, usual = at_maximum(part.distortion), 100.0 * float(part.distortion.median())
        yield (
            f"{name}: distortion {usual:.3g} % in the median, {100.0 * float(peak):.3g} % at the "
            f"most, at {format_frequency(data, peak)}"
        )


def spectrogram_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a line per channel: the spectrogram's largest amplitude, its frequency and time."""
    for name, part in iterate_channels(data):
        peak = at_maximum(part.amplitude)
        yield (
            f"{name}: largest amplitude {text_of(data, peak, 'm/s2', '.4g')} at "
            f"{format_frequency(data, peak)}, {float(peak.time):.4g} s"
        )


def shock_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a line per channel: the shock spectrum's largest response and its frequency."""
    for name, part in iterate_channels(data):
        peak = at_maximum(part.maximax)
        size = text_of(data, peak, "m/s2", ".4g")
        yield f"{name}: largest response {size} at {format_frequency(data, peak)}"


def density_lines(data: xr.Dataset) -> Iterator[str]:
    """Yield a line per channel: skewness and kurtosis with their errors, and standard deviation."""
    for name, part in iterate_channels(data):
        yield (
            f"{name}: skewness {float(part.skewness):.3f} +- {float(part.skewness_error):.3f}, "
            f"kurtosis {float(part.kurtosis):.3f} +- {float(part.kurtosis_error):.3f}, standard "
            f"deviation {text_of(data, part.standard_deviation, 'm/s2', '.4g')}"
        )


REPORTERS: dict[str, Reporter] = {
    "frf": frf_lines,
    "psd": psd_lines,
    "orders": order_lines,
    "harmonics": harmonic_lines,
    "spectrogram": spectrogram_lines,
    "shock": shock_lines,
    "density": density_lines,
}
