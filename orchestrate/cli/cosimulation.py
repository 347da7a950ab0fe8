"""The command ``cosimulate``: the oscillator with a drive of anybody's."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar

import orchestrate

from ..errors import InputError
from ..lazy import xr
from ..model import Structure
from ..units import text_of
from .answer import Asked
from .command import Keywords, Options, option
from .grammar import plain_float, read_pairs
from .options import OfStructure
from .output import Results, Stored
from .printing import extents, table

LISTED = ("parameter", "structuralParameter", "input", "output")
PAIR = "NAME=VALUE"


def split_at_commas(texts: Sequence[str] | None) -> tuple[str, ...]:
    return tuple(word for word in ",".join(texts or ()).split(",") if word)


def read_values(option: str, texts: Sequence[str]) -> dict[str, Any]:
    """Return values by name: numbers, true or false; of inputs also files with time and value."""
    found: dict[str, Any] = {}
    for name, text in read_pairs(option, texts, PAIR).items():
        try:
            found[name] = text == "true" if text in ("true", "false") else plain_float(text)
        except ValueError:
            if option != "--input":
                text = f"{option} {name}={text}: expected a number, true or false"
                raise InputError(text) from None
            found[name] = orchestrate.Course.from_csv(text)
    return found


def variable_lines(drive: Path) -> Iterator[str]:
    """Yield the drive's parameters, inputs and outputs, and what could be connected."""
    from ..fmu.description import describe
    from ..weak_drive.connection import MOTION, proposals, reason_for

    description = describe(drive)
    yield f"{description.name}, FMI {description.fmi_version}"
    listed = [
        (
            one.causality,
            name,
            "" if one.start is None else str(one.start),
            one.unit or "no unit",
            one.description or "",
        )
        for name, one in description.variables.items()
        if one.causality in LISTED
    ]
    listed.sort(key=lambda row: LISTED.index(row[0]))
    titles = ("causality", "name", "start", "unit", "description")
    yield from table(dict(zip(titles, zip(*listed, strict=True), strict=True)), len(listed))
    if likely := proposals(description):
        links = " ".join(f"{ours}={theirs}" for ours, theirs in likely.items())
        yield f"likely: --connect {links}   (a run checks the sign of the force)"
        for ours, theirs in likely.items():
            yield f"  {ours:17} {theirs}: {reason_for(description, ours, theirs)}"
    else:
        outputs = " ".join(f"{ours}=OUTPUT" for ours in MOTION)
        text = f"--connect {outputs} box_force=INPUT (one motion is enough, all are more exact)"
        yield f"units and names do not tell which are the box's: {text}"


class OfDrive(Options):
    """Options of the drive of a co-simulation."""

    heading, rank = "the drive", 1
    drive: Path = option("FMI 2.0 or 3.0", value="FMU", needed=True)
    listed: bool = option("show its variables, propose connections, and end", name="--list")
    connect: list[str] = option(
        "box_acceleration (or box_velocity, box_position) and box_force, by names of the drive, or "
        "force1, force2, its forces on the halves; a "
        "minus before a name turns its sign, a unit after it in brackets states it: pos[mm]",
        (),
        "OURS=THEIRS",
        many=True,
    )
    unit: list[str] = option(
        "units of connected variables that it does not state, or not rightly",
        (),
        "NAME=UNIT",
        many=True,
    )
    parameter: list[str] = option("its start values", (), PAIR, many=True)
    input: list[str] = option(
        "its other inputs: a number, or a CSV file with time in s and value", (), PAIR, many=True
    )
    record: list[str] = option("variables of the drive that are stored", (), "NAME", many=True)


class Cosimulate(OfStructure, OfDrive, Asked, Stored, Results):
    """Both FMUs together: the oscillator and a drive of anybody's."""

    calls = "cosimulate"
    renamed: ClassVar = {"units": "unit", "parameters": "parameter", "inputs": "input"}
    examples = """
  {program} cosimulate --drive shaker.fmu --list
  {program} cosimulate --structure beam --drive shaker.fmu --duration 2 --step 1e-3
      --connect box_acceleration=table_acc box_force=-force --input volts=3 --record amperes
  {program} cosimulate --structure none --drive shaker.fmu --connect box_acceleration=table_acc
      --input volts=3 --duration 2 --step 1e-3                the drive alone
  {program} cosimulate --structure beam --drive shaker.fmu --connect box_velocity=v box_force=f
      --input volts=volts.csv --duration 2 --step 1e-3"""

    def __call__(self) -> None:
        if self.listed:
            print(*variable_lines(self.drive), sep="\n")
        else:
            super().__call__()

    def ask(self) -> tuple[Structure | None, Keywords]:
        alone = self.structure == "none"
        if alone and self.set:
            raise InputError("--set: --structure none has no parameters; leave it out")
        structure = None if alone else self.read_structure()
        if self.structure == "paper" and not self.set:
            text = "expected one in SI units, as the drive has them, or none for the drive alone"
            raise InputError(f"--structure is missing; {text}")
        return structure, self.keywords() | {
            "drive": str(self.drive),
            "connect": read_pairs("--connect", split_at_commas(self.connect), PAIR),
            "units": read_pairs("--unit", split_at_commas(self.unit), "NAME=UNIT"),
            "parameters": read_values("--parameter", self.parameter),
            "inputs": read_values("--input", self.input),
            "record": split_at_commas(self.record),
        }

    def summary(self, data: xr.Dataset) -> Iterator[str]:
        if self.structure == "none":
            from ..weak_drive.connection import MOTION

            yield f"no structure: the drive alone for {float(data.time[-1]):.6g} s"
            yield from extents(data, " ".join(name for name in MOTION if name in data))
        else:
            yield from extents(data, "x1 x2")
            yield f"impacts: {data.sizes['impact']} in {float(data.time[-1]):.6g} s"
            worst = text_of(data, data.coupling_error.max(), "m", ".2g")
            yield f"coupling error of the displacements: {worst} (a second run with half the step)"
        if data.attrs["inputs_at_start"]:
            yield f"no input was given for {data.attrs['inputs_at_start']}, which stays so"
