"""Steps of most commands: call the public function, print a summary, write the files."""

from __future__ import annotations

import argparse
import json
from collections.abc import Collection, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from ..errors import InputError, StoreError
from ..lazy import xr
from ..units import Units, with_readable_lengths, with_units
from .notes import print_frequency_notes, trivial_notes
from .output import (
    Files,
    digest,
    importing_matplotlib,
    read_running_options,
    read_units,
    result_name,
)
from .table import Question, Structure

UNIT_OF_OPTION = {"hz": "Hz", "rpm": "rpm", "frequency": "rad/s", "eta": "eta"}
UNIT_OF_KEY = {  # of a structure's file
    "frequency_hz": "Hz",
    "frequency_rpm": "rpm",
    "frequency_rad_s": "rad/s",
    "eta": "eta",
}
VARIED = ("eta", "frequency", "level", "values")
OVERLAY = """
--overlay FILE,... +  NetCDF files of branches that are drawn over the picture
"""


def answer(arguments: argparse.Namespace) -> None:
    """Run a command: ask its public function, print its summary, write result and picture."""
    structure, question = arguments.row.ask(arguments)
    if not getattr(arguments, "beside", False):
        answer_question(arguments, structure, question)
        return
    for name in ("store", "start"):
        if getattr(arguments, name) is not None:
            raise InputError(f"--beside: computes two structures; expected it without --{name}")
    bonded = answer_question(arguments, structure.as_bonded(), question, picture=False)
    print("delaminated:")
    delaminated = structure.as_delaminated()
    answer_question(arguments, delaminated, question, ending="with_bonded", beside=(bonded,))


def answer_question(
    arguments: argparse.Namespace,
    structure: Structure,
    question: Question,
    *,
    picture: bool = True,
    ending: str = "",
    function: str = "",
    beside: tuple[xr.Dataset, ...] = (),
) -> xr.Dataset:
    """Compute one result, print its summary, write files, drawn with others; return it."""
    import orchestrate

    row, function = arguments.row, function or arguments.row.function
    branches = read_overlay(arguments, structure, question)
    over = f"over_{digest(*branches)}" if branches else ""
    file = arguments.structure or getattr(arguments, "start", None) or "paper"
    name = result_name(function, file, structure, question)
    files = Files.from_options(arguments, f"{name}_{ending}" if ending else name, over)
    picture = picture and row.has_picture(question)
    print_frequency_notes(arguments, structure, question)
    with importing_matplotlib(picture and files.lacks_pictures()):
        running = read_running_options(arguments, files.result)
        data: xr.Dataset = getattr(orchestrate, function)(structure, **question, **running)
    asked = with_units(data, display_units(arguments, question))
    (shown,) = with_readable_lengths(asked)
    for line in (*trivial_notes(structure, question, shown), *row.summary(shown)):
        print(line)
    draw = partial(row.draw or orchestrate.plot, shown, *branches, *beside)
    files.write(asked, draw if picture else None)
    return data


def is_curve(question: Mapping[str, Any]) -> bool:
    """Return whether a parameter has several values, so that a curve can be drawn."""
    varied = (question.get(name) for name in VARIED)
    return any(len(values) > 1 for values in varied if isinstance(values, tuple))


def display_units(arguments: argparse.Namespace, question: Mapping[str, Any]) -> Units:
    """Return the display units: those of ``--units``, else those of the question's options."""
    varied = str(getattr(arguments, "over", "")).replace(" ", "").split(",")  # two of a border
    over = next((UNIT_OF_OPTION[name] for name in varied if name in UNIT_OF_OPTION), "")
    given = [unit for name, unit in UNIT_OF_OPTION.items() if getattr(arguments, name, None)]
    keys = excitation_keys(arguments) if "frequency" in question and not given else ()
    given += [unit for key, unit in UNIT_OF_KEY.items() if key in keys]
    both = question.get("over") or ()  # of a border
    by_ratio = "eta" in question or (not isinstance(both, str) and "eta" in both)
    frequency = over or next(iter(given), "eta" if by_ratio else "Hz")
    in_g = getattr(arguments, "g", None) is not None or "acceleration_g" in keys
    usual = Units(frequency, acceleration="g" if in_g else "")
    return read_units(arguments).with_defaults(usual)


def excitation_keys(arguments: argparse.Namespace) -> Collection[str]:
    """Return the keys of the section ``[excitation]`` in the TOML file of ``--structure``."""
    from ..model.files import parse, resolve

    if arguments.structure is None:  # but that of a stored result
        return ()
    return tuple(parse(resolve(arguments.structure)).get("excitation", {}))


def read_overlay(
    arguments: argparse.Namespace, structure: Structure, question: Mapping[str, Any]
) -> list[xr.Dataset]:
    """Return the branches of ``--overlay``; raise for one that does not fit the question."""
    texts = getattr(arguments, "overlay", [])
    paths = [Path(name) for text in texts for name in text.split(",")]
    if not paths:
        return []
    branches = [read_earlier_result("--overlay", path) for path in paths]
    if arguments.command == "map":
        from ..show.overlay import explain_border_mismatch

        both = {name for name, value in question.items() if isinstance(value, tuple)}
        for path, curve in zip(paths, branches, strict=True):
            if why := explain_border_mismatch(curve, both, structure.parameters()):
                raise InputError(f"--overlay {path}: {why}")
        return branches
    if arguments.command == "resonance" and "level" in question:
        raise InputError(f"--overlay: with several levels, --g {arguments.g}; expected one")
    if not is_curve(question):
        raise InputError("--overlay: one value has no picture; expected a range or a list")
    from ..show.overlay import explain_mismatch

    over = question.get("over") or ("eta" if "eta" in question else "frequency")
    parameters = structure.parameters()
    if arguments.command == "resonance":  # of both
        parameters.pop("bonded")
    for path, branch in zip(paths, branches, strict=True):
        if why := explain_mismatch(branch, over, parameters):
            raise InputError(f"--overlay {path}: {why}")
    return branches


def read_earlier_result(option: str, path: Path) -> xr.Dataset:
    """Read the NetCDF result of an earlier command; raise naming the option if it is none."""
    from ..running.store import load_foreign

    if not path.is_file():
        raise InputError(f"{option} {path}: no such file; expected a result of an earlier command")
    try:
        data = load_foreign(path)
    except StoreError as error:
        expected = "" if "expected" in str(error) else "; expected a NetCDF file"
        raise InputError(f"{option} {error}{expected}") from None
    try:
        json.loads(data.attrs.get("identity", '{"question": ""}'))["question"]
    except (ValueError, TypeError, KeyError, RecursionError):
        expected = "expected a result of an earlier command"
        raise InputError(f"{option} {path}: its identity is damaged; {expected}") from None
    return data
