"""Command ``poincare``: compute a Poincaré section of a motion."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ..units import scale_of
from .grammar import parse_state
from .options import Commands, read_question
from .question import answer_question, draw_result

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} poincare --eta 2.9 --periods 5000
  {program} poincare --eta 0.8 --at impacts
  {program} poincare --structure beam --hz 12.5 --g 0.02 --at releases"""

SHOWN = {  # of each section
    "phase": {"x_rel": "gap", "v_rel": "its rate"},
    "impacts": {"impact_velocity": "closing speed", "phase": "phase of the box"},
    "releases": {"v1": "velocity of both masses", "phase": "phase of the box"},
}


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``poincare`` with its options."""
    text = "a Poincaré section: states at a phase of the box, at impacts or at releases"
    question = commands.add_response_command("poincare", run, text, EXAMPLES, several=False)
    question.declare("at", "phase", "transient", "periods")
    start = "state at phase 0, m and m/s (default: rest)"
    question.add("start", parse_state, metavar="X1,X2,V1,V2", help=start)


def run(arguments: argparse.Namespace) -> None:
    """Run ``poincare``: compute a section at a phase, at impacts or at releases; print, draw."""
    structure, question = read_question(arguments)
    answer_question(arguments, structure, question, print_result, draw_result)


def print_result(data: xr.Dataset) -> None:
    """Print the number of points of a Poincaré section and the ranges they lie in."""
    count = data.sizes["point"]
    print(f"{count} points")
    if not count:
        return
    for name, label in SHOWN[str(data.attrs["at"])].items():
        low, high = float(data[name].min()), float(data[name].max())
        factor, unit = scale_of(data, str(data[name].attrs["units"]))
        print(f"{label} from {low / factor:.6g} to {high / factor:.6g} {unit}")
