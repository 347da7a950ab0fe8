"""Command ``sweep``: orbit diagrams over a parameter; by default the paper's Figure 6."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ..units import text_of
from .grammar import parse_state
from .options import Commands, add_over_options, read_structure_options, varied_arguments
from .overlay import add_overlay_option, drawing_function
from .question import (
    answer_question,
    format_parameter,
    format_ranges,
    has_flag,
    print_table,
    varied_parameter,
)

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} sweep                                           the paper's Figure 6
  {program} sweep --set e=0.3                               Figure 11
  {program} sweep --eta 1.0:1.5:0.0005 --direction both     up and down: non-unique responses
  {program} sweep --over e --values 0.05:0.95:0.003 --eta 1.2
  {program} sweep --structure beam --hz 8:20:0.05 --g 0.02 --format nc,csv
  {program} sweep --eta 2.4:2.8:0.002 --overlay branch.nc   with what branch has written
Interrupted, the same command goes on where it was. A finished result is left as it is."""
PAPER_RANGE = "0.1:8.0:0.001"  # frequency ratios of Figure 6
KINDS = {
    "irregular": "not periodic",
    "undecided": "still converging or nearly periodic (--transient 5000 decides most)",
}
DIFFERENT = 0.01  # of the largest gap: where up and down differ by more, they are different motions


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``sweep`` with its options."""
    text = "follow responses along the frequency or another parameter: an orbit diagram"
    usual = f"{PAPER_RANGE} where no frequency is given"
    question = commands.add_response_command("sweep", run, text, EXAMPLES, usual=usual)
    add_over_options(question)
    question.group.add_argument(
        "--direction",
        choices=("up", "down", "both"),
        help="order of the values, each started from the end of the last (default: up for a "
        "range, a list as it stands)",
    )
    text = "state that the first value starts from, m and m/s (default: rest)"
    question.add("start", parse_state, metavar="X1,X2,V1,V2", help=text)
    question.declare("transient", "samples", "tolerance")
    add_overlay_option(question)


def run(arguments: argparse.Namespace) -> None:
    """Run ``sweep``: compute an orbit diagram over a parameter; print, store and draw it."""
    structure = read_structure_options(arguments)
    excitation, is_range = varied_arguments(arguments, structure, usual=PAPER_RANGE)
    direction = arguments.direction or ("up" if is_range else "given")
    question = {**excitation, "direction": direction, **arguments.question.keywords(arguments)}
    if question["start"] is None:
        del question["start"]  # a file's name has always been without it
    draw, over = drawing_function(arguments, structure, excitation)
    answer_question(arguments, structure, question, print_result, draw, over=over)


def print_result(data: xr.Dataset) -> None:
    """Print a sweep's largest gap, amplitudes, periodic and irregular ranges, and hysteresis."""
    name = varied_parameter(data)
    if data.sizes[name] == 1:
        print_table(data, name)
        return
    top = data.isel(data.xi_rel_max.argmax(...))
    where = format_parameter(data, name, float(top[name]))
    gap = text_of(data, top.xi_rel_max * top.amplitude * top.eta**2, "m", ".4g")
    print(f"largest gap: xi_Rel = {float(top.xi_rel_max):.6g}, {gap}, at {where}")
    for mass in (1, 2):
        displacement = text_of(data, data[f"x{mass}_max"].max(), "m", ".4g")
        acceleration = text_of(data, data[f"a{mass}_max"].max(), "m/s2", ".4g")
        print(f"mass {mass}: largest displacement {displacement}, acceleration {acceleration}")
    decided = data.multiplicity_decided
    periodic = int(has_flag(decided, "repeated").sum())
    print(f"periodic: {periodic} of {decided.size} responses")
    for word, text in KINDS.items():
        holds = has_flag(decided, word)
        holds = holds.any("direction") if "direction" in holds.dims else holds
        if holds.any():
            ordered = holds.sortby(name)
            print(f"{text} at {format_ranges(data, name, ordered[name].values, ordered.values)}")
    contact = int(data.permanent_contact.sum())
    print(f"with permanent contact: {contact} of {decided.size} responses")
    if "direction" in data.dims:
        print_hysteresis(data, name)


def print_hysteresis(data: xr.Dataset, name: str) -> None:
    """Print the parameter ranges in which up- and down-sweep are different motions."""
    gaps = data.xi_rel_max.sortby(name)
    up, down = (gaps.sel(direction=word) for word in ("up", "down"))
    differ = abs(up - down) > DIFFERENT * abs(gaps).max("direction")
    if not differ.any():
        print(f"up and down are the same to {DIFFERENT:.0%} of the largest gap: no hysteresis here")
        return
    where = format_ranges(data, name, gaps[name].values, differ.values)
    print(f"up and down differ by more than {DIFFERENT:.0%} of the largest gap at {where}")
