"""Command ``drive-branch``: trace stationary motions of structure and motor over the voltage."""

from __future__ import annotations

import argparse
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..units import text_of
from .drive_options import answer_both_structures
from .grammar import parse_ends
from .options import Commands, read_drive_options
from .output import add_result_options

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from ..weak_drive.ramp_path import Path as RampPath

FOLD = "fold"
STARTS = {"up": "from the lowest speed", "down": "from the highest speed"}
ENDS = {
    "limit": "it reaches the end of the range of speeds",
    "grazing of a flight": "it ends where the masses touch once more (grazing of a flight)",
    "grazing of an impact": "it ends where an impact vanishes (grazing of an impact)",
    "meets the motion of half its period": "it meets the motion of half its period",
    "loss of permanent contact": "it ends where a chattering no longer ends in contact",
}
EXAMPLES = """\
  {program} drive-branch                              quick, bonded and delaminated
  {program} drive-branch --drive beam --speed 92:110
Branches go round their folds. Interrupted, the same command goes on where it was."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``drive-branch`` with its options."""
    text = "stationary motions of structure and motor, stable and unstable, and their bifurcations"
    parser = commands.add_drive_command("drive-branch", run, text, EXAMPLES)
    question = commands.add_function_options(parser)
    speed = "range of mean speeds, rad/s (default: 0.95 and 1.25 times the resonance)"
    question.add("speed", parse_ends, metavar="FIRST:LAST", help=speed)
    question.declare("longest", "most", "period", "steps", "settle")
    add_result_options(parser, several=True)


def run(arguments: argparse.Namespace) -> None:
    """Run ``drive-branch``: trace branches of stationary motions; print, store and draw them."""
    structure, drive = read_drive_options(arguments)
    question = arguments.question.keywords(arguments)
    draw = partial(draw_result, name=Path(arguments.drive).stem)
    answer_both_structures(arguments, structure, drive, question, draw, print_result)


def draw_result(data: xr.Dataset, name: str) -> Any:
    """Draw branches of stationary motions: speed over voltage, amplitude over speed."""
    from ..figures.weak_drive import draw_stationary

    volts = f"{float(data.voltage.min()):.4g} V to {float(data.voltage.max()):.4g} V"
    return draw_stationary(data, f"{name}: stationary motions, held by {volts}")


def print_result(data: xr.Dataset) -> None:
    """Print the branches' bifurcations, which of them slow ramps meet, and where branches end."""
    from ..weak_drive.ramp_path import ramp_paths

    paths = {str(name): ramp_paths(data, str(name)) for name in data.structure.values}
    names = ("structure", "kind", "voltage", "speed")
    for i, (structure, kind, voltage, speed) in enumerate(
        zip(*(data[f"bifurcation_{name}"].values for name in names), strict=True)
    ):
        direction = (
            jump_direction(data.sel(structure=structure), voltage, speed) if kind == FOLD else ""
        )
        what = format_ramp_effect(data, paths[structure], i, direction)
        rate = text_of(data, speed, "rad/s", ".5g")
        print(f"{structure}: {kind} at {voltage:.5f} V, {rate}{what}")
    for structure, both in paths.items():
        for direction, path in both.items():
            if path.end and len(path.landings) in (0, len(path.jumps) - 1):
                print(f"{structure}, a slow ramp {direction}: {path.end}")
    if not data.sizes["bifurcation"]:
        print("no bifurcations")
    for structure in data.structure.values:
        for leg in data.leg.values:
            at = data.sel(structure=structure, leg=leg)
            count = int(at.voltage.notnull().sum())
            if count:
                stable = int(at.stable.sum())
                end = ENDS.get(at.end.item(), f"ends early: {at.end.item()}")
                print(f"{structure}, {leg}: {count} motions, {stable} of them stable; {end}")
                print_unlocated(at, data.bifurcation_speed.values)


def format_ramp_effect(data: xr.Dataset, paths: dict[str, RampPath], i: int, direction: str) -> str:
    """Format what a slow ramp does at a bifurcation: jump, go on, or not meet it; may be empty."""
    for name, path in paths.items():
        if i in path.slow_losses:
            return f": a slow ramp {name} that nothing disturbs goes on to the fold"
        if i in path.jumps:
            turn = path.jumps.index(i)
            next_one = "the next jump" if turn else "the jump"
            landings = [text_of(data, speed, "rad/s", ".5g") for speed in path.landings[turn:]]
            landing = f", to {landings[0]}" if landings else ""
            return f": {next_one} {name} of a slow ramp, at rate 0{landing}"
    if not direction:
        return ""
    if paths[direction].jumps:
        return f": a jump {direction} that a slow ramp {STARTS[direction]} does not meet"
    return f": a jump {direction}; whether a slow ramp meets it these branches do not tell"


def jump_direction(branch: xr.Dataset, voltage: float, speed: float) -> str:
    """Return the way ("up", "down") the speed jumps at a fold; empty if it does not jump."""
    import numpy as np

    spans = {name: float(branch[name].max() - branch[name].min()) for name in ("voltage", "speed")}
    nearest, around = math.inf, None
    for leg in branch.leg.values:
        at = branch.sel(leg=leg).dropna("point", subset=["voltage"])
        if at.sizes["point"] < 3:
            continue
        distance = np.hypot(
            (at.voltage.values - voltage) / spans["voltage"],
            (at.speed.values - speed) / spans["speed"],
        )
        near = int(distance.argmin())
        if distance[near] < nearest:
            nearest, around = distance[near], at.isel(point=slice(max(near - 1, 0), near + 2))
    if around is None or set(around.stable.values.astype(int)) != {0, 1}:
        return ""
    return "up" if float(around.voltage.mean()) < voltage else "down"


def print_unlocated(leg: xr.Dataset, speeds: np.ndarray) -> None:
    """Print the speeds at which a branch's stability changes without a located bifurcation."""
    at = leg.dropna("point", subset=["voltage"])
    stable = at.stable.values.astype(int)
    for i in (stable[1:] != stable[:-1]).nonzero()[0]:
        low, high = sorted(at.speed.values[i : i + 2])
        if not ((speeds > low - (high - low)) & (speeds < high + (high - low))).any():
            where = text_of(at, low, "rad/s", ".5g")
            print(f"  stability changes near {where} too, not located: see --period")
