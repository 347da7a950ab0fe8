"""``attractors``: what random starts lead to."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from .options import (
    Commands,
    add_excitation,
    add_numbers,
    add_over,
    add_settling,
    add_structure,
    along,
    numbers_of,
    one_value,
    structure_of,
)
from .output import add_results
from .question import along_of, carry_out, picture_of, place, ranges, several, tell_attractors

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} attractors --eta 1.32 --starts 200 --seed 1
  {program} attractors --eta 1.2:1.4:0.01
  {program} attractors --structure beam --hz 15.5,16 --g 0.02 --scale 1e-3
Half of the starts lie around zero, half around the response from rest. Every motion found at one
value is carried to its neighbours, so along a range it is found as far as it exists; random starts
alone may miss one whose basin is small."""
FEW = 5  # values whose attractors are all told
LISTED = 12  # attractors along a parameter that are told


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "coexisting motions: how many, and how many random starts lead to each"
    parser = commands.add("attractors", run, text, EXAMPLES)
    add_structure(parser)
    option = add_excitation(parser).add_argument
    add_over(option)
    option(
        "--scale",
        metavar="X",
        help="half width of one box of starts around zero, m (default: --width times the gap from "
        "rest, and a second box around the response from rest)",
    )
    add_numbers(
        option,
        starts=(60, "random starts at each value"),
        seed=(0, "of the random numbers: the same seed, the same starts"),
        width=(3.0, "half width of the box of starts over the largest gap from rest"),
    )
    add_settling(option, (48, "periods looked at"), transient=400)
    add_results(parser)


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    structure = structure_of(arguments)
    asked, _ = along(arguments, structure)
    names = ("starts", "seed", "width", "transient", "settle", "samples")
    scale = None if arguments.scale is None else one_value("--scale", arguments.scale)
    question = {**asked, "scale": scale, **numbers_of(arguments, *names)}
    carry_out(arguments, structure, question, report, picture_of if several(asked) else None)


def report(data: xr.Dataset) -> None:
    """Attractors and their shares, or where there are several."""
    name = along_of(data)
    if data.sizes[name] <= FEW:
        for i in range(data.sizes[name]):
            here = data.isel({name: i})
            where = place(name, float(here[name]))
            print(f"{int(here.number)} found at {where}, of {data.sizes['start']} starts")
            tell_attractors(here, "starts")
        return
    ordered = data.sortby(name)
    for number in range(1, int(data.number.max()) + 1):
        holds = ordered.number.values == number
        if holds.any():
            where = ranges(name, ordered[name].values, holds)
            print(f"{number} found at {int(holds.sum())} of {holds.size} values: {where}")
    print_lines(ordered, name)


def print_lines(data: xr.Dataset, name: str) -> None:
    """The most frequent attractors along the parameter, from where to where."""
    for number in range(min(LISTED, data.sizes["attractor"])):
        one = data.isel(attractor=number)
        there = one.multiplicity.notnull().values
        shares = one.share.values[there]
        first, last = (place(name, float(one[end])) for end in ("first_found", "last_found"))
        where = first if there.sum() == 1 else f"{first} to {last}"
        print(f"  {number}: {where}, {shares.min():.1%} to {shares.max():.1%} of starts")
    left = data.sizes["attractor"] - LISTED
    if left > 0:
        print(f"  and {left} more")
