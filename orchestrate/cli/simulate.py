"""``simulate``: time histories of both masses, the gap and the contact force."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from .options import (
    Commands,
    add_excitation,
    add_numbers,
    add_structure,
    excitation_of,
    numbers_of,
    state_of,
    structure_of,
)
from .output import add_results
from .question import carry_out_beside

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} simulate --eta 0.4 --transient 500 --periods 2      the paper's Figure 5
  {program} simulate --eta 1.047 --beside                       the undamaged structure beside it
  {program} simulate --structure beam --hz 12.5 --g 0.02
  {program} simulate --eta 1.2 --start 0,0.5,0,0                from a gap of 0.5 m"""


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "a motion in time: both masses, gap, contact force, impacts, phase plane and spectrum"
    parser = commands.add("simulate", run, text, EXAMPLES)
    add_structure(parser)
    option = add_excitation(parser, several=False).add_argument
    add_numbers(
        option,
        periods=(20, "periods kept"),
        transient=(0, "periods dropped before"),
        points=(200, "points a period"),
        phase=(0.0, "phase of the box at the start, rad"),
    )
    option("--start", metavar="X1,X2,V1,V2", help="state at the start, m and m/s (default: rest)")
    option("--beside", action="store_true", help="the same of the bonded structure, beside it")
    add_results(parser)


def run(arguments: argparse.Namespace) -> None:
    """Run the command."""
    structure = structure_of(arguments)
    start = state_of("--start", arguments.start)
    question = {
        **excitation_of(arguments, structure, si=True, one=True),
        **numbers_of(arguments, "periods", "transient", "points", "phase"),
        "start": start,
    }
    carry_out_beside(arguments, structure, question, report, picture_of)


def picture_of(data: xr.Dataset, bonded: xr.Dataset | None = None) -> Any:
    """Draw the histories."""
    from ..figures.motion import draw

    return draw(data, bonded=bonded)


def report(data: xr.Dataset) -> None:
    """Print the result."""
    reach = [float(abs(data[name]).max()) for name in ("x1", "x2", "x_rel")]
    print("largest |x1| {:.6g} m, |x2| {:.6g} m, gap {:.6g} m".format(*reach))
    felt = [float(abs(data[name]).max()) for name in ("a1_abs", "a2_abs")]
    print("largest acceleration between impacts {:.4g} and {:.4g} m/s2".format(*felt))
    count = data.sizes["impact"]
    if not count:
        print("no impacts")
        return
    print(f"{count} impacts, the fastest at {float(data.impact_velocity.max()):.4g} m/s")
    sticks = int(data.sticks.sum())
    print(f"{sticks} of them begin permanent contact" if sticks else "no permanent contact begins")
