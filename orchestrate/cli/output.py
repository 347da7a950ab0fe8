"""Shared output of commands: files, pictures, FMUs, processes."""

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


def add_results(parser: argparse.ArgumentParser, store: bool = True, several: bool = False) -> None:
    """Add the options for what is written, where results go, and how they are computed.

    Parameters
    ----------
    parser : argparse.ArgumentParser
    store : bool
        Whether there is one result, which may have a file of its own.
    several : bool
        Whether FMUs of several models compute it.
    """
    add_files(parser, store)
    add_running(parser, several=several)


def add_running(
    parser: argparse.ArgumentParser,
    output: Path | None = Path("results"),
    shown: str = "results",
    several: bool = False,
) -> None:
    """Add the options for where results go, and how they are computed.

    Parameters
    ----------
    parser : argparse.ArgumentParser
    output : Path, optional
        Default of ``--output``.
    shown : str
        The same, for people.
    several : bool
        Whether FMUs of several models compute it.
    """
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
    place = "where FMUs are looked for and exported to"
    option("--build-folder", type=Path, metavar="FOLDER", help=place)


def add_files(parser: argparse.ArgumentParser, store: bool = True) -> None:
    """Add the options of what is written: ``--format``, ``--plot``, ``--store`` of one result."""
    option = parser.add_argument_group("files").add_argument
    if store:
        text = "the result's own file (default: a name of its own for each question in --output)"
        option("--store", type=Path, metavar="FILE.nc", help=text)
    text = f"also as {', '.join(FORMATS[1:])}, a list; nc is always written (default: nc)"
    option("--format", default="nc", metavar="A,B,...", help=text)
    text = f"pictures: {', '.join(PLOTS)}, a list, or none (default: png)"
    option("--plot", default="png", metavar="A,B,...", help=text)


def add_units(parser: argparse.ArgumentParser) -> None:
    """Add ``--units``."""
    text = (
        "of prints, pictures, tables and their names: Hz, rpm, rad/s or eta; m, mm or um; m/s2 or "
        "g; s or periods, a list such as Hz,mm,g (default: as the question is asked; nc is in SI)"
    )
    option = parser.add_argument_group("units").add_argument
    option("--units", default="", metavar="A,B,...", help=text)


def units_option(arguments: argparse.Namespace) -> Units:
    """Return the units of ``--units``; none where a command has no such option."""
    from ..units import Units

    return Units.from_text(getattr(arguments, "units", ""), "--units")


def record_units(arguments: argparse.Namespace) -> Units:
    """Return the units of ``--units``, accelerations as ``--unit`` has them in a record."""
    from ..units import FACTORS, Units

    own = arguments.unit if arguments.unit in FACTORS["acceleration"] else ""
    return units_option(arguments).completed(Units(acceleration=own))


def unit_note(attributes: Mapping[Any, Any]) -> str:
    """Return a line that says that ``--unit`` was taken in place of a file's unit; or nothing."""
    own = attributes.get("unit_in_file", "")
    used = attributes.get("unit", "")
    return f"--unit {used} was used, although the file says {own}" if own else ""


def refuse_units(arguments: argparse.Namespace, reason: str) -> None:
    """Refuse ``--units`` of a command that shows nothing in units.

    Raises
    ------
    InputError
    """
    if str(units_option(arguments)):
        raise InputError(f"--units {arguments.units}: {reason}; expected the command without it")


def units_ending(arguments: argparse.Namespace) -> str:
    """Return what names of tables and pictures end with: the units of ``--units``."""
    return str(units_option(arguments)).replace(", ", "-").replace("/", "_")


def with_ending(path: Path, *endings: str) -> Path:
    """Return a file's name with endings, those that are not empty."""
    return path.with_stem("_".join(filter(None, [path.stem, *endings])))


def print_units_note(arguments: argparse.Namespace, *answers: xr.Dataset) -> None:
    """Print that ``--units`` changes nothing of some answers, where that is so."""
    from ..units import scale_of

    kinds = {
        str(array.attrs.get("units", "1"))
        for data in answers
        for array in data.variables.values()
        if array.dtype.kind == "f"
    }
    units = units_option(arguments)
    changed = any(scale_of(data, kind)[1] != kind for data in answers for kind in kinds)
    if units.words and not changed and kinds.isdisjoint(units.words):
        words = ", ".join(sorted(kinds - {"1"}))
        print(f"--units {units}: these have no such numbers, only {words}")


def running_of(arguments: argparse.Namespace, store: Path | None = None) -> Running:
    """Return keywords of the public API from the options."""
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
    """Return the user's own FMUs by the model names that they give."""
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


def endings_of(option: str, text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Parse file endings such as ``png,pdf``; return them, raise at an unknown one."""
    if text == "none":
        return ()
    names = tuple(dict.fromkeys(part.strip() for part in text.split(",")))
    for name in names:
        if name not in known:
            expected = ", ".join(known)
            raise InputError(f"{option} {text}: {name or 'nothing'}; expected some of {expected}")
    return names


def check_output(folder: Path, option: str = "--output") -> None:
    """Check that a folder can be written, or made, without making it yet."""
    existing = next(
        (existing for existing in (folder, *folder.parents) if existing.exists()), Path()
    )
    if not (existing.is_dir() and os.access(existing, os.W_OK)):
        reason = "not writable" if existing.is_dir() else f"{existing} is no folder"
        raise InputError(f"{option} {folder}: {reason}; expected a folder that can be written")


# -- names ----------------------------------------------------------------------------------------


def name_of(
    command: str, structure: Structure, question: Mapping[str, Any], unit: str = "Hz"
) -> str:
    """Return a file's name: readable, and different for every other question.

    Parameters
    ----------
    command : str
    structure : Structure
    question : mapping
        Keywords of the public function.
    unit : str
        Of frequencies, as the question was asked: Hz, rpm, rad/s or eta.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> name_of("simulate", Structure(), {"eta": 0.4, "periods": 2})
    'simulate_e0.7_D0.005_eta0.4_7ed5cb'
    >>> name_of("branch", Structure(), {"over": "frequency", "limits": (31.4159265, 62.831853)})
    'branch_e0.7_D0.005_5-10Hz_e71461'
    """
    in_hertz = question.get("over") == "frequency"  # then its values and limits are in Hz too
    named = (
        "frequency" if in_hertz and name in ("values", "limits") else name for name in question
    )
    pairs = zip(named, question.values(), strict=True)
    parts = [command, structure.label(), *(brief(*item, unit, structure) for item in pairs)]
    return "_".join(filter(None, [*parts, digest(parameters_of(structure), question)]))


def parameters_of(structure: Structure) -> dict[str, float]:
    """Return a structure's parameters by name; later additions only if they are in use."""
    from ..structures.ranges import ADDED

    parameters = structure.parameters()
    return {n: v for n, v in parameters.items() if n not in ADDED or v != 0.0}


def digest(*arguments: Any) -> str:
    """Return a few letters that differ where the arguments differ."""

    def other(value: Any) -> str:  # a stored result is the question that it answers
        identity = getattr(value, "attrs", {}).get("identity")
        return json.dumps(json.loads(identity)["question"]) if identity else repr(value)

    text = json.dumps(arguments, sort_keys=True, default=other)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def brief(name: str, value: Any, unit: str, structure: Structure) -> str:
    """Return what a file's name says of a keyword: the frequency, what varies, the direction."""
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
    """Files of one result: NetCDF, and beside it other formats and pictures.

    Attributes
    ----------
    result : Path
    formats, plots : tuple of str
        Endings.
    fresh : bool
        Whether the result is to be computed: then what stands beside it is made anew too.
    units : str
        Of ``--units``: tables and pictures in these have them in their names.
    over : str
        Suffix of the pictures' names, where other data lie over the result.
    """

    result: Path
    formats: tuple[str, ...]
    plots: tuple[str, ...]
    fresh: bool
    units: str = ""
    over: str = ""

    @classmethod
    def from_options(cls, arguments: argparse.Namespace, name: str, over: str = "") -> Files:
        """Return the files of a question, checked before anything is computed.

        Raises
        ------
        InputError
            Where a folder cannot be written, a format is unknown, or the place of ``--store`` has
            files of the same name that belong to something else.
        """
        formats = endings_of("--format", arguments.format, FORMATS)
        plots = endings_of("--plot", arguments.plot, PLOTS)
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
        """Return the other files that this result would have, by their main names."""
        others = [ending for ending in self.formats if ending != "nc"]
        files = [self.shown.with_suffix(f".{ending}") for ending in others]
        return [*files, *self.pictures()]

    @property
    def shown(self) -> Path:
        """Return the result's name for tables, whose units may be others than asked in."""
        return with_ending(self.result, self.units)

    @property
    def picture(self) -> Path:
        """Return the result's name for pictures, with its own ending."""
        return with_ending(self.result, self.units, self.over)

    def pictures(self) -> list[Path]:
        """Return the paths of the result's pictures."""
        return [self.picture.with_suffix(f".{ending}") for ending in self.plots]

    def lacks_pictures(self) -> bool:
        """Return whether a picture has to be drawn."""
        return any(self.fresh or not path.exists() for path in self.pictures())

    def write(self, data: xr.Dataset, draw: Callable[[], Any] | None) -> None:
        """Write what is missing beside the result, and print all files.

        Parameters
        ----------
        data : xarray.Dataset
        draw : callable, optional
            Gives a :class:`matplotlib.figure.Figure`; none where there is nothing to draw.
        """
        print(f"{self.result}{'' if self.fresh else ': complete already'}")
        others = export_formats(data, self.shown, self.formats, self.fresh)
        pictures = draw_picture(self.picture, self.plots, self.fresh, draw) if draw else []
        for path in (*others, *pictures):
            print(path)


@contextmanager
def preparing_a_picture(needed: bool) -> Iterator[None]:
    """Import the drawing code while a long computation runs."""

    def prepare() -> None:
        from ..figures.files import prepare

        with suppress(Exception):  # it comes again where the picture is drawn
            prepare()

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
    """Write a result in other formats beside it, if it is new or they are missing.

    Parameters
    ----------
    data : xarray.Dataset
    result : Path
        Of the NetCDF file.
    formats : tuple of str
        Of ``FORMATS``.
    fresh : bool
        Whether the result is new.
    """
    from ..running.formats import write

    places = [result.with_suffix(f".{ending}") for ending in formats if ending != "nc"]
    files: list[Path] = []
    for path in places:
        files += (
            sorted(write(data, path)) if fresh or not existing_files(path) else existing_files(path)
        )
    return files


def existing_files(path: Path) -> list[Path]:
    """Return what exists of a file that may be several, as ``name.csv`` or ``name.eta.csv``."""
    from ..files import glob_name

    several = path.parent.glob(f"{glob_name(path.stem)}.*{path.suffix}")
    return [*([path] if path.exists() else []), *sorted(several)]


def draw_picture(
    path: Path, plots: tuple[str, ...], fresh: bool, draw: Callable[[], Any]
) -> list[Path]:
    """Draw the picture of a result in its formats, if the result is new or a picture is missing.

    Parameters
    ----------
    path : Path
        Its ending is replaced.
    plots : tuple of str
        Of ``PLOTS``.
    fresh : bool
        Whether the result is new.
    draw : callable
        Gives a :class:`matplotlib.figure.Figure`.
    """
    files = [path.with_suffix(f".{ending}") for ending in plots]
    missing = [file.suffix.lstrip(".") for file in files if fresh or not file.exists()]
    if missing:
        from ..figures.files import save

        save(draw(), path.with_suffix(""), missing)
    return files
