"""``border``: a bifurcation of a branch over two parameters."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import (
    Commands,
    add_numbers,
    add_structure,
    ends_of,
    numbers_of,
    plain_int,
    structure_of,
)
from .output import add_results
from .question import carry_out, format_parameter, read_stored

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} border --start branch.nc --bifurcation 0 --over eta,e --limits 2.4:2.9,0.6:0.8
--start is what the command branch has written, with the numbers of its bifurcations."""


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "follow a bifurcation of a branch over two parameters: where a window begins or ends"
    parser = commands.add("border", run, text, EXAMPLES)
    add_structure(parser)
    option = parser.add_argument_group("question").add_argument
    option("--start", type=Path, metavar="FILE", help="NetCDF file of a branch")
    option("--bifurcation", type=plain_int, default=0, metavar="N", help="its number (default: 0)")
    over = "both parameters, that of the branch first (default: %(default)s)"
    option("--over", default="eta,e", metavar="NAME,NAME", help=over)
    limits = "between which each is followed"
    option("--limits", metavar="A:B,C:D", help=limits)
    add_numbers(
        option,
        longest=(0.03, "longest step along the curve"),
        most=(500, "points in one direction, at most"),
    )
    add_results(parser)


def run(arguments: argparse.Namespace) -> None:
    """Run the command."""
    structure = structure_of(arguments)
    for name in ("start", "limits"):
        if getattr(arguments, name) is None:
            expected = "a file of the command branch" if name == "start" else "A:B,C:D"
            raise InputError(f"--{name}: nothing given; expected {expected}")
    limits = tuple(ends_of("--limits", part) for part in arguments.limits.split(","))
    question = {
        "start": read_stored("--start", arguments.start),
        "over": tuple(part.strip() for part in arguments.over.split(",")),
        "limits": limits,
        **numbers_of(arguments, "bifurcation", "longest", "most"),
    }
    carry_out(arguments, structure, question, report, picture_of)


def picture_of(data: xr.Dataset) -> Any:
    """Draw the curve."""
    from ..figures.borders import draw
    from ..figures.labels import title_from_attributes

    return draw(data, title=title_from_attributes(data))


def report(data: xr.Dataset) -> None:
    """Print the curve's extent, and why it ends."""
    print(f"{data.attrs['kind']}: {data.sizes['point']} points")
    for name in map(str, data.attrs["over"]):
        first, last = float(data[name][0]), float(data[name][-1])
        low, high = float(data[name].min()), float(data[name].max())
        ends = f"{format_parameter(name, first)} to {format_parameter(name, last)}"
        print(
            f"from {ends}, within {format_parameter(name, low)} to {format_parameter(name, high)}"
        )
    print(f"first end: {data.attrs['first_end']}; last end: {data.attrs['last_end']}")
