"""Command ``border``: follow a bifurcation of periodic orbits over two parameters."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .grammar import plain_int
from .options import CONTINUED, Commands, add_structure_options, parse_varied
from .output import add_result_options, add_units_option
from .question import answer_question, draw_result, format_parameter, read_earlier_result
from .start_file import read_structure_and_question

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} border --start branch.nc --bifurcation 0 --over eta,e --limits 2.4:2.9,0.6:0.8
  {program} border --start beam.nc --over hz,e --limits 14:18,0.6:0.8
--start is what the command branch has written, with the numbers of its bifurcations;
structure and excitation are those of that branch."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``border`` with its options."""
    text = "follow a bifurcation of a branch over two parameters: where a window begins or ends"
    parser = commands.add("border", run, text, EXAMPLES)
    add_structure_options(parser, "--start")
    question = commands.add_function_options(parser)
    option = question.group.add_argument
    over = f"what varies, that of the branch first, each {CONTINUED} (default: %(default)s)"
    option("--over", default="eta,e", metavar="NAME,NAME", help=over)
    limits = "between which each is followed, in its own unit"
    option("--limits", metavar="A:B,C:D", help=limits)
    question.add(
        "start", read_earlier_result, type=Path, metavar="FILE", help="NetCDF file of a branch"
    )
    number = "its number (default: 0)"
    question.add("bifurcation", type=plain_int, default=0, metavar="N", help=number)
    question.declare("longest", "most")
    add_units_option(parser)
    add_result_options(parser)


def parse_both(over: str, limits: str) -> dict[str, tuple[Any, ...]]:
    """Return ``--over`` and ``--limits`` of two parameters as keywords of the public API."""
    names, ranges = ([part.strip() for part in text.split(",")] for text in (over, limits))
    if len(names) != 2:
        raise InputError(f"--over {over}: expected two names, such as eta,e or hz,e")
    pairs = [parse_varied(*pair) for pair in zip(names, ranges, strict=False)]
    if len(ranges) != 2:
        raise InputError(f"--limits {limits}: expected A:B,C:D, a range for each of {over}")
    return {"over": tuple(name for name, _ in pairs), "limits": tuple(ends for _, ends in pairs)}


def run(arguments: argparse.Namespace) -> None:
    """Run ``border``: trace a bifurcation curve over two parameters; print, store and draw it."""
    for name in ("start", "limits"):
        if getattr(arguments, name) is None:
            expected = "a file of the command branch" if name == "start" else "A:B,C:D"
            raise InputError(f"--{name}: nothing given; expected {expected}")
    both = parse_both(arguments.over, arguments.limits)
    structure, question = read_structure_and_question(arguments)
    answer_question(arguments, structure, {**both, **question}, print_result, draw_result)


def print_result(data: xr.Dataset) -> None:
    """Print a bifurcation curve's extent, its codimension-two points, and why it ends."""
    from ..flags import flag_words

    print(f"{data.attrs['kind']}: {data.sizes['point']} points")
    for name in map(str, data.attrs["over"]):
        first, last = float(data[name][0]), float(data[name][-1])
        low, high = float(data[name].min()), float(data[name].max())
        ends = f"{format_parameter(data, name, first)} to {format_parameter(data, name, last)}"
        reach = f"{format_parameter(data, name, low)} to {format_parameter(data, name, high)}"
        print(f"from {ends}, within {reach}")
    words = flag_words(data.codimension_two_kind.attrs)
    for number, kind in enumerate(data.codimension_two_kind.values):
        at = data.isel(codimension_two=number)
        names = [str(name) for name in data.attrs["over"]]
        where = [
            format_parameter(data, name, float(at[f"codimension_two_{name}"])) for name in names
        ]
        print(f"{words[int(kind)]} at {', '.join(where)}")
    print(f"first end: {data.attrs['first_end']}; last end: {data.attrs['last_end']}")
