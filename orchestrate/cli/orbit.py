"""``orbit``: one periodic motion, stable or not."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

import orchestrate

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
from .question import carry_out

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} orbit --eta 3.0                     unstable: simulate would leave it
  {program} orbit --eta 1.32 --period 2
  {program} orbit --structure beam --hz 16.7 --g 0.02
Floquet multipliers: of a stable orbit all lie inside the unit circle."""


def add_parser(commands: Commands) -> None:
    """Add the command's parser."""
    text = "a periodic motion by Newton's method, stable or unstable, with its multipliers"
    parser = commands.add("orbit", run, text, EXAMPLES)
    add_structure(parser)
    option = add_excitation(parser, several=False).add_argument
    guess = "state at phase 0 to begin with, m and m/s (default: from the response from rest)"
    option("--guess", metavar="X1,X2,V1,V2", help=guess)
    add_numbers(
        option,
        period=(1, "excitation periods after which it closes"),
        box_acceleration=(0.0, "constant acceleration of the box beside the harmonic one, m/s2"),
    )
    add_results(parser)


def run(arguments: argparse.Namespace) -> None:
    """Run the command."""
    structure = structure_of(arguments)
    excitation = excitation_of(arguments, structure, si=True, one=True)
    question = {
        **excitation,
        "guess": state_of("--guess", arguments.guess),
        **numbers_of(arguments, "period", "box_acceleration"),
    }

    def picture_of(data: xr.Dataset) -> Any:
        """Draw the motion over its periods, started on it."""
        from ..figures.motion import draw

        start = data.state.isel(sample=0).values
        shown = orchestrate.simulate(structure, **excitation, periods=arguments.period, start=start)
        return draw(shown)

    drawable = not arguments.box_acceleration
    carry_out(arguments, structure, question, report, picture_of if drawable else None)


def report(data: xr.Dataset) -> None:
    """Print stability and impacts."""
    parts = data.multipliers.transpose("multiplier", "part").values
    size = max(abs(complex(*pair)) for pair in parts)
    word = "stable" if bool(data.stable) else "unstable"
    print(f"{word}: the largest of its multipliers has the absolute value {size:.6f}")
    print("multipliers " + ", ".join(f"{real:.6f}{imaginary:+.6f}i" for real, imaginary in parts))
    times = data.impact_time.values
    for time, speed in zip(times, data.impact_velocity.values, strict=True):
        if time == time:
            print(f"impact at {time:.8g} s, closing at {speed:.6g} m/s")
    for i, state in enumerate(data.state.values):
        numbers = ", ".join(f"{value:.8g}" for value in state)
        print(f"state at phase 0 after {i} periods: {numbers} (x1, x2 in m, v1, v2 in m/s)")
    print(f"largest gap: xi_Rel = {float(data.xi_rel_max):.6g}")
