"""Command ``resonance``: compute resonance curves, bonded against delaminated."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from ..errors import InputError
from ..units import scale_of
from .grammar import is_single_number
from .options import Commands, excitation_by_level, read_excitation, read_structure_options
from .overlay import add_overlay_option, drawing_function
from .question import (
    answer_question,
    draw_result,
    format_parameter,
    is_curve,
    print_table,
    varied_parameter,
)

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} resonance --structure beam --hz 8:20:0.05 --g 0.02
  {program} resonance --structure beam --rpm 500:1200:5 --amplitude 3e-5 --format nc,csv
  {program} resonance --structure beam --set clearance=-2e-5 --hz 8:20:0.05 --g 0.02,0.1,0.5
  {program} resonance --eta 0.3:4:0.005 --set e=0.3             the paper's structure"""
COLUMNS = {  # of a printed row: title, unit
    "x1_max": ("|x1|", "m"),
    "x2_max": ("|x2|", "m"),
    "a1_max": ("|a1|", "m/s2"),
    "a2_max": ("|a2|", "m/s2"),
    "x_rel_max": ("gap", "m"),
}
LENGTHS = ("x1_max", "x2_max", "x_rel_max")


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``resonance`` with its options."""
    text = (
        "resonance curves: amplitude and peak acceleration, bonded against delaminated; at several "
        "levels (--g FIRST:LAST:STEP), with the level at which a preloaded structure first opens"
    )
    question = commands.add_response_command("resonance", run, text, EXAMPLES)
    question.declare("direction", "transient", "samples", "prominence", "jump")
    add_overlay_option(question)


def run(arguments: argparse.Namespace) -> None:
    """Run ``resonance``: compute curves over frequency, or over levels; print, store and draw."""
    structure = read_structure_options(arguments)
    keywords = arguments.question.keywords(arguments)
    if arguments.g is not None and not is_single_number(arguments.g):
        if arguments.overlay:
            raise InputError(f"--overlay: with several levels, --g {arguments.g}; expected one")
        levels = excitation_by_level(arguments, structure)
        draw = draw_result if is_curve(levels) else None
        question, function = {**levels, **keywords}, "resonance_levels"
        answer_question(arguments, structure, question, print_levels, draw, function=function)
        return
    excitation = read_excitation(arguments, structure, si=True)
    picture, over = drawing_function(arguments, structure, excitation)
    answer_question(
        arguments, structure, {**excitation, **keywords}, print_result, picture, over=over
    )


def print_result(data: xr.Dataset) -> None:
    """Print a resonance result's peaks, jumps and threshold."""
    name = varied_parameter(data)
    if data.sizes[name] == 1:
        print_table(data, name)
        return
    print_peaks(data, name)
    print_jumps(data, name)
    print_threshold(data)


def print_levels(data: xr.Dataset) -> None:
    """Print a table of the largest responses at each level, and the threshold."""
    parted = data.sel(structure="delaminated")
    print(f"{'level':>10}{column_titles(data, LENGTHS)}   largest gap at")
    for level in data.level.values:
        at = parted.sel(level=level)
        top = at.isel(at.x_rel_max.argmax(...))
        numbers = format_row(data, {name: float(at[name].max()) for name in LENGTHS})
        where = format_parameter(data, "frequency", float(top.frequency))
        print(f"{format_parameter(data, 'level', level):>10}{numbers}   {where}")
    print_threshold(data)


def print_threshold(data: xr.Dataset) -> None:
    """Print the lowest level at which the structure first opens or touches, if there is one."""
    if "lowest_threshold" in data:
        event = data.lowest_threshold.attrs["event"]
        level = format_parameter(data, "level", float(data.lowest_threshold))
        where = format_parameter(data, "frequency", float(data.lowest_threshold_frequency))
        print(f"in this range it first {event} at {where}: {level}")


def print_peaks(data: xr.Dataset, name: str) -> None:
    """Print a table of the resonance peaks: structure, frequency and amplitudes."""
    ends = " to ".join(
        format_parameter(data, name, float(end)) for end in (data[name].min(), data[name].max())
    )
    noise = int(data.peak_irregular.sum())
    peaks = data.isel(peak=data.peak_irregular.values == 0)
    if not data.sizes["peak"]:
        print(f"no peak from {ends}: amplitudes rise or fall from end to end")
        return
    if noise:
        print(f"maxima left out, as chance makes them where responses are irregular: {noise}")
    if not peaks.sizes["peak"]:
        print(f"no peak from {ends} where responses are periodic")
        return
    print(f"peaks{'':31}{column_titles(data, COLUMNS)}")
    for i in range(peaks.sizes["peak"]):
        peak = peaks.isel(peak=i)
        numbers = format_row(data, {key: float(peak[f"peak_{key}"]) for key in COLUMNS})
        where = format_parameter(data, name, float(peak[f"peak_{name}"]))
        print(f"  {format_direction(peak, 'peak')} {where:>16}{numbers}")


def column_titles(data: xr.Dataset, names: Iterable[str]) -> str:
    """Return a table's head line with quantities' names and display units."""
    heads = (f"{COLUMNS[name][0]} {scale_of(data, COLUMNS[name][1])[1]}" for name in names)
    return "".join(f"{head:>11}" for head in heads)


def format_row(data: xr.Dataset, values: Mapping[str, float]) -> str:
    """Format a table's numbers as one line, in the display units of their columns."""
    numbers = (value / scale_of(data, COLUMNS[name][1])[0] for name, value in values.items())
    return "".join(f"{number:11.4g}" for number in numbers)


def print_jumps(data: xr.Dataset, name: str) -> None:
    """Print the frequencies at which the largest gap jumps, and its sizes before and after."""
    if not data.sizes["jump"]:
        print("no jump: the response follows the frequency without one in this range")
        return
    print("jumps of the largest gap")
    for i in range(data.sizes["jump"]):
        jump = data.isel(jump=i)
        factor, unit = scale_of(data, "m")
        before, after = (float(jump[f"jump_{side}"]) / factor for side in ("before", "after"))
        sizes = f"{before:.4g} to {after:.4g} {unit}"
        where = format_parameter(data, name, float(jump[f"jump_{name}"]))
        print(f"  {format_direction(jump, 'jump')} {where:>16}  {sizes}")


def format_direction(row: xr.Dataset, what: str) -> str:
    """Format a peak's or jump's structure and sweep direction as a table cell."""
    structure, direction = (str(row[f"{what}_{key}"].values) for key in ("structure", "direction"))
    return f"{structure if structure == 'bonded' else f'{structure}, {direction}':18}"
