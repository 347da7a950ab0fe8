"""What commands share of how it is computed and where it goes: files, FMUs, processes."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError

if TYPE_CHECKING:
    from ..running.options import Running


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
    option("--jobs", type=int, metavar="N", help="processes at once (default: all cores)")
    cluster = "compute on the workers of a Dask scheduler, such as tcp://host:8786"
    option("--cluster", metavar="ADDRESS", help=cluster)
    own = "own FMU (default: the one of the present sources)"
    more: dict[str, Any] = {"action": "append"} if several else {}
    option("--fmu", type=Path, metavar="FILE", help=own + "; may be repeated" * several, **more)
    place = "where FMUs are looked for and exported to"
    option("--build-folder", type=Path, metavar="FOLDER", help=place)


def running_of(arguments: argparse.Namespace, store: Path | None = None) -> Running:
    """Keywords of the public API from the options."""
    running: Running = {
        "jobs": arguments.jobs,
        "cluster": arguments.cluster,
        "force": arguments.force,
        "keep_stale": arguments.keep_stale,
        "fmu": arguments.fmu,
        "build_folder": arguments.build_folder,
    }
    if store is not None:
        running["store"] = store
    return running


def check_output(folder: Path) -> None:
    """See that a folder can be written, or made, without making it yet.

    Raises
    ------
    InputError
    """
    place = next((place for place in (folder, *folder.parents) if place.exists()), Path())
    if not (place.is_dir() and os.access(place, os.W_OK)):
        reason = "not writable" if place.is_dir() else f"{place} is no folder"
        raise InputError(f"--output {folder}: {reason}; expected a folder that can be written")


def draw_if_missing(picture: Path, fresh: bool, draw: Callable[[], Any]) -> Path:
    """The picture of a result: drawn where the result is new or the picture is missing.

    Parameters
    ----------
    picture : Path
    fresh : bool
        Whether the result is new.
    draw : callable
        Gives a :class:`matplotlib.figure.Figure`.
    """
    if fresh or not picture.exists():
        from ..figures.files import save

        save(draw(), picture.with_suffix(""), (picture.suffix.lstrip("."),))
    return picture


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
