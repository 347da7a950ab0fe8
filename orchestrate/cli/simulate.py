"""Command ``simulate``: time histories of both masses, the gap and the contact force."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ..units import text_of
from .grammar import parse_state
from .options import Commands, add_beside_option, read_question
from .question import answer_with_bonded

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} simulate --eta 0.4 --transient 500 --periods 2      the paper's Figure 5
  {program} simulate --eta 1.047 --beside                       the undamaged structure beside it
  {program} simulate --structure beam --hz 12.5 --g 0.02
  {program} simulate --eta 1.2 --start 0,0.5,0,0                from a gap of 0.5 m"""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``simulate`` with its options."""
    text = "a motion in time: both masses, gap, contact force, impacts, phase plane and spectrum"
    question = commands.add_response_command("simulate", run, text, EXAMPLES, several=False)
    question.declare("periods", "transient", "points", "phase")
    start = "state at the start, m and m/s (default: rest)"
    question.add("start", parse_state, metavar="X1,X2,V1,V2", help=start)
    add_beside_option(question)


def run(arguments: argparse.Namespace) -> None:
    """Run ``simulate``: compute time histories; print, store and draw them."""
    structure, question = read_question(arguments)
    answer_with_bonded(arguments, structure, question, print_result)


def print_result(data: xr.Dataset) -> None:
    """Print a simulation's largest displacements, gap and accelerations, and its impacts."""
    reach = [text_of(data, abs(data[n]).max(), "m") for n in ("x1", "x2", "x_rel")]
    print("largest |x1| {}, |x2| {}, gap {}".format(*reach))
    accelerations = [
        text_of(data, abs(data[name]).max(), "m/s2", ".4g") for name in ("a1_abs", "a2_abs")
    ]
    print("largest acceleration between impacts {} and {}".format(*accelerations))
    count = data.sizes["impact"]
    if not count:
        print("no impacts")
        return
    fastest = text_of(data, data.impact_velocity.max(), "m/s", ".4g")
    print(f"{count} impacts, the fastest at {fastest}")
    sticks = int(data.sticks.sum())
    print(f"{sticks} of them begin permanent contact" if sticks else "no permanent contact begins")
