"""Structure that a stored result was computed for, which commands that begin with it take."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..structures.ranges import STRUCTURE
from .grammar import parse_changes
from .options import print_assumptions, read_structure_options
from .question import read_earlier_result

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Structure

SAME = 1e-9  # relative: numbers that are nearer than this are one
MOST_NAMED = 3  # parameters that a line on two structures names
READING = (KeyError, TypeError, ValueError)  # of attributes


def structure_from_start(arguments: argparse.Namespace) -> Structure:
    """Return the structure of ``--structure``, or else of the file of ``--start``, with ``--set``.

    Without either that is the paper's. If the file was computed for another structure than the one
    asked for, a printed line says so.

    Raises
    ------
    InputError
        Where the file of ``--start`` is no result, or has no structure.
    """
    if arguments.start is None:
        arguments.structure = arguments.structure or "paper"
        return read_structure_options(arguments)
    changes = parse_changes(arguments.set)
    asked = read_structure_options(arguments) if arguments.structure else None
    stored = stored_structure("--start", arguments.start)
    if asked is None:
        asked = stored.replace(**changes)
        print_assumptions(asked, "", changes)
    print_difference("--start", arguments.start, stored, asked)
    return asked


def keep_file_name(question: dict[str, Any]) -> dict[str, Any]:
    """Return a question with ``box_acceleration`` 0, not None, where ``start`` has none either.

    So the name of the result's file stays what it has always been.
    """
    stored: dict[str, Any] = {} if question["start"] is None else question["start"].attrs
    unset = question["box_acceleration"] is None and not stored.get("box_acceleration")
    return {**question, "box_acceleration": 0.0} if unset else question


def stored_structure(option: str, path: Path) -> Structure:
    """Return the structure for which a stored result was computed; raise if it names none."""
    return structure_of(option, path, read_earlier_result(option, path))


def structure_of(option: str, path: Path, data: xr.Dataset) -> Structure:
    """Return the structure in a stored result's attributes; raise ``InputError`` if none is."""
    from ..structures import Structure

    try:
        return Structure.from_attributes({str(name): value for name, value in data.attrs.items()})
    except READING:
        kind = str(data.attrs.get("call", "")).partition("(")[0]
        what = f"a result of {kind}, " if kind else ""
        raise InputError(
            f"{option} {path}: {what}without a structure; expected an orbit or a branch"
        ) from None


def print_difference(option: str, path: Path, stored: Structure, asked: Structure) -> None:
    """Print one line if a stored result was computed for another structure than the one asked."""
    line = explain_difference(stored, asked)
    if line:
        print(f"{option} {path} was computed for another structure: {line}")


def explain_difference(stored: Structure, asked: Structure) -> str:
    """Return which parameters of two structures differ, as a text; empty if none does.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> explain_difference(Structure(), Structure().replace(e=0.3))
    'e = 0.7 there, 0.3 here'
    """
    pairs = [
        (name, float(getattr(stored, name)), float(getattr(asked, name)))
        for name in (*STRUCTURE, "bonded")
    ]
    texts = [
        f"{name} = {there:.6g} there, {here:.6g} here"
        for name, there, here in pairs
        if not math.isclose(there, here, rel_tol=SAME)
    ]
    left = len(texts) - MOST_NAMED
    return "; ".join(texts[:MOST_NAMED] + [f"and {left} more parameters"] * (left > 0))
