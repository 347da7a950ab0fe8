"""Command ``basin``: compute basins of attraction over a plane of start states."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

import orchestrate

from ..units import range_text
from .grammar import parse_plane_side, parse_state
from .options import Commands, read_question
from .question import answer_question, draw_result, print_attractors

if TYPE_CHECKING:
    import xarray as xr

FEWEST_STARTS = 32  # along a side, for entropies
EXAMPLES = """\
  {program} basin --eta 1.315
  {program} basin --eta 1.315 --x x_rel,0,1.3,60 --y v_rel,-1.3,1.3,60
  {program} basin --eta 1.32 --x phase,0,6.28,40 --y v1,-2,2,40
  {program} basin --structure beam --hz 15.8 --g 0.02 --x x_rel,0,1e-3,40 --y v_rel,-0.1,0.1,40
Coordinates: x1 x2 x_rel in m, v1 v2 v_rel in m/s, phase in rad. What is not varied is that of
--at, such as a state that the command attractors has found."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``basin`` with its options."""
    text = "basins of attraction: which motion each start of a plane leads to"
    question = commands.add_response_command("basin", run, text, EXAMPLES, several=False)
    form = "NAME,FIRST,LAST,COUNT"
    side = "horizontal side of the plane (default: x_rel as far as twice the attractors' largest "
    question.add("x", parse_plane_side, metavar=form, help=f"{side}gap, 80 values)")
    side = "vertical side of the plane (default: v_rel as far as twice the attractors' largest "
    question.add("y", parse_plane_side, metavar=form, help=f"{side}rate, 80 values)")
    rest = (
        "state that the plane goes through, m and m/s "
        "(default: rest; without --x and --y the mean of the attractors)"
    )
    question.add("at", parse_state, metavar="X1,X2,V1,V2", help=rest)
    question.declare("phase", "transient", "settle", "samples")


def run(arguments: argparse.Namespace) -> None:
    """Run ``basin``: compute which attractor each start of a plane leads to; print, store, draw."""
    structure, question = read_question(arguments)
    answer_question(arguments, structure, question, print_result, draw_result)


def print_result(data: xr.Dataset) -> None:
    """Print a basin result: the plane, its attractors with their shares, the basin entropy."""
    labels = data.attractor_of.values
    started, overlapping = int((labels >= 0).sum()), int((labels < 0).sum())
    print(f"{data.sizes['attractor']} found, of {started} starts in {format_plane(data)}")
    print_attractors(data, "the plane")
    if overlapping:
        print(f"{overlapping} starts left out: there the masses would overlap")
    print_entropy(data)


def format_plane(data: xr.Dataset) -> str:
    """Format the coordinates and ranges of a basin's plane as text, with units."""
    axes = [data[name] for name in map(str, data.attractor_of.dims)]
    ranges = (
        range_text(data, axis.min().item(), axis.max().item(), str(axis.attrs["units"]))
        for axis in axes
    )
    return ", ".join(f"{axis.name} {text}" for axis, text in zip(axes, ranges, strict=True))


def print_entropy(data: xr.Dataset) -> None:
    """Print the basin entropy of a plane of start states; nothing if they are too few."""
    if data.sizes["attractor"] < 2 or min(data.attractor_of.shape) < FEWEST_STARTS:
        return
    mixed = orchestrate.basin_entropy(data)
    exponent, error = float(mixed.uncertainty_exponent), float(mixed.uncertainty_exponent_error)
    entropies = float(mixed.basin_entropy), float(mixed.boundary_basin_entropy)
    print("basin entropy {:.3g}, at boundaries {:.3g} (above 0.69: fractal)".format(*entropies))
    if math.isfinite(exponent):
        print(f"uncertainty exponent {exponent:.3g} +- {error:.2g} (1: smooth boundaries)")
