"""``passage``: a run through the resonance at full resolution."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..units import text_of
from .drives import (
    add_control,
    add_hold,
    add_only,
    add_schedule,
    add_step,
    ask_each,
    control_of,
    schedule_from,
    times_of,
    title_of_runs,
)
from .grammar import plain_float, plain_int
from .options import Commands, structure_and_drive
from .output import add_results

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} passage --eta0 1.4:1.65 --one-way               quick through its resonance
  {program} passage --drive rig --one-way --around 3
  {program} passage --drive beam --voltage 6.5 --duration 10 --speed-control 110
{eta0}
Interrupted, the same command goes on where it was. A finished result is left as it is."""


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "a run through the resonance at full resolution: speed, motion, power, waterfall"
    parser = commands.ask_coupled("passage", run, text, EXAMPLES)
    add_only(parser)
    add_schedule(parser)
    add_control(parser)
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
    add_step(group)
    add_hold(group)
    add_results(parser, store=False, several=True)


def run(arguments: argparse.Namespace) -> None:
    """Compute a run through the resonance at full resolution."""
    from ..weak_drive.schedule import Constant

    structure, drive = structure_and_drive(arguments)
    if arguments.revolutions < 1:
        raise InputError(f"--revolutions {arguments.revolutions}: expected a whole number >= 1")
    control = control_of(arguments, structure, drive)
    schedule = schedule_from(arguments, structure, drive, control)
    around = arguments.around
    if around is None and not isinstance(schedule, Constant):
        around = 300.0 / structure.omega
    question = {
        "voltage": schedule,
        "around": around,
        "control": control,
        **times_of(arguments, structure, "step", "hold"),
    }
    spectra = {"revolutions": arguments.revolutions, "mass": arguments.mass}
    draw = partial(picture_of, name=Path(arguments.drive).stem, spectra=spectra, control=control)
    ask_each(arguments, structure, drive, question, draw, print_result)


def first_of(data: xr.Dataset) -> xr.Dataset:
    """Return samples around the first jump, where they are stored around several."""
    import numpy as np

    gaps = np.diff(data.time.values)
    breaks = np.flatnonzero(gaps > 1.5 * np.median(gaps))
    return data.isel(time=slice(0, int(breaks[0]) + 1)) if breaks.size else data


def picture_of(
    results: dict[str, xr.Dataset], name: str, spectra: dict[str, Any], control: Any
) -> Any:
    """Draw passages and their waterfalls."""
    from .. import waterfall
    from ..figures.passage import draw

    shown = {state: first_of(data) for state, data in results.items()}
    falls = {state: waterfall(data, **spectra) for state, data in shown.items()}
    title = title_of_runs(shown, name, type(control).__name__ if control else "")
    return draw(shown, falls, title)


def print_result(state: str, data: xr.Dataset) -> None:
    """Print the result in a line."""
    from ..figures.passage import format_jumps

    count, first, last = data.sizes["time"], float(data.time[0]), float(data.time[-1])
    stored_part = data.attrs["kept"]
    samples = f"{count} samples, {first:.4g} s to {last:.4g} s ({stored_part})"
    moved = text_of(data, abs(data.x1).max(), "m", ".4g")
    fastest = text_of(data, abs(data.speed).max(), "rad/s", ".4g")
    print(f"{state}: {format_jumps(data)}; {samples}; largest |x1| {moved}, speed up to {fastest}")
