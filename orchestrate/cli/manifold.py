"""Command ``manifold``: trace the unstable manifold of a saddle orbit as a curve."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ..units import range_text
from .options import Commands, frequency_option, read_amplitude, read_excitation
from .question import answer_question, draw_result, read_earlier_result
from .start_file import keep_file_name, read_structure_and_question

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} manifold --eta 3.0
  {program} manifold --start orbit.nc --length 20       of an orbit that orbit has written
  {program} manifold --structure beam --hz 14 --g 0.02
What starts beside a saddle with one multiplier outside the unit circle leaves along it."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``manifold`` with its options."""
    text = "the unstable manifold of a saddle of the stroboscopic map, as a curve to each side"
    question = commands.add_response_command(
        "manifold", run, text, EXAMPLES, several=False, from_file=True
    )
    start = "NetCDF file of an orbit (default: the orbit that the command orbit finds)"
    question.add("start", read_earlier_result, type=Path, metavar="FILE", help=start)
    names = ("period", "box_acceleration", "length", "spacing", "angle", "distance", "most")
    question.declare(*names)


def run(arguments: argparse.Namespace) -> None:
    """Run ``manifold``: trace the unstable manifold of a saddle; print, store and draw it."""
    structure, question = read_structure_and_question(arguments)
    question = keep_file_name(question)
    has_excitation = (
        frequency_option(arguments) is not None or read_amplitude(arguments) is not None
    )
    if has_excitation or question["start"] is None:
        question |= read_excitation(arguments, structure, si=True, one=True)
    answer_question(arguments, structure, question, print_result, draw_result)


def print_result(data: xr.Dataset) -> None:
    """Print a manifold's multiplier, each side's length, and where the curve is broken."""
    from ..flags import flag_words

    words, size = flag_words(data.end.attrs), float(data.orbit_size)
    gaps = range_text(data, float(data.x_rel.min()), float(data.x_rel.max()), "m")
    print(f"saddle: multiplier {float(data.multiplier):.6f}; gaps along the curve {gaps}")
    for number, side in enumerate(map(str, data.side.values)):
        part = data.sel(side=side)
        points, far = int(part.arclength.count()), float(part.arclength.max()) / size
        breaks = int((data.break_side == number).sum())
        print(
            f"side {side}: {points} points, {far:.4g} times the orbit's size long, "
            f"{breaks} breaks, ends by {words[int(part.end)]}"
        )
