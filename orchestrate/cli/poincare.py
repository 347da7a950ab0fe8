"""``poincare``: the section of a motion, at a phase of the box, at impacts or at releases."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ..units import scale_of
from .grammar import state_of
from .options import Commands, excitation_of, structure_of
from .question import carry_out, picture_of

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
    """Add the command's parser."""
    text = "a Poincaré section: states at a phase of the box, at impacts or at releases"
    question = commands.ask("poincare", run, text, EXAMPLES, several=False)
    question.declare("at", "phase", "transient", "periods")
    start = "state at phase 0, m and m/s (default: rest)"
    question.add("start", state_of, metavar="X1,X2,V1,V2", help=start)


def run(arguments: argparse.Namespace) -> None:
    """Compute a Poincaré section: at a phase of the box, at impacts or at releases."""
    structure = structure_of(arguments)
    excitation = excitation_of(arguments, structure, si=True, one=True)
    question = {**excitation, **arguments.question.keywords(arguments)}
    carry_out(arguments, structure, question, print_result, picture_of)


def print_result(data: xr.Dataset) -> None:
    """Print how many points the section has, and where they lie."""
    count = data.sizes["point"]
    print(f"{count} points")
    if not count:
        return
    for name, label in SHOWN[str(data.attrs["at"])].items():
        low, high = float(data[name].min()), float(data[name].max())
        factor, unit = scale_of(data, str(data[name].attrs["units"]))
        print(f"{label} from {low / factor:.6g} to {high / factor:.6g} {unit}")
