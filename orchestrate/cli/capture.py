"""``capture``: whether a motor switched on from rest passes the resonance."""

from __future__ import annotations

import argparse
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .drives import (
    ETA0,
    add_control,
    add_ends,
    add_only,
    add_step,
    ask_each,
    control_of,
    folds_of,
    step_of,
    two_voltages,
)
from .options import Commands, add_drive, described, plain_float, plain_int, values_of
from .output import add_results

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Drive, Structure

EXAMPLES = """\
  {program} capture                                       quick, bonded and delaminated
  {program} capture --drive beam --voltage 6.1:6.9
  {program} capture --over rotor_inertia --values 600:1600:200
  {program} capture --drive beam --set armature_resistance=120 --voltage 7:10 --speed-gradient
{eta0}
The motor is switched on at once. Interrupted, the same command goes on where it was."""


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "voltages switched on from rest: which pass the resonance, which are captured"
    parser = commands.add("capture", run, text, EXAMPLES.replace("{eta0}", ETA0))
    add_drive(parser)
    add_only(parser)
    group = parser.add_argument_group("question")
    option = group.add_argument
    add_ends(group, "LOWEST:HIGHEST", "from the jump down to above the jump up")
    option("--over", metavar="NAME", help="a second parameter, of drive or structure")
    option("--values", metavar="VALUES", help="its values, FIRST:LAST:STEP or a list A,B,...")
    option(
        "--count", type=plain_int, default=9, help="voltages tried for each (default: %(default)s)"
    )
    border = "of the border found by bisection, V (default: %(default)s)"
    option("--tolerance", type=plain_float, default=1e-4, help=border)
    option(
        "--time", type=plain_float, metavar="S", help="time given to pass, s (default: 1500/omega)"
    )
    add_step(group)
    add_control(parser)
    add_results(parser, store=False, several=True)


def range_of(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> tuple[float, float]:
    """Lowest and highest voltage, V."""
    if arguments.eta0 or arguments.voltage:
        return two_voltages(arguments, structure, drive)
    down, up = folds_of(arguments, structure, drive)
    return down, 1.06 * up


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    structure, drive = described(arguments)
    if (arguments.over is None) != (arguments.values is None):
        raise InputError("--over and --values: expected both, or none of them")
    values = values_of("--values", arguments.values, zero=True)[0] if arguments.over else None
    question = {
        "voltage": range_of(arguments, structure, drive),
        "over": arguments.over,
        "values": values,
        "count": arguments.count,
        "tolerance": arguments.tolerance,
        "time": arguments.time,
        "control": control_of(arguments, structure, drive),
        "step": step_of(arguments, structure),
    }
    draw = partial(picture_of, name=Path(arguments.drive).stem, asked=question)
    ask_each(arguments, structure, drive, question, draw, report)


def picture_of(found: dict[str, xr.Dataset], name: str, asked: dict[str, Any]) -> Any:
    """The maps."""
    from ..figures.capture import draw

    control = asked["control"]
    switched = f"controlled by {type(control).__name__}" if control else "switched on from rest"
    first, last = asked["voltage"]
    return draw(found, f"{name}: {switched}, {first:.4g} V to {last:.4g} V")


def report(state: str, data: xr.Dataset) -> None:
    """The borders, in a few lines."""
    (over,) = {str(dim) for dim in data.passes.dims} - {"voltage"} or {""}
    if not over:
        print(f"{state}: {words(data)}")
        return
    for value in data[over].values:
        print(f"{state}, {over} = {value:g}: {words(data.sel({over: value}))}")


def words(data: xr.Dataset) -> str:
    """What came out for one system."""
    border, passes = float(data.border), data.passes.values
    if math.isfinite(border):
        times = data.passage_time.values
        slowest = f"{times[passes > 0].max():.4g}"
        error = 0.5 * float(data.border.attrs["tolerance"])
        return f"passes from {border:.5f} V on (+- {error:.1g} V), in at most {slowest} s as tried"
    low, high = (float(end) for end in (data.voltage[0], data.voltage[-1]))
    if passes.all():
        return f"passes at all voltages tried, {low:.4g} V to {high:.4g} V"
    if not passes.any():
        return f"captured at all voltages tried, {low:.4g} V to {high:.4g} V"
    return f"captured at the highest voltage tried, {high:.4g} V, not at all lower ones"
