"""Command ``cosimulate``: couple the oscillator to a drive that is somebody's own FMU."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..units import scale_of
from .grammar import parse_state, positive_number
from .options import Commands, add_structure_options, read_structure_options
from .output import add_result_options, add_units_option
from .question import answer_question, draw_result

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} cosimulate --drive shaker.fmu --list
  {program} cosimulate --structure beam --drive shaker.fmu --duration 2 --step 1e-3
      --connect box_acceleration=table_acc box_force=-force --input volts=3 --record amperes
  {program} cosimulate --structure beam --drive shaker.fmu --connect box_velocity=v box_force=f
      --input volts=volts.csv --duration 2 --step 1e-3"""
SHOWN = ("parameter", "structuralParameter", "input", "output")


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``cosimulate`` with its options."""
    text = "both FMUs together: the oscillator and a drive of anybody's"
    parser = commands.add("cosimulate", run, text, EXAMPLES)
    add_structure_options(parser)
    group = parser.add_argument_group("the drive")
    group.add_argument("--drive", type=Path, required=True, metavar="FMU", help="FMI 2.0 or 3.0")
    group.add_argument(
        "--list", action="store_true", help="show its variables, propose connections, and end"
    )
    several = {"nargs": "+", "default": [], "metavar": "NAME=VALUE"}
    connect = (
        "box_acceleration (or box_velocity, box_position) and box_force, by names of the drive; "
        "a minus before a name turns its sign"
    )
    group.add_argument(
        "--connect", nargs="+", default=[], metavar="OURS=THEIRS", action="extend", help=connect
    )
    group.add_argument("--parameter", action="extend", help="its start values", **several)
    held = "its other inputs: a number, or a CSV file with time in s and value"
    group.add_argument("--input", action="extend", help=held, **several)
    record = "variables of the drive that are stored"
    group.add_argument("--record", metavar="A,B,...", help=record)
    question = commands.add_function_options(parser, "the run")
    question.add("duration", positive_number, metavar="S", help="of the run, s")
    question.add("step", positive_number, metavar="S", help="communication step, s")
    start = "state at the start, m and m/s (default: rest)"
    question.add("start", parse_state, metavar="X1,X2,V1,V2", help=start)
    add_units_option(parser)
    add_result_options(parser)


def run(arguments: argparse.Namespace) -> None:
    """Run ``cosimulate``: simulate both FMUs; print, store and draw; or list the drive's names."""
    if arguments.list:
        print_variables(arguments.drive)
        return
    structure = read_structure_options(arguments)
    question = arguments.question.keywords(arguments)
    for name in ("duration", "step"):
        if question[name] is None:
            raise InputError(f"--{name} is missing; expected seconds, such as --{name} 0.01")
    question |= {
        "drive": str(arguments.drive),
        "connect": pairs("--connect", arguments.connect),
        "parameters": read_numbers("--parameter", arguments.parameter),
        "inputs": read_inputs(arguments.input),
        "record": tuple(name for name in (arguments.record or "").split(",") if name),
    }
    answer_question(arguments, structure, question, print_result, draw_result)


def pairs(option: str, texts: Sequence[str]) -> dict[str, str]:
    """Return ``NAME=VALUE`` texts as a dict; raise ``InputError`` where one is none, or twice."""
    found: dict[str, str] = {}
    for text in texts:
        name, sign, value = text.partition("=")
        if not (name and sign and value) or name in found:
            raise InputError(f"{option} {text}: expected NAME=VALUE, each name once")
        found[name] = value
    return found


def read_numbers(option: str, texts: Sequence[str]) -> dict[str, float | bool]:
    """Return start values by name: numbers, ``true`` or ``false``."""
    words = {"true": True, "false": False}
    try:
        return {
            n: words.get(v) if v in words else float(v) for n, v in pairs(option, texts).items()
        }
    except ValueError:
        raise InputError(f"{option} {' '.join(texts)}: expected numbers, true or false") from None


def read_inputs(texts: Sequence[str]) -> dict[str, Any]:
    """Return inputs by name: numbers, or courses read from files."""
    from .. import Course

    found: dict[str, Any] = {}
    for name, value in pairs("--input", texts).items():
        try:
            found[name] = float(value)
        except ValueError:
            found[name] = Course.from_csv(value)
    return found


def print_variables(drive: Path) -> None:
    """Print the drive's parameters, inputs and outputs, and what could be connected."""
    from ..access.description import describe
    from ..weak_drive.connection import FORCE, MOTION, proposals

    description = describe(drive)
    print(f"{description.name}, FMI {description.fmi_version}")
    for causality in SHOWN:
        for name, variable in description.variables.items():
            if variable.causality == causality:
                unit = variable.unit or "no unit"
                print(f"  {causality:10} {name:28} {unit:10} {variable.description or ''}".rstrip())
    likely = {ours: names[0] for ours, names in proposals(description).items() if names}
    motion = [name for name in MOTION if name in likely][:1]
    if motion and FORCE[0] in likely:
        links = " ".join(f"{name}={likely[name]}" for name in (*motion, FORCE[0]))
        print(f"likely: --connect {links}   (by unit and name; check the sign of the force)")
    else:
        print("no outputs and inputs that could be the box's motion and the force on it")


def print_result(data: xr.Dataset) -> None:
    """Print the motion's extremes, its impacts, and the coupling's error."""
    length, unit = scale_of(data, "m")
    for mass in (1, 2):
        size = float(abs(data[f"x{mass}"]).max()) / length
        print(f"mass {mass}: largest displacement {size:.4g} {unit}")
    print(f"impacts: {data.sizes['impact']} in {float(data.time[-1]):.6g} s")
    worst = float(data.coupling_error.max()) / length
    print(f"coupling error of the displacements: {worst:.2g} {unit}, by half the step")
