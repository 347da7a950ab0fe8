"""Output options of all commands, and the files they write: names, tables, pictures."""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .grammar import plain_int

if TYPE_CHECKING:
    import xarray as xr

    from ..running.options import Running
    from ..structures import Structure
    from ..units import Units

FORMATS = ("nc", "csv", "mat", "xlsx")
PLOTS = ("png", "pdf", "svg")
DIGITS = 6  # of the digest in a file's name
PREPARE_AFTER = 1.0  # s: after so much computing, a picture is prepared beside it


# -- options --------------------------------------------------------------------------------------


def add_result_options(
    parser: argparse.ArgumentParser, store: bool = True, several: bool = False
) -> None:
    """Add the options of files (``--format`` ...) and of running (``--jobs`` ...)."""
    add_file_options(parser, store)
    add_running_options(parser, several=several)


def add_running_options(
    parser: argparse.ArgumentParser,
    output: Path | None = Path("results"),
    shown: str = "results",
    several: bool = False,
) -> None:
    """Add ``--output``, ``--force``, ``--jobs``, ``--cluster``, ``--fmu`` and the like."""
    option = parser.add_argument_group("results and running").add_argument
    text = f"folder of the results (default: {shown})"
    option("--output", type=Path, default=output, metavar="FOLDER", help=text)
    option("--force", action="store_true", help="compute anew what is there already")
    stale = "take results that older code or another FMU has made"
    option("--keep-stale", action="store_true", help=stale)
    option("--jobs", type=plain_int, metavar="N", help="processes at once (default: all cores)")
    cluster = "compute on the workers of a Dask scheduler, such as tcp://host:8786"
    option("--cluster", metavar="ADDRESS", help=cluster)
    own = "own FMU (default: the one of the present sources)"
    more: dict[str, Any] = {"action": "append"} if several else {}
    option("--fmu", type=Path, metavar="FILE", help=own + "; may be repeated" * several, **more)
    build_help = "where FMUs are looked for and exported to"
    option("--build-folder", type=Path, metavar="FOLDER", help=build_help)


def add_file_options(parser: argparse.ArgumentParser, store: bool = True) -> None:
    """Add ``--format`` and ``--plot``, and ``--store`` for a single result."""
    option = parser.add_argument_group("files").add_argument
    if store:
        text = "the result's own file (default: a name of its own for each question in --output)"
        option("--store", type=Path, metavar="FILE.nc", help=text)
    text = f"also as {', '.join(FORMATS[1:])}, a list; nc is always written (default: nc)"
    option("--format", default="nc", metavar="A,B,...", help=text)
    text = f"pictures: {', '.join(PLOTS)}, a list, or none (default: png)"
    option("--plot", default="png", metavar="A,B,...", help=text)


def add_units_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--units``: display units of prints, pictures and tables."""
    text = (
        "of prints, pictures, tables and their names: Hz, rpm, rad/s or eta; m, mm or um; m/s2 or "
        "g; s or periods, a list such as Hz,mm,g (default: as the question is asked; nc is in SI)"
    )
    option = parser.add_argument_group("units").add_argument
    option("--units", default="", metavar="A,B,...", help=text)


def read_units(arguments: argparse.Namespace) -> Units:
    """Return the display units of ``--units``; none chosen where a command lacks the option."""
    from ..units import Units

    return Units.from_text(getattr(arguments, "units", ""), "--units")


def read_record_units(arguments: argparse.Namespace) -> Units:
    """Return the units of ``--units``; accelerations by default in the record's ``--unit``."""
    from ..units import FACTORS, Units

    own = arguments.unit if arguments.unit in FACTORS["acceleration"] else ""
    return read_units(arguments).with_defaults(Units(acceleration=own))


def unit_note(attributes: Mapping[Any, Any]) -> str:
    """Return a line that says that ``--unit`` was taken in place of a file's unit; or nothing."""
    own = attributes.get("unit_in_file", "")
    used = attributes.get("unit", "")
    return f"--unit {used} was used, although the file says {own}" if own else ""


def refuse_units(arguments: argparse.Namespace, reason: str) -> None:
    """Raise if ``--units`` is given to a command whose output has no units."""
    if str(read_units(arguments)):
        raise InputError(f"--units {arguments.units}: {reason}; expected the command without it")


def units_ending(arguments: argparse.Namespace) -> str:
    """Return the units of ``--units`` as an ending of file names: ``Hz-mm-g``."""
    return str(read_units(arguments)).replace(", ", "-").replace("/", "_")


def with_ending(path: Path, *endings: str) -> Path:
    """Return a path with endings joined to its stem by ``_``; empty ones are left out."""
    return path.with_stem("_".join(filter(None, [path.stem, *endings])))


def print_units_note(arguments: argparse.Namespace, *answers: xr.Dataset) -> None:
    """Print a note if ``--units`` changes none of the numbers of some results."""
    from ..units import scale_of

    kinds = {
        str(array.attrs.get("units", "1"))
        for data in answers
        for array in data.variables.values()
        if array.dtype.kind == "f"
    }
    units = read_units(arguments)
    changed = any(scale_of(data, kind)[1] != kind for data in answers for kind in kinds)
    if units.words and not changed and kinds.isdisjoint(units.words):
        words = ", ".join(sorted(kinds - {"1"}))
        print(f"--units {units}: these have no such numbers, only {words}")


def read_running_options(arguments: argparse.Namespace, store: Path | None = None) -> Running:
    """Return ``jobs``, ``cluster``, ``force``, ``fmu`` and ``store`` as keywords of the API."""
    running: Running = {
        "jobs": arguments.jobs,
        "cluster": arguments.cluster,
        "force": arguments.force,
        "keep_stale": arguments.keep_stale,
        "fmu": user_fmus(arguments.fmu) if isinstance(arguments.fmu, list) else arguments.fmu,
        "build_folder": arguments.build_folder,
    }
    if store is not None:
        running["store"] = store
    return running


def user_fmus(paths: list[Path] | None) -> dict[str, Path]:
    """Return a dict from model name to the user's FMU file; raise for unknown or double ones."""
    from ..access import MODELS, describe

    fmus: dict[str, Path] = {}
    for path in paths or []:
        name = describe(path).name
        if name not in MODELS:
            raise InputError(f"FMU {path}: model {name}; expected {' or '.join(MODELS)}")
        if name in fmus:
            raise InputError(f"FMU {path}: a second {name}, after {fmus[name]}; expected one")
        fmus[name] = path
    return fmus


def parse_endings(option: str, text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Parse a list such as ``png,pdf`` into a tuple of known names; ``none`` is empty."""
    if text == "none":
        return ()
    names = tuple(dict.fromkeys(part.strip() for part in text.split(",")))
    for name in names:
        if name not in known:
            expected = ", ".join(known)
            raise InputError(f"{option} {text}: {name or 'nothing'}; expected some of {expected}")
    return names


def check_output(folder: Path, option: str = "--output") -> None:
    """Raise unless a folder is writable or could be made; it is not made yet."""
    existing = next(
        (existing for existing in (folder, *folder.parents) if existing.exists()), Path()
    )
    if not (existing.is_dir() and os.access(existing, os.W_OK)):
        reason = "not writable" if existing.is_dir() else f"{existing} is no folder"
        raise InputError(f"{option} {folder}: {reason}; expected a folder that can be written")


def check_file_options(arguments: argparse.Namespace) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Check ``--format``, ``--plot``, ``--output``; return formats and picture endings."""
    formats = parse_endings("--format", arguments.format, FORMATS)
    plots = parse_endings("--plot", arguments.plot, PLOTS)
    check_output(arguments.output)
    return formats, plots


# -- names ----------------------------------------------------------------------------------------


def result_name(
    command: str, structure: Structure, question: Mapping[str, Any], unit: str = "Hz"
) -> str:
    """Return a result's file name: command, structure, main arguments and a digest of all.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> result_name("simulate", Structure(), {"eta": 0.4, "periods": 2})
    'simulate_e0.7_D0.005_eta0.4_7ed5cb'
    >>> result_name("branch", Structure(), {"over": "frequency", "limits": (31.4159265, 62.831853)})
    'branch_e0.7_D0.005_5-10Hz_e71461'
    """
    in_hertz = question.get("over") == "frequency"  # then its values and limits are in Hz too
    named = (
        "frequency" if in_hertz and name in ("values", "limits") else name for name in question
    )
    pairs = zip(named, question.values(), strict=True)
    parts = [
        command,
        structure.label(),
        *(argument_in_file_name(*item, unit, structure) for item in pairs),
    ]
    return "_".join(filter(None, [*parts, digest(nonzero_parameters(structure), question)]))


def nonzero_parameters(structure: Structure) -> dict[str, float]:
    """Return a structure's parameters by name; those added in later versions unless 0."""
    from ..structures.ranges import ADDED

    parameters = structure.parameters()
    return {n: v for n, v in parameters.items() if n not in ADDED or v != 0.0}


def digest(*arguments: Any) -> str:
    """Return the first hexadecimal digits of a SHA-256 over arguments, for a file name."""

    def other(value: Any) -> str:  # a stored result is the question that it answers
        """Return the text for a value JSON cannot hold: a dataset's question, or its repr."""
        identity = getattr(value, "attrs", {}).get("identity")
        return json.dumps(json.loads(identity)["question"]) if identity else repr(value)

    text = json.dumps(arguments, sort_keys=True, default=other)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def argument_in_file_name(name: str, value: Any, unit: str, structure: Structure) -> str:
    """Return how an argument appears in a file name: ends of a range, a word, or nothing."""
    from ..structures import PARAMETERS
    from ..units import FACTORS

    if name in ("direction", "over") and value != "frequency":
        return "-".join(value) if isinstance(value, tuple) else str(value)
    if name == "excitation":  # of the laboratory
        return re.sub(r"[^a-zA-Z0-9.]+", "-", value.label)
    if name in ("bifurcation", "switch"):
        return "" if value is None else f"{name}{value}"
    varied = isinstance(value, tuple) and name in (*PARAMETERS, "values", "limits")
    if name not in ("eta", "frequency") and not varied:
        return ""
    by_ratio = unit == "eta"
    scale = structure.omega if by_ratio else FACTORS["frequency"][unit]
    scale = scale if name == "frequency" else 1.0
    ends = (value[0], value[-1]) if isinstance(value, tuple) else (value,)
    if isinstance(ends[0], tuple):  # limits of two parameters
        return ""
    text = "-".join(f"{end / scale:.6g}" for end in dict.fromkeys(ends))
    letters = "" if name in ("values", "limits") else name
    if name == "frequency":
        return f"eta{text}" if by_ratio else f"{text}{unit.replace('/', '_')}"
    return f"{letters}{text}"


# -- files ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Files:
    """Paths of one result: its NetCDF file, and tables and pictures beside it."""

    result: Path
    # endings
    formats: tuple[str, ...]
    plots: tuple[str, ...]
    fresh: bool  # whether the result is to be computed: then what stands beside it is made anew too
    units: str = ""  # of `--units`: tables and pictures in these have them in their names
    over: str = ""  # suffix of the pictures' names, where other data lie over the result

    @classmethod
    def from_options(cls, arguments: argparse.Namespace, name: str, over: str = "") -> Files:
        """Return the ``Files`` of a result by the options; raise if they cannot be written."""
        formats = parse_endings("--format", arguments.format, FORMATS)
        plots = parse_endings("--plot", arguments.plot, PLOTS)
        store = getattr(arguments, "store", None)
        if store is not None and store.suffix != ".nc":
            raise InputError(f"--store {store}: expected a name that ends in .nc")
        result = store or arguments.output / f"{name}.nc"
        check_output(result.parent)
        fresh = arguments.force or not result.exists()
        files = cls(result, formats, plots, fresh, units_ending(arguments), over)
        others = [path for path in files.beside() if existing_files(path)]
        if store is not None and others and not result.exists():
            raise InputError(
                f"{others[0]} already exists but {result.name} does not; "
                "choose another --store or delete it"
            )
        return files

    def beside(self) -> list[Path]:
        """Return the paths of the tables and pictures that belong beside the NetCDF file."""
        others = [ending for ending in self.formats if ending != "nc"]
        files = [self.table_path.with_suffix(f".{ending}") for ending in others]
        return [*files, *self.picture_paths()]

    @property
    def table_path(self) -> Path:
        """Path of the result's tables, without their endings: it names the display units."""
        return with_ending(self.result, self.units)

    @property
    def picture_path(self) -> Path:
        """Path of the result's pictures, without their endings: it names units and overlay."""
        return with_ending(self.result, self.units, self.over)

    def picture_paths(self) -> list[Path]:
        """Return the paths of the result's pictures, one for each format of ``--plot``."""
        return [self.picture_path.with_suffix(f".{ending}") for ending in self.plots]

    def lacks_pictures(self) -> bool:
        """Return whether a picture has to be drawn: the result is new or a picture is missing."""
        return any(self.fresh or not path.exists() for path in self.picture_paths())

    def write(self, data: xr.Dataset, draw: Callable[[], Any] | None) -> None:
        """Write missing tables and pictures beside the NetCDF file; print the paths of all
        files.
        """
        print(f"{self.result}{'' if self.fresh else ': complete already'}")
        others = export_formats(data, self.table_path, self.formats, self.fresh)
        pictures = draw_picture(self.picture_path, self.plots, self.fresh, draw) if draw else []
        for path in (*others, *pictures):
            print(path)


@contextmanager
def importing_matplotlib(needed: bool) -> Iterator[None]:
    """Import the drawing code in a thread while the ``with`` block computes."""

    def prepare() -> None:
        """Import Matplotlib and draw a small figure; ignore any error."""
        from ..figures.files import warm_up_matplotlib

        with suppress(Exception):  # it comes again where the picture is drawn
            warm_up_matplotlib()

    timer = threading.Timer(PREPARE_AFTER, prepare)
    if needed:
        timer.start()
    try:
        yield
    finally:
        timer.cancel()
    if needed:
        timer.join()


def export_formats(
    data: xr.Dataset, result: Path, formats: tuple[str, ...], fresh: bool
) -> list[Path]:
    """Write a result as CSV, MAT or Excel if it is new or they are missing; return the paths."""
    from ..running.formats import write

    paths = [result.with_suffix(f".{ending}") for ending in formats if ending != "nc"]
    files: list[Path] = []
    for path in paths:
        files += (
            sorted(write(data, path)) if fresh or not existing_files(path) else existing_files(path)
        )
    return files


def existing_files(path: Path) -> list[Path]:
    """Return the existing files of a table that may be several: ``x.csv``, ``x.eta.csv``."""
    from ..files import escape_glob

    several = path.parent.glob(f"{escape_glob(path.stem)}.*{path.suffix}")
    return [*([path] if path.exists() else []), *sorted(several)]


def draw_picture(
    path: Path, plots: tuple[str, ...], fresh: bool, draw: Callable[[], Any]
) -> list[Path]:
    """Call ``draw`` and save its figure if new or missing; return the pictures' paths."""
    files = [path.with_suffix(f".{ending}") for ending in plots]
    missing = [file.suffix.lstrip(".") for file in files if fresh or not file.exists()]
    if missing:
        from ..figures.files import save

        save(draw(), path.with_suffix(""), missing)
    return files
