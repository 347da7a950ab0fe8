"""Command ``capture``: which voltages let a motor started from rest pass the resonance."""

from __future__ import annotations

import argparse
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..units import text_of
from .drive_options import (
    add_controller_options,
    add_only_option,
    add_step_option,
    add_voltage_options,
    answer_each_structure,
    averaged_jump_voltages,
    make_controller,
    parse_ramp_ends,
    times_in_seconds,
)
from .grammar import parse_values
from .options import Commands, read_drive_options
from .output import add_result_options

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Drive, Structure

UNDECIDED, NEITHER = "undecided", "settled at the resonance"
EXAMPLES = """\
  {program} capture                                       quick, bonded and delaminated
  {program} capture --drive beam --voltage 6.1:6.9
  {program} capture --over rotor_inertia --values 600:1600:200
  {program} capture --drive beam --set armature_resistance=120 --voltage 7:10 --speed-gradient
{eta0}
The motor is switched on at once and followed until its speed has settled. Interrupted, the same
command goes on where it was."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``capture`` with its options."""
    text = "voltages switched on from rest: which pass the resonance, which are captured"
    parser = commands.add_drive_command("capture", run, text, EXAMPLES)
    add_only_option(parser)
    question = commands.add_function_options(parser)
    group, option = question.group, question.group.add_argument
    add_voltage_options(group, "LOWEST:HIGHEST", "from the jump down to above the jump up")
    option("--over", metavar="NAME", help="a second parameter, of drive or structure")
    option("--values", metavar="VALUES", help="its values, FIRST:LAST:STEP or a list A,B,...")
    question.declare("count", "tolerance", "time")
    add_step_option(group)
    add_controller_options(parser)
    add_result_options(parser, store=False, several=True)


def voltage_range(
    arguments: argparse.Namespace, structure: Structure, drive: Drive
) -> tuple[float, float]:
    """Return the lowest and highest starting voltage to try, V, from the options."""
    if arguments.eta0 or arguments.voltage:
        return parse_ramp_ends(arguments, structure, drive)
    down, up = averaged_jump_voltages(arguments, structure, drive)
    return down, 1.06 * up


def run(arguments: argparse.Namespace) -> None:
    """Run ``capture``: find the voltages that pass the resonance or are captured; print, draw."""
    structure, drive = read_drive_options(arguments)
    if (arguments.over is None) != (arguments.values is None):
        raise InputError("--over and --values: expected both, or none of them")
    values = parse_values("--values", arguments.values, zero=True)[0] if arguments.over else None
    question = {
        "voltage": voltage_range(arguments, structure, drive),
        "over": arguments.over,
        "values": values,
        **arguments.question.keywords(arguments),
        "control": make_controller(arguments, structure, drive),
        **times_in_seconds(arguments, structure, "step"),
    }
    draw = partial(draw_results, name=Path(arguments.drive).stem, question=question)
    answer_each_structure(arguments, structure, drive, question, draw, print_result)


def draw_results(results: dict[str, xr.Dataset], name: str, question: dict[str, Any]) -> Any:
    """Draw capture maps of the bonded and the delaminated structure; return the figure."""
    from ..figures.weak_drive import draw_capture

    control = question["control"]
    switched = f"controlled by {type(control).__name__}" if control else "switched on from rest"
    first, last = question["voltage"]
    return draw_capture(results, f"{name}: {switched}, {first:.4g} V to {last:.4g} V")


def print_result(state: str, data: xr.Dataset) -> None:
    """Print one structure's threshold voltage, or its capture map, under its name."""
    (over,) = {str(dim) for dim in data.passes.dims} - {"voltage"} or {""}
    if not over:
        print(f"{state}: {format_map(data)}")
        return
    for value in data[over].values:
        print(f"{state}, {over} = {value:g}: {format_map(data.sel({over: value}))}")


def format_map(data: xr.Dataset) -> str:
    """Format a capture result as lines of text, with warnings about undecided starts."""
    lines = [
        format_threshold(data) if math.isfinite(float(data.border)) else format_no_threshold(data)
    ]
    reasons = {
        UNDECIDED: "undecided: the speed had not settled; give a longer --time",
        NEITHER: "neither passed nor captured: the speed settles at the resonance",
    }
    for decision, reason in reasons.items():
        volts = data.voltage.values[data.decision.values == decision]
        if volts.size:
            lines.append(f"at {', '.join(f'{volt:.5g}' for volt in volts)} V {reason}")
    if float(data.above_fold):
        lines.append(
            f"warning: that is above the fold at {float(data.fold):.5f} V, beyond which by the "
            "averaged theory no motion below the resonance is left"
        )
    return "\n  ".join(lines)


def format_threshold(data: xr.Dataset) -> str:
    """Format the voltage between capture and passage, or the interval it lies in."""
    low, high = float(data.border_low), float(data.border_high)
    slowest = f"in at most {float(data.passage_time.max()):.4g} s as tried"
    below, beyond = float(data.speed_low), float(data.speed_high)
    speeds = "" if math.isnan(below) else f"{text_of(data, below, 'rad/s', '.4g')} below, "
    speeds = f"{speeds}{text_of(data, beyond, 'rad/s', '.4g')} beyond"
    if high - low > float(data.border.attrs["tolerance"]):
        between = f"captured up to {low:.5f} V, passes from {high:.5f} V on, {slowest}; {speeds}"
        return f"{between}; undecided between"
    error = f"(+- {0.5 * (high - low):.1g} V)"
    return f"passes from {float(data.border):.5f} V on {error}, {slowest}; {speeds}"


def format_no_threshold(data: xr.Dataset) -> str:
    """Format why a capture result has no threshold voltage."""
    low, high = (float(end) for end in (data.voltage[0], data.voltage[-1]))
    passes, undecided = data.passes.values > 0, data.decision.isin([UNDECIDED, NEITHER]).values
    if passes.all():
        return f"passes at all voltages tried, {low:.4g} V to {high:.4g} V"
    if not passes.any() and not undecided.any():
        return f"captured at all voltages tried, {low:.4g} V to {high:.4g} V"
    if undecided.any():
        counts = f"{passes.sum()} pass, {(~passes & ~undecided).sum()} are captured"
        return f"no border: of the voltages tried {counts}, {undecided.sum()} are undecided"
    return f"captured at the highest voltage tried, {high:.4g} V, not at all lower ones"
