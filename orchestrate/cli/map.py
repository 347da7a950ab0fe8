"""``map``: responses over two parameters."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import (
    Commands,
    add_excitation,
    add_numbers,
    add_over,
    add_settling,
    add_structure,
    check_over,
    excitation_of,
    numbers_of,
    structure_of,
    values_of,
)
from .output import add_results
from .question import carry_out, format_parameter, is_flag, picture_of

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Structure

EXAMPLES = """\
  {program} map --eta 0.4:2.2:0.05 --over e --values 0.1:0.9:0.05
  {program} map --eta 1.2 --over e --values 0.1:0.9:0.1 --over D --values 0.005,0.02,0.05
  {program} map --structure beam --hz 8:20:0.25 --amplitude 1e-4 --over e --values 0.3,0.5,0.7
Each point starts from rest. The picture has impacts per period, multiplicity and largest gap."""
MAX_KINDS = 4  # multiplicities that are told


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "responses over two parameters: impacts per period, multiplicity, largest gap, exponent"
    parser = commands.add("map", run, text, EXAMPLES)
    add_structure(parser)
    option = add_excitation(parser).add_argument
    add_over(option, twice=True)
    option("--exponent", action="store_true", help="the largest Lyapunov exponents too")
    add_settling(option, (60, "periods kept"), transient=300)
    add_numbers(
        option,
        periods=(500, "periods for an exponent"),
        tolerance=(1e-2, "part of the motion's size within which a state repeats"),
        longest=(20_000, "periods up to which an undecided response is run on"),
    )
    add_results(parser)


def run(arguments: argparse.Namespace) -> None:
    """Run the command."""
    structure = structure_of(arguments)
    names = ("exponent", "transient", "settle", "samples", "periods", "tolerance", "longest")
    question = {**map_arguments(arguments, structure), **numbers_of(arguments, *names)}
    carry_out(arguments, structure, question, report, picture_of)


def map_arguments(arguments: argparse.Namespace, structure: Structure) -> dict[str, Any]:
    """Return the box's motion and the parameters, two of them as lists.

    Raises
    ------
    InputError
    """
    if len(arguments.over) != len(arguments.values):
        raise InputError("--over and --values: expected as many of one as of the other")
    for name in arguments.over:
        check_over(name, arguments)
    twice = len(arguments.over) == 2
    excitation = excitation_of(arguments, structure, one=twice, level=twice)
    if isinstance(excitation.get("amplitude"), tuple):
        raise InputError(
            "--g: a map over the frequency has one amplitude; expected --amplitude in m (what it "
            "shows does not depend on the level)"
        )
    for name, text in zip(arguments.over, arguments.values, strict=True):
        if name in excitation:
            raise InputError(f"--over {name}: twice; expected two parameters")
        excitation[name] = values_of("--values", text, zero=True)[0]
    if sum(isinstance(value, tuple) for value in excitation.values()) != 2:
        raise InputError(
            "map: expected two parameters that vary: a range of frequencies and --over with "
            "--values, or --over with --values twice at one frequency"
        )
    return excitation


def report(data: xr.Dataset) -> None:
    """Print what the map shows."""
    undecided = is_flag(data.multiplicity_decided, "undecided")
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
        format_parameter(str(name), float(top[name])) for name in data.xi_rel_max.dims
    )
    print(f"largest gap: xi_Rel = {float(top.xi_rel_max):.6g} at {where}")
    impacts = data.impacts_per_period
    print(f"impacts per period: {float(impacts.min()):.4g} to {float(impacts.max()):.4g}")
    if "exponent" in data:
        chaotic = data.exponent > 3.0 * data.standard_error
        print(f"exponent above zero by three standard errors: {float(chaotic.mean()):.1%}")
