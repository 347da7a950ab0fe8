"""Command ``map``: compute responses over a grid of two parameters."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .grammar import parse_values
from .options import (
    Commands,
    add_over_options,
    check_over,
    excitation_by_level,
    read_excitation,
    read_structure_options,
)
from .question import (
    answer_question,
    draw_result,
    format_largest_gap,
    format_parameter,
    has_flag,
)

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Structure

EXAMPLES = """\
  {program} map --eta 0.4:2.2:0.05 --over e --values 0.1:0.9:0.05
  {program} map --eta 1.2 --over e --values 0.1:0.9:0.1 --over D --values 0.005,0.02,0.05
  {program} map --structure beam --hz 8:20:0.25 --amplitude 1e-4 --over e --values 0.3,0.5,0.7
  {program} map --structure beam --set clearance=2e-5 --hz 8:20:0.25 --g 0.002:0.05:0.002
Each point starts from rest. The picture has impacts per period, multiplicity and largest gap."""
MAX_KINDS = 4  # multiplicities that are told


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``map`` with its options."""
    text = "responses over two parameters: impacts per period, multiplicity, largest gap, exponent"
    question = commands.add_response_command("map", run, text, EXAMPLES)
    add_over_options(question, twice=True)
    question.declare(
        "exponent", "transient", "settle", "samples", "periods", "tolerance", "longest"
    )


def run(arguments: argparse.Namespace) -> None:
    """Run ``map``: compute responses over two parameters; print a summary, store and draw them."""
    structure = read_structure_options(arguments)
    question = {
        **map_arguments(arguments, structure),
        **arguments.question.keywords(arguments),
    }
    answer_question(arguments, structure, question, print_result, draw_result)


def map_arguments(arguments: argparse.Namespace, structure: Structure) -> dict[str, Any]:
    """Return excitation and varied parameters as keywords of ``map``; exactly two are lists."""
    if len(arguments.over) != len(arguments.values):
        raise InputError("--over and --values: expected as many of one as of the other")
    for name in arguments.over:
        check_over(name, arguments)
    twice = len(arguments.over) == 2
    by_level = arguments.g is not None
    chosen = excitation_by_level if by_level else read_excitation
    excitation = chosen(arguments, structure, one=twice)
    for name, text in zip(arguments.over, arguments.values, strict=True):
        if name in excitation or (name == "level" and "amplitude" in excitation):
            raise InputError(f"--over {name}: twice; expected two parameters")
        excitation[name] = parse_values("--values", text, zero=True)[0]
    if sum(isinstance(value, tuple) for value in excitation.values()) != 2:
        raise InputError(
            "map: expected two parameters that vary: a range of frequencies and one of levels "
            "(--g) or --over with --values, or --over with --values twice at one frequency"
        )
    return excitation


def print_result(data: xr.Dataset) -> None:
    """Print a map's shares of periods, its largest gap and where, impacts and chaotic share."""
    undecided = has_flag(data.multiplicity_decided, "undecided")
    kinds = data.multiplicity.where(~undecided, -1).values.astype(int)
    shares = [f"not periodic {float((kinds == 0).mean()):.1%}"]
    for number in range(1, MAX_KINDS + 1):
        shares.append(f"{number if number > 1 else ''}T {float((kinds == number).mean()):.1%}")
    shares.append(f"longer {float((kinds > MAX_KINDS).mean()):.1%}")
    if (kinds < 0).any():
        shares.append(f"undecided {float((kinds < 0).mean()):.1%}")
    print(f"{kinds.size} responses: {', '.join(shares)}")
    top = data.isel(data.xi_rel_max.argmax(...))
    where = ", ".join(
        format_parameter(data, str(name), float(top[name])) for name in data.xi_rel_max.dims
    )
    print(f"largest gap: {format_largest_gap(top)} at {where}")
    impacts = data.impacts_per_period
    print(f"impacts per period: {float(impacts.min()):.4g} to {float(impacts.max()):.4g}")
    if "exponent" in data:
        chaotic = data.exponent > 3.0 * data.standard_error
        print(f"exponent above zero by three standard errors: {float(chaotic.mean()):.1%}")
