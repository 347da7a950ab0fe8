"""Command ``passage``: record a run through the resonance at full time resolution."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..units import text_of
from .drive_options import (
    add_controller_options,
    add_hold_option,
    add_only_option,
    add_schedule_options,
    add_step_option,
    answer_each_structure,
    format_title,
    make_controller,
    make_schedule,
    times_in_seconds,
)
from .grammar import plain_float, plain_int
from .options import Commands, read_drive_options
from .output import add_result_options

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} passage --eta0 1.4:1.65 --one-way               quick through its resonance
  {program} passage --drive rig --one-way --around 3
  {program} passage --drive beam --voltage 6.5 --duration 10 --speed-control 110
{eta0}
Interrupted, the same command goes on where it was. A finished result is left as it is."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``passage`` with its options."""
    text = "a run through the resonance at full resolution: speed, motion, power, waterfall"
    parser = commands.add_drive_command("passage", run, text, EXAMPLES)
    add_only_option(parser)
    add_schedule_options(parser)
    add_controller_options(parser)
    group = parser.add_argument_group("what is kept and drawn")
    around = (
        "time before and after the jump, or the passage where there is no jump, in s (default: "
        "300/omega; all of a run at one voltage)"
    )
    group.add_argument("--around", type=plain_float, metavar="S", help=around)
    turns = "revolutions of each spectrum of the waterfall (default: %(default)s)"
    group.add_argument("--revolutions", type=plain_int, default=8, metavar="N", help=turns)
    mass = "whose acceleration the spectra are of (default: %(default)s)"
    group.add_argument("--mass", type=plain_int, default=1, choices=(1, 2), help=mass)
    add_step_option(group)
    add_hold_option(group)
    add_result_options(parser, store=False, several=True)


def run(arguments: argparse.Namespace) -> None:
    """Run ``passage``: compute a run through the resonance, each structure; print, store, draw."""
    from ..weak_drive.schedule import Constant

    structure, drive = read_drive_options(arguments)
    if arguments.revolutions < 1:
        raise InputError(f"--revolutions {arguments.revolutions}: expected a whole number >= 1")
    control = make_controller(arguments, structure, drive)
    schedule = make_schedule(arguments, structure, drive, control)
    around = arguments.around
    if around is None and not isinstance(schedule, Constant):
        around = 300.0 / structure.omega
    question = {
        "voltage": schedule,
        "around": around,
        "control": control,
        **times_in_seconds(arguments, structure, "step", "hold"),
    }
    spectra = {"revolutions": arguments.revolutions, "mass": arguments.mass}
    draw = partial(draw_results, name=Path(arguments.drive).stem, spectra=spectra, control=control)
    answer_each_structure(arguments, structure, drive, question, draw, print_result)


def first_stored_interval(data: xr.Dataset) -> xr.Dataset:
    """Return the samples of the first jump where a run is stored around several."""
    import numpy as np

    gaps = np.diff(data.time.values)
    breaks = np.flatnonzero(gaps > 1.5 * np.median(gaps))
    return data.isel(time=slice(0, int(breaks[0]) + 1)) if breaks.size else data


def draw_results(
    results: dict[str, xr.Dataset], name: str, spectra: dict[str, Any], control: Any
) -> Any:
    """Draw passages with waterfalls of their spectra; return the figure."""
    from .. import waterfall
    from ..figures.passage import draw

    shown = {state: first_stored_interval(data) for state, data in results.items()}
    falls = {state: waterfall(data, **spectra) for state, data in shown.items()}
    title = format_title(shown, name, type(control).__name__ if control else "")
    return draw(shown, falls, title)


def print_result(state: str, data: xr.Dataset) -> None:
    """Print one structure's passage in a line: samples, times, jumps or passage."""
    from ..figures.passage import format_jumps

    count, first, last = data.sizes["time"], float(data.time[0]), float(data.time[-1])
    stored_part = data.attrs["kept"]
    samples = f"{count} samples, {first:.4g} s to {last:.4g} s ({stored_part})"
    moved = text_of(data, abs(data.x1).max(), "m", ".4g")
    fastest = text_of(data, abs(data.speed).max(), "rad/s", ".4g")
    print(f"{state}: {format_jumps(data)}; {samples}; largest |x1| {moved}, speed up to {fastest}")
