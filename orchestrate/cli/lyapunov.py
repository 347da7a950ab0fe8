"""Command ``lyapunov``: compute largest Lyapunov exponents along a parameter."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

import orchestrate

from .options import Commands, add_over_options, read_structure_options, varied_arguments
from .output import read_running_options
from .question import (
    answer_question,
    draw_result,
    format_parameter,
    format_ranges,
    is_curve,
    varied_parameter,
)

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} lyapunov --eta 2.5:3.8:0.02 --follow up        along a sweep
  {program} lyapunov --eta 1.2 --over e --values 0.1:0.9:0.02
  {program} lyapunov --structure beam --hz 12.5,16.7 --amplitude 1e-4
Chaotic, periodic: the exponent is three standard errors from zero. Neutral: quasi-periodic, or not
decided with so few --periods."""
WORDS = {1: "chaotic", 0: "neutral", -1: "periodic"}


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``lyapunov`` with its options."""
    text = "largest Lyapunov exponents of responses: periodic, neutral or chaotic"
    question = commands.add_response_command("lyapunov", run, text, EXAMPLES)
    add_over_options(question)
    follow = "responses of a sweep in this direction (default: each from rest)"
    question.group.add_argument("--follow", choices=("up", "down"), help=follow)
    question.declare("transient", "periods", "sigmas", "spectrum")


def run(arguments: argparse.Namespace) -> None:
    """Run ``lyapunov``: compute largest Lyapunov exponents; print verdicts, store and draw them."""
    structure = read_structure_options(arguments)
    excitation, _ = varied_arguments(arguments, structure)
    question = {**excitation, **arguments.question.keywords(arguments)}
    if arguments.follow:
        swept: dict[str, Any] = {**excitation, "direction": arguments.follow, "samples": 1}
        swept["transient"] = arguments.transient
        question["start"] = orchestrate.sweep(structure, **swept, **read_running_options(arguments))
    answer_question(
        arguments, structure, question, print_result, draw_result if is_curve(excitation) else None
    )


def print_result(data: xr.Dataset) -> None:
    """Print how many exponents have which verdict, and the parameter ranges of each."""
    name = varied_parameter(data)
    ordered = data.sortby(name)
    if data.sizes[name] <= 10:
        for value, exponent, error, verdict in zip(
            *(ordered[key].values for key in (name, "exponent", "standard_error", "verdict")),
            strict=True,
        ):
            where = format_parameter(data, name, float(value))
            print(f"{where}: exponent {exponent:.5f} +- {error:.5f} per tau, {WORDS[int(verdict)]}")
        print_undecided(ordered)
        return
    top = data.isel(data.exponent.argmax(...))
    where = format_parameter(data, name, float(top[name]))
    print(
        f"largest exponent {float(top.exponent):.5f} +- {float(top.standard_error):.5f} per tau "
        f"at {where}; of {data.exponent.size} it is chosen for its error "
        "too: ask for it alone, with more --periods and another --transient"
    )
    for verdict, word in WORDS.items():
        holds = ordered.verdict.values == verdict
        where = (
            f" at {format_ranges(data, name, ordered[name].values, holds)}" if holds.any() else ""
        )
        print(f"{word}: {int(holds.sum())} of {holds.size}{where}")
    print_undecided(ordered)


def print_undecided(data: xr.Dataset) -> None:
    """Print how many periods would decide whether neutral responses are chaotic or periodic."""
    neutral = data.isel({varied_parameter(data): data.verdict.values == 0})
    sizes = abs(neutral.exponent.values)
    if not (sizes > 0.0).any():
        return
    wander = math.log(float(data.attrs["wander"]))
    needed = max(
        wander / (size * period)
        for size, period in zip(sizes, neutral.period.values, strict=True)
        if size > 0.0
    )
    if needed > float(data.attrs["periods"]):
        print(
            f"neutral: quasi-periodic, or too few periods: exponents of these sizes take about "
            f"--periods {math.ceil(needed)}"
        )
