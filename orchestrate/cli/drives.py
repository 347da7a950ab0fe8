"""What commands of the weak drive share: structure, motor and box, and FMUs of both models."""

from __future__ import annotations

import argparse
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from .options import add_set, changes_of

if TYPE_CHECKING:
    from ..structures import Drive, Structure


def add_drive(parser: argparse.ArgumentParser) -> None:
    """``--drive``, ``--structure`` and ``--set``."""
    group = parser.add_argument_group("structure, motor and box")
    text = (
        "TOML file with [motor], [box] and [structure], or a set: quick, beam (default: "
        "%(default)s)"
    )
    group.add_argument("--drive", default="quick", metavar="FILE", help=text)
    other = "file or set with another [structure] than that of --drive"
    group.add_argument("--structure", metavar="FILE", help=other)
    add_set(group, "a parameter of the structure, or of motor and box in SI; may be repeated")


def described(arguments: argparse.Namespace) -> tuple[Structure, Drive]:
    """Structure and drive, with what is set of either."""
    from ..structures import Drive, Structure

    drive = Drive.from_file(arguments.drive)
    structure = Structure.from_file(arguments.structure or arguments.drive)
    changes = changes_of(arguments.set)
    own = {field.name for field in fields(Drive)}
    of_drive = {name: float(value) for name, value in changes.items() if name in own}
    of_structure = {name: value for name, value in changes.items() if name not in own}
    return structure.replace(**of_structure), drive.replace(**of_drive)


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
