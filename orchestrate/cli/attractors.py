"""``attractors``: what random starts lead to."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from .grammar import one_value
from .options import Commands, add_over, structure_of, varied_arguments
from .question import (
    carry_out,
    format_parameter,
    format_ranges,
    is_curve,
    parameter_of,
    picture_of,
    print_attractors,
)

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} attractors --eta 1.32 --starts 200 --seed 1
  {program} attractors --eta 1.2:1.4:0.01
  {program} attractors --structure beam --hz 15.5,16 --g 0.02 --scale 1e-3
Half of the starts lie around zero, half around the response from rest. Every motion found at one
value is carried to its neighbours, so along a range it is found as far as it exists; random starts
alone may miss one whose basin is small."""
MAX_VALUES_IN_FULL = 5  # values up to which every attractor is printed
MAX_ATTRACTORS = 12  # attractors along a parameter that are printed


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "coexisting motions: how many, and how many random starts lead to each"
    question = commands.ask("attractors", run, text, EXAMPLES)
    add_over(question)
    half = (
        "half width of one box of starts around zero, m (default: --width times the gap from "
        "rest, and a second box around the response from rest)"
    )
    question.add("scale", one_value, metavar="X", help=half)
    question.declare("starts", "seed", "width", "transient", "settle", "samples")


def run(arguments: argparse.Namespace) -> None:
    """Find the attractors that random starts lead to, and their shares."""
    structure = structure_of(arguments)
    excitation, _ = varied_arguments(arguments, structure)
    question = {**excitation, **arguments.question.keywords(arguments)}
    carry_out(
        arguments, structure, question, print_result, picture_of if is_curve(excitation) else None
    )


def print_result(data: xr.Dataset) -> None:
    """Print attractors and their shares, or where there are several."""
    name = parameter_of(data)
    if data.sizes[name] <= MAX_VALUES_IN_FULL:
        for i in range(data.sizes[name]):
            at_value = data.isel({name: i})
            where = format_parameter(data, name, float(at_value[name]))
            count, starts = int(at_value.number), data.sizes["start"]
            word = "attractor" if count == 1 else "attractors"
            print(f"{count} {word} at {where} ({starts} random starts)")
            print_attractors(at_value, "starts")
        return
    ordered = data.sortby(name)
    for number in range(1, int(data.number.max()) + 1):
        holds = ordered.number.values == number
        if holds.any():
            where = format_ranges(data, name, ordered[name].values, holds)
            print(f"{number} found at {int(holds.sum())} of {holds.size} values: {where}")
    print_lines(ordered, name)


def print_lines(data: xr.Dataset, name: str) -> None:
    """Print the most frequent attractors along the parameter, from where to where."""
    for number in range(min(MAX_ATTRACTORS, data.sizes["attractor"])):
        attractor = data.isel(attractor=number)
        exists = attractor.multiplicity.notnull().values
        shares = attractor.share.values[exists]
        first, last = (
            format_parameter(data, name, float(attractor[end]))
            for end in ("first_found", "last_found")
        )
        where = first if exists.sum() == 1 else f"{first} to {last}"
        print(f"  {number}: {where}, {shares.min():.1%} to {shares.max():.1%} of starts")
    left = data.sizes["attractor"] - MAX_ATTRACTORS
    if left > 0:
        print(f"  and {left} more")
