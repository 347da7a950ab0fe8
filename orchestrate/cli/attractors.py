"""Command ``attractors``: find the attractors that random start states lead to."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from .grammar import parse_single_number
from .options import Commands, add_over_options, read_structure_options, varied_arguments
from .question import (
    answer_question,
    draw_result,
    format_parameter,
    format_ranges,
    is_curve,
    print_attractors,
    varied_parameter,
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
    """Add the parser of the command ``attractors`` with its options."""
    text = "coexisting motions: how many, and how many random starts lead to each"
    question = commands.add_response_command("attractors", run, text, EXAMPLES)
    add_over_options(question)
    half = (
        "half width of one box of starts around zero, m (default: --width times the gap from "
        "rest, and a second box around the response from rest)"
    )
    question.add("scale", parse_single_number, metavar="X", help=half)
    question.declare("starts", "seed", "width", "transient", "settle", "samples")


def run(arguments: argparse.Namespace) -> None:
    """Run ``attractors``: find attractors from random starts and their shares; print and store."""
    structure = read_structure_options(arguments)
    excitation, _ = varied_arguments(arguments, structure)
    question = {**excitation, **arguments.question.keywords(arguments)}
    answer_question(
        arguments, structure, question, print_result, draw_result if is_curve(excitation) else None
    )


def print_result(data: xr.Dataset) -> None:
    """Print the attractors at one parameter value, or the ranges where there are several."""
    name = varied_parameter(data)
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
    print_attractor_ranges(ordered, name)


def print_attractor_ranges(data: xr.Dataset, name: str) -> None:
    """Print the most frequent attractors with the parameter ranges in which each exists."""
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
