"""Structure that a stored result was computed for, which commands that begin with it take."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..lazy import xr
from ..model.ranges import STRUCTURE
from .grammar import parse_changes, read_earlier_result
from .options import print_assumptions

if TYPE_CHECKING:
    from ..model import Structure

MOST_NAMED = 3  # parameters that a line on two structures names
READING = (KeyError, TypeError, ValueError)  # of attributes


def read_structure_and_question(arguments: Any) -> tuple[Structure, dict[str, Any]]:
    """Return the structure and the keywords of a command that may begin with a stored result."""
    if arguments.start is None:
        arguments.structure = arguments.structure or "paper"
        return arguments.read_structure(), arguments.keywords()
    changes = parse_changes(arguments.set)
    asked = arguments.read_structure() if arguments.structure else None
    data = read_earlier_result("--start", arguments.start)
    stored, question = structure_of("--start", arguments.start, data), arguments.keywords()
    question["start"] = data
    if asked is None:
        asked = stored.replace(**changes)
        print_assumptions(asked, "", changes)
    print_difference("--start", arguments.start, stored, asked)
    return asked, question


def structure_of(option: str, path: Path, data: xr.Dataset) -> Structure:
    """Return the structure in a stored result's attributes; raise ``InputError`` if none is."""
    from ..model import Structure
    from ..running.provenance import what_it_is

    try:
        return Structure.from_attributes({str(name): value for name, value in data.attrs.items()})
    except READING:
        text = f"{what_it_is(data)}, without a structure; expected an orbit or a branch"
        raise InputError(f"{option} {path}: {text}") from None


def print_difference(option: str, path: Path, stored: Structure, asked: Structure) -> None:
    """Print one line if a stored result was computed for another structure than the one asked."""
    line = explain_difference(stored, asked)
    if line:
        print(f"{option} {path} was computed for another structure: {line}")


def explain_difference(stored: Structure, asked: Structure) -> str:
    """Return which parameters of two structures differ, as a text; empty if none does."""
    pairs = [
        (name, float(getattr(stored, name)), float(getattr(asked, name)))
        for name in (*STRUCTURE, "bonded", "wall")
    ]
    texts = [
        f"{name} = {there:.6g} there, {here:.6g} here"
        for name, there, here in pairs
        if not math.isclose(there, here, rel_tol=1e-9)
    ]
    left = len(texts) - MOST_NAMED
    return "; ".join(texts[:MOST_NAMED] + [f"and {left} more parameters"] * (left > 0))
