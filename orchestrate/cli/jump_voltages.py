"""Command ``jump-voltages``: the voltages of the speed's jumps at rate 0, and on ramps."""

from __future__ import annotations

import argparse
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .drive_options import (
    add_rate_option,
    add_settle_option,
    add_step_option,
    add_voltage_options,
    answer_both_structures,
    parse_ramp_ends,
    times_in_seconds,
)
from .grammar import parse_rates
from .options import Commands, read_drive_options
from .output import add_result_options

if TYPE_CHECKING:
    import xarray as xr

USUAL = "1e-4,5e-5,2.5e-5"
EXAMPLES = """\
  {program} jump-voltages                                 quick, up and down
  {program} jump-voltages --rate 1e-4,3e-5,1e-5 --one-way
  {program} jump-voltages --drive beam --eta0 1.33:1.57 --rate 4e-5,2e-5,1e-5 --one-way
{eta0}
Interrupted, the same command goes on where it was."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``jump-voltages`` with its options."""
    text = "voltages at which the speed jumps, at rate 0 and on ramps of several rates"
    parser = commands.add_drive_command("jump-voltages", run, text, EXAMPLES)
    group = parser.add_argument_group("ramps")
    add_voltage_options(group)
    add_rate_option(group, "A,B,...", ", a list", USUAL)
    add_settle_option(group)
    group.add_argument("--one-way", action="store_true", help="do not come back: jumps up only")
    add_step_option(group)
    add_result_options(parser, several=True)


def run(arguments: argparse.Namespace) -> None:
    """Run ``jump-voltages``: find jump voltages at rate 0; print, store, draw."""
    structure, drive = read_drive_options(arguments)
    unit = drive.volts(structure) * structure.omega
    ends = parse_ramp_ends(arguments, structure, drive)
    question = {
        "voltage": ends,
        "rates": [rate * unit for rate in parse_rates("--rate", arguments.rate or USUAL)],
        "back": not arguments.one_way,
        **times_in_seconds(arguments, structure, "settle", "step"),
    }
    draw = partial(draw_result, name=Path(arguments.drive).stem, ends=ends)
    print_table = partial(print_result, directions=("up",) if arguments.one_way else ("up", "down"))
    answer_both_structures(arguments, structure, drive, question, draw, print_table)


def draw_result(data: xr.Dataset, name: str, ends: tuple[float, float]) -> Any:
    """Draw the jump voltages over the ramps' rate; return the figure."""
    from ..figures.lines import draw_jump_voltages

    slowest, fastest = float(data.rate.min()), float(data.rate.max())
    ramps = f"{ends[0]:.4g} V to {ends[1]:.4g} V, {slowest:.2g} V/s to {fastest:.2g} V/s"
    return draw_jump_voltages(data, f"{name}: {ramps}, and at rate 0")


def print_result(data: xr.Dataset, directions: tuple[str, ...]) -> None:
    """Print a table of the jump voltages at rate 0, and advice if one is missing."""
    print(f"{'jump':6}{'bonded':>24}{'delaminated':>24}{'change':>12}   in V, at rate 0")
    for jump in directions:
        at = data.sel(jump=jump)
        columns = zip(at.jumps.values, at.standard_error.values, at.decided.values, strict=True)
        texts = [format_voltage(*column) for column in columns]
        change = float(at.jumps[1] - at.jumps[0])
        last = "" if math.isnan(change) else f"{change:.5f}"
        print(f"{jump:6}{texts[0]:>24}{texts[1]:>24}{last:>12}".rstrip())
    if bool((data.decided.sel(jump=list(directions)) == "undecided").any()):
        print("undecided: held voltages do not tell. Ask drive-branch: its folds are the jumps")


def format_voltage(value: float, error: float, decided: str) -> str:
    """Format a voltage with its error; "none" or "undecided" for NaN."""
    if math.isnan(value):
        return "undecided" if decided == "undecided" else "none"
    return f"{value:.5f} +- {error:.5f}"
