"""Options of results and how they are computed; names, tables and pictures of results."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..files import escape_glob
from ..lazy import xr
from ..units import FACTORS, Units, display_scale_of
from .command import Options, option

if TYPE_CHECKING:
    from ..running.options import Running

FORMATS = ("nc", "csv", "mat", "xlsx")
PLOTS = ("png", "pdf", "svg")
DIGITS = 6  # of the digest in a file's name
OWN_NAME = re.compile(rf"[a-z-]+_(.+)_[0-9a-f]{{{DIGITS}}}")  # of a result's file

# -- options --------------------------------------------------------------------------------------


class Reading(Options):
    """How record files are read, as keywords of ``read_record``."""

    heading = "how to read records"
    takes = "read_record: unit sensitivity sample_rate scale delay resample"
    if_given = True
    channels: str | None = option(
        "columns by name or number from 0: CHANNEL=COLUMN,... with the channels time, base, face1, "
        "face2, force1, force2; A,B,... in that order without forces; or the file that the command "
        "channels writes (default: by usual names)",
        value="FILE.toml|A=X,...|X,...",
        names=("--channels", "--columns"),
    )

    def record_display_units(self) -> Units:
        own = self.unit if self.unit in FACTORS["acceleration"] else ""
        return self.read_units().with_defaults(Units(acceleration=own))


class InUnits(Options):
    """The option of display units."""

    heading, rank = "units", 3
    units: str | None = option(
        "of prints, pictures, tables and their names: Hz, rpm, rad/s or eta; m, mm or um; m/s2 or "
        "g; s or periods, a list such as Hz,mm,g (default: as the question is asked; nc is in SI)",
        value="A,B,...",
    )

    def read_units(self) -> Units:
        """Return the display units of ``--units``; none chosen where a command lacks the option."""
        return Units.from_text(getattr(self, "units", None) or "", "--units")

    def print_units_note(self, *answers: xr.Dataset) -> None:
        """Print a note if ``--units`` changes none of the numbers of some results."""
        arrays = [one for data in answers for one in data.variables.values()]
        kinds = {str(one.attrs.get("units", "1")) for one in arrays if one.dtype.kind == "f"}
        chosen = self.read_units()
        changed = any(display_scale_of(data, kind)[1] != kind for data in answers for kind in kinds)
        if chosen.words and not changed and kinds.isdisjoint(chosen.words):
            words = ", ".join(sorted(kinds - {"1"}))
            print(f"--units {chosen}: these have no such numbers, only {words}")


class Stored(Options):
    """The option of a result's own file."""

    heading, rank = "files", 4
    store: Path | None = option(
        "the result's own file (default: a name of its own for each question in --output)",
        value="FILE.nc",
    )


class InFolder(Options):
    """The option of the folder of results."""

    heading, rank = "results and running", 5
    output: Path = option("folder of the results", Path("results"), "FOLDER")


class HowRun(Options):
    """Options of how results are computed."""

    heading, rank = "results and running", 5
    takes = "Running: force keep_stale jobs cluster fmu build_folder"

    def running_keywords(self, store: Path | None = None) -> Running:
        running: Any = self.given_options(HowRun)
        running |= {"fmu": fmus_by_model(self.fmu)} if isinstance(self.fmu, list) else {}
        return running if store is None else {**running, "store": store}


class Shown(InUnits, InFolder):
    """Options of the files written with a result; units; the folder."""

    heading, rank = "files", 4
    format: str = option(
        f"also as {', '.join(FORMATS[1:])}, a list; nc is always written", "nc", "A,B,..."
    )
    plot: str = option(f"pictures: {', '.join(PLOTS)}, a list, or none", "png", "A,B,...")
    size: str | None = option(
        "shape of the pictures for slides, such as 16:9, with larger letters", value="W:H"
    )


class Results(Shown, HowRun):
    """The same and how it is run, which end most commands' options."""


class OfBoth(Results):
    """The same of a command that runs both FMUs."""

    fmu: list[Path] = option(
        "own FMU (default: the one of the present sources); may be repeated", ()
    )


def unit_override_note(attributes: Mapping[Any, Any]) -> str:
    """Return a line that says that ``--unit`` was taken in place of a file's unit; or nothing."""
    own, used = attributes.get("unit_in_file", ""), attributes.get("unit", "")
    return f"--unit {used} was used, although the file says {own}" if own else ""


def fmus_by_model(paths: list[Path] | None) -> dict[str, Path]:
    from ..fmu import MODELS, describe

    fmus: dict[str, Path] = {}
    for path in paths or []:
        name = describe(path).name
        if name not in MODELS:
            raise InputError(f"FMU {path}: model {name}; expected {' or '.join(MODELS)}")
        if name in fmus:
            raise InputError(f"FMU {path}: a second {name}, after {fmus[name]}; expected one")
        fmus[name] = path
    return fmus


def parse_known_words(option: str, text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Parse a list such as ``png,pdf`` into a tuple of known names; ``none`` is empty."""
    names = () if text == "none" else tuple(dict.fromkeys(part.strip() for part in text.split(",")))
    for name in names:
        if name not in known:
            expected = ", ".join(known)
            raise InputError(f"{option} {text}: {name or 'nothing'}; expected some of {expected}")
    return names


def check_output_folder(folder: Path, option: str = "--output") -> None:
    """Raise unless a folder is writable or could be made; it is not made yet."""
    if folder.suffix[1:] in ("html", *FORMATS, *PLOTS) and not folder.is_dir():
        raise InputError(f"{option} {folder}: the name of a file; expected a folder")
    existing = next((one for one in (folder, *folder.parents) if one.exists()), Path())
    if not (existing.is_dir() and os.access(existing, os.W_OK)):
        reason = "not writable" if existing.is_dir() else f"{existing} is no folder"
        raise InputError(f"{option} {folder}: {reason}; expected a folder that can be written")


# -- names ----------------------------------------------------------------------------------------


def result_file_stem(command: str, sources: Sequence[Any], *asked: Any) -> str:
    stems = [Path(source).stem for source in sources]
    own = [match[1] if (match := OWN_NAME.fullmatch(stem)) else stem for stem in stems]
    return f"{command}_{'_'.join(own)}_{question_digest(*asked)}"


def question_digest(*arguments: Any) -> str:
    def to_json(value: Any) -> Any:
        if hasattr(value, "parameters"):  # of a structure, a drive
            return value.parameters()
        identity = getattr(value, "attrs", {}).get("identity")  # a stored result is its question
        return json.dumps(json.loads(identity)["question"]) if identity else repr(value)

    text = json.dumps(arguments, sort_keys=True, default=to_json)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]


def file_checksum(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


# -- files ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ResultFiles:
    """Paths of one result: its NetCDF file, and its tables and pictures."""

    result: Path
    # endings
    formats: tuple[str, ...]
    plots: tuple[str, ...]
    fresh: bool  # whether the result is to be computed: then tables and pictures are made again
    units: str = ""  # of `--units`: tables and pictures in these have them in their names
    size: str = ""  # shape of the pictures
    over: str = ""  # suffix of the pictures' names, where other data lie over the result

    @classmethod
    def from_options(
        cls, arguments: Any, name: str, over: str = "", fresh: bool | None = None
    ) -> ResultFiles:
        formats = parse_known_words("--format", arguments.format, FORMATS)
        plots = parse_known_words("--plot", arguments.plot, PLOTS)
        store = getattr(arguments, "store", None)
        if store is not None and store.suffix != ".nc":
            raise InputError(f"--store {store}: expected a name that ends in .nc")
        result = store or arguments.output / f"{name}.nc"
        check_output_folder(result.parent)
        if fresh is None:
            from ..running.journal import journal_path  # brings SQLite, which --help does without

            resumed = journal_path(result, recomputing=True).exists()
            fresh = arguments.force or resumed or not result.exists()
        chosen = str(arguments.read_units()).replace(", ", "-").replace("/", "_")
        if size := arguments.size or "":
            from ..show.figure_files import parse_slide_shape  # brings Matplotlib

            parse_slide_shape(size)
        files = cls(result, formats, plots, fresh, chosen, size, over)
        others = [*files.table_paths(), *files.picture_paths()]
        existing = [path for path in others if existing_table_files(path)]
        if store is not None and existing and not result.exists():
            text = f"{existing[0]} already exists but {result.name} does not"
            raise InputError(f"{text}; choose another --store or delete it")
        return files

    def path_with_suffixes(self, *endings: str) -> Path:
        return self.result.with_stem("_".join(filter(None, [self.result.stem, *endings])))

    def table_paths(self) -> list[Path]:
        table = self.path_with_suffixes(self.units)
        return [table.with_suffix(f".{ending}") for ending in self.formats if ending != "nc"]

    def picture_paths(self, *endings: str) -> list[Path]:
        names = self.units, self.over, *endings, self.size.replace(":", "-")
        return [self.path_with_suffixes(*names).with_suffix(f".{one}") for one in self.plots]

    def write_tables(self, data: xr.Dataset) -> None:
        """Write missing tables next to the NetCDF file; print the paths of all."""
        from ..running.formats import write

        print(f"{self.result}{'' if self.fresh else ': complete already'}")
        for path in self.table_paths():
            existing = [] if self.fresh else existing_table_files(path)
            print(*(existing or sorted(write(data, path))), sep="\n")

    def write_pictures(self, draw: Callable[[], Any], *endings: str) -> None:
        """Draw a picture if it is new or missing; print its paths."""
        paths = self.picture_paths(*endings)
        missing = [path for path in paths if self.fresh or not path.exists()]
        if missing:
            from ..show.figure_files import parse_slide_shape, resize_for_slide, save

            figure = resize_for_slide(draw(), parse_slide_shape(self.size))
            dpi = {"dpi": figure.dpi} if self.size else {}
            save(figure, paths[0].with_suffix(""), [path.suffix[1:] for path in missing], **dpi)
        for path in paths:
            print(path)


def write_unstored_netcdf(files: ResultFiles, data: xr.Dataset) -> None:
    """Write the NetCDF file of a result that was not stored while it was computed."""
    from ..files import make_writable_folder
    from ..running.store import write_netcdf

    make_writable_folder(files.result.parent)
    write_netcdf(data, files.result)


def existing_table_files(path: Path) -> list[Path]:
    """Return the existing files of a table that may be several: ``x.csv``, ``x.eta.csv``."""
    several = path.parent.glob(f"{escape_glob(path.stem)}.*{path.suffix}")
    return [*([path] if path.exists() else []), *sorted(several)]
