"""What commands share of how it is computed and where it goes: files, pictures, FMUs, processes."""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import re
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import plain_int

if TYPE_CHECKING:
    import xarray as xr

    from ..running.options import Running
    from ..structures import Structure

FORMATS = ("nc", "csv", "mat", "xlsx")
PLOTS = ("png", "pdf", "svg")
DIGITS = 6  # of the digest in a file's name
MOMENT = 1.0  # s: after so much computing, a picture is prepared beside it


# -- options --------------------------------------------------------------------------------------


def add_results(parser: argparse.ArgumentParser, store: bool = True, several: bool = False) -> None:
    """What is written, where results go, and how they are computed.

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
    """Where results go, and how they are computed.

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
    """What is written: ``--format``, ``--plot``, and ``--store`` where there is one result."""
    option = parser.add_argument_group("files").add_argument
    if store:
        text = "the result's own file (default: a name of its own for each question in --output)"
        option("--store", type=Path, metavar="FILE.nc", help=text)
    text = f"also as {', '.join(FORMATS[1:])}, a list; nc is always written (default: nc)"
    option("--format", default="nc", metavar="A,B,...", help=text)
    text = f"pictures: {', '.join(PLOTS)}, a list, or none (default: png)"
    option("--plot", default="png", metavar="A,B,...", help=text)


def running_of(arguments: argparse.Namespace, store: Path | None = None) -> Running:
    """Keywords of the public API from the options."""
    running: Running = {
        "jobs": arguments.jobs,
        "cluster": arguments.cluster,
        "force": arguments.force,
        "keep_stale": arguments.keep_stale,
        "fmu": own_fmus(arguments.fmu) if isinstance(arguments.fmu, list) else arguments.fmu,
        "build_folder": arguments.build_folder,
    }
    if store is not None:
        running["store"] = store
    return running


def own_fmus(paths: list[Path] | None) -> dict[str, Path]:
    """The user's own FMUs by the models that they say they are.

    Raises
    ------
    InputError
    """
    from ..access import MODELS, describe

    found: dict[str, Path] = {}
    for path in paths or []:
        name = describe(path).name
        if name not in MODELS:
            raise InputError(f"FMU {path}: model {name}; expected {' or '.join(MODELS)}")
        if name in found:
            raise InputError(f"FMU {path}: a second {name}, after {found[name]}; expected one")
        found[name] = path
    return found


def endings_of(option: str, text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Endings of files from a list such as ``png,pdf``.

    Raises
    ------
    InputError
    """
    if text == "none":
        return ()
    names = tuple(dict.fromkeys(part.strip() for part in text.split(",")))
    for name in names:
        if name not in known:
            expected = ", ".join(known)
            raise InputError(f"{option} {text}: {name or 'nothing'}; expected some of {expected}")
    return names


def check_output(folder: Path, option: str = "--output") -> None:
    """See that a folder can be written, or made, without making it yet.

    Raises
    ------
    InputError
    """
    place = next((place for place in (folder, *folder.parents) if place.exists()), Path())
    if not (place.is_dir() and os.access(place, os.W_OK)):
        reason = "not writable" if place.is_dir() else f"{place} is no folder"
        raise InputError(f"{option} {folder}: {reason}; expected a folder that can be written")


# -- names ----------------------------------------------------------------------------------------


def name_of(command: str, structure: Structure, question: Mapping[str, Any]) -> str:
    """A file's name: readable, and another one for every other question.

    Parameters
    ----------
    command : str
    structure : Structure
    question : mapping
        Keywords of the public function.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> name_of("simulate", Structure(), {"eta": 0.4, "periods": 2})
    'simulate_e0.7_D0.005_eta0.4_7ed5cb'
    >>> name_of("branch", Structure(), {"over": "frequency", "limits": (31.4159265, 62.831853)})
    'branch_e0.7_D0.005_5-10Hz_e71461'
    """
    turns = question.get("over") == "frequency"  # then its values and limits are in Hz too
    named = ("frequency" if turns and name in ("values", "limits") else name for name in question)
    told = zip(named, question.values(), strict=True)
    parts = [command, structure.label(), *(brief(*item) for item in told)]
    return "_".join(filter(None, [*parts, digest(structure.parameters(), question)]))


def digest(*told: Any) -> str:
    """A few letters that differ where what is told differs."""

    def other(value: Any) -> str:  # a stored result is the question that it answers
        identity = getattr(value, "attrs", {}).get("identity")
        return json.dumps(json.loads(identity)["question"]) if identity else repr(value)

    text = json.dumps(told, sort_keys=True, default=other)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def brief(name: str, value: Any) -> str:
    """What a file's name says of a keyword: the frequency, what varies, the direction."""
    from ..structures import PARAMETERS

    if name in ("direction", "over") and value != "frequency":
        return "-".join(value) if isinstance(value, tuple) else str(value)
    if name == "excitation":  # of the laboratory
        return re.sub(r"[^a-zA-Z0-9.]+", "-", value.label)
    if name in ("bifurcation", "switch"):
        return "" if value is None else f"{name}{value}"
    varied = isinstance(value, tuple) and name in (*PARAMETERS, "values", "limits")
    if name not in ("eta", "frequency") and not varied:
        return ""
    hertz = 1.0 / (2.0 * math.pi) if name == "frequency" else 1.0
    ends = (value[0], value[-1]) if isinstance(value, tuple) else (value,)
    if isinstance(ends[0], tuple):  # limits of two parameters
        return ""
    text = "-".join(f"{hertz * end:.6g}" for end in dict.fromkeys(ends))
    letters = "" if name in ("values", "limits") else name
    return f"{text}Hz" if name == "frequency" else f"{letters}{text}"


# -- files ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Files:
    """The files of one result: NetCDF, and beside it other formats and pictures.

    Attributes
    ----------
    result : Path
    formats, plots : tuple of str
        Endings.
    fresh : bool
        Whether the result is to be computed: then what stands beside it is made anew too.
    """

    result: Path
    formats: tuple[str, ...]
    plots: tuple[str, ...]
    fresh: bool

    @classmethod
    def of(cls, arguments: argparse.Namespace, name: str) -> Files:
        """Those of a question, checked before anything is computed.

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
        found = cls(result, formats, plots, arguments.force or not result.exists())
        others = [path for path in found.beside() if there(path)]
        if store is not None and others and not result.exists():
            raise InputError(
                f"{others[0]}: is there, without {result.name}, and may be of others; expected "
                "another --store, or remove it"
            )
        return found

    def beside(self) -> list[Path]:
        """Other files that this result would have, by their main names."""
        endings = (*(ending for ending in self.formats if ending != "nc"), *self.plots)
        return [self.result.with_suffix(f".{ending}") for ending in endings]

    def lacks_pictures(self) -> bool:
        """Whether a picture is to be drawn."""
        places = (self.result.with_suffix(f".{ending}") for ending in self.plots)
        return any(self.fresh or not path.exists() for path in places)

    def write(self, data: xr.Dataset, draw: Callable[[], Any] | None) -> None:
        """Write what is missing beside the result, and tell all files.

        Parameters
        ----------
        data : xarray.Dataset
        draw : callable, optional
            Gives a :class:`matplotlib.figure.Figure`; none where there is nothing to draw.
        """
        print(f"{self.result}{'' if self.fresh else ': complete already'}")
        others = exported(data, self.result, self.formats, self.fresh)
        pictures = drawn(self.result, self.plots, self.fresh, draw) if draw else []
        for path in (*others, *pictures):
            print(path)


@contextmanager
def preparing_a_picture(wanted: bool) -> Iterator[None]:
    """Import what draws while something is computed that takes longer than a moment."""

    def prepare() -> None:
        from ..figures.files import prepare

        with suppress(Exception):  # it comes again where the picture is drawn
            prepare()

    timer = threading.Timer(MOMENT, prepare)
    if wanted:
        timer.start()
    try:
        yield
    finally:
        timer.cancel()
    if wanted:
        timer.join()


def exported(data: xr.Dataset, result: Path, formats: tuple[str, ...], fresh: bool) -> list[Path]:
    """A result in other formats beside it, where it is new or they are missing.

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
    found: list[Path] = []
    for path in places:
        found += sorted(write(data, path)) if fresh or not there(path) else there(path)
    return found


def there(path: Path) -> list[Path]:
    """What there is of a file that may be several, as ``name.csv`` or ``name.eta.csv``."""
    from ..files import glob_name

    several = path.parent.glob(f"{glob_name(path.stem)}.*{path.suffix}")
    return [*([path] if path.exists() else []), *sorted(several)]


def drawn(place: Path, plots: tuple[str, ...], fresh: bool, draw: Callable[[], Any]) -> list[Path]:
    """The picture of a result in its formats, where the result is new or a picture is missing.

    Parameters
    ----------
    place : Path
        Its ending is replaced.
    plots : tuple of str
        Of ``PLOTS``.
    fresh : bool
        Whether the result is new.
    draw : callable
        Gives a :class:`matplotlib.figure.Figure`.
    """
    found = [place.with_suffix(f".{ending}") for ending in plots]
    missing = [path.suffix.lstrip(".") for path in found if fresh or not path.exists()]
    if missing:
        from ..figures.files import save

        save(draw(), place.with_suffix(""), missing)
    return found
