"""Command ``orbit``: find a periodic orbit, stable or unstable, by Newton's method."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

import orchestrate

from ..units import text_of, units_of, with_units
from .grammar import parse_state
from .options import Commands, read_excitation, read_structure_options
from .question import answer_question, format_largest_gap

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """\
  {program} orbit --eta 3.0                     unstable: simulate would leave it
  {program} orbit --eta 1.32 --period 2
  {program} orbit --structure beam --hz 16.7 --g 0.02
Floquet multipliers: of a stable orbit all lie inside the unit circle."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``orbit`` with its options."""
    text = "a periodic motion by Newton's method, stable or unstable, with its multipliers"
    question = commands.add_response_command("orbit", run, text, EXAMPLES, several=False)
    guess = "state at phase 0 to begin with, m and m/s (default: from the response from rest)"
    question.add("guess", parse_state, metavar="X1,X2,V1,V2", help=guess)
    question.declare("period", "box_acceleration")


def run(arguments: argparse.Namespace) -> None:
    """Run ``orbit``: find a periodic orbit by Newton's method; print, store and draw it."""
    structure = read_structure_options(arguments)
    excitation = read_excitation(arguments, structure, si=True, one=True)
    question = {**excitation, **arguments.question.keywords(arguments)}

    def draw_orbit(data: xr.Dataset) -> Any:
        """Simulate one period from the orbit's state and draw the motion; return the figure."""
        from ..figures.histories import draw_motion

        start = data.state.isel(sample=0).values
        motion = orchestrate.simulate(
            structure, **excitation, periods=arguments.period, start=start
        )
        shown = with_units(motion, units_of(data))
        return draw_motion(shown, orbit_title(data, shown))

    drawable = not arguments.box_acceleration
    answer_question(arguments, structure, question, print_result, draw_orbit if drawable else None)


def orbit_title(orbit: xr.Dataset, motion: xr.Dataset) -> str:
    """Return the title of an orbit's picture: whether it is stable, structure and excitation."""
    from ..figures.labels import title_from_attributes

    return f"{stability(orbit)} orbit, {title_from_attributes(motion)}"


def stability(orbit: xr.Dataset) -> str:
    """Return "stable", "unstable" or "undecided"."""
    from ..flags import flag_words

    return flag_words(orbit.stability.attrs)[int(orbit.stability)]


def print_result(data: xr.Dataset) -> None:
    """Print an orbit's stability, multipliers, impacts, states at phase 0 and largest gap."""
    parts = data.multipliers.transpose("multiplier", "part").values
    size = max(abs(complex(*pair)) for pair in parts)
    print(f"{stability(data)}: the largest of its multipliers has the absolute value {size:.6f}")
    if stability(data) == "undecided":
        print("the FMU, started on it, has other impacts: it may be no motion")
    print("multipliers " + ", ".join(f"{real:.6f}{imaginary:+.6f}i" for real, imaginary in parts))
    times = data.impact_time.values
    for time, speed in zip(times, data.impact_velocity.values, strict=True):
        if time == time:
            at, closing = text_of(data, time, "s", ".8g"), text_of(data, speed, "m/s")
            print(f"impact at {at}, closing at {closing}")
    for i, state in enumerate(data.state.values):
        numbers = ", ".join(f"{value:.8g}" for value in state)
        print(f"state at phase 0 after {i} periods: {numbers} (x1, x2 in m, v1, v2 in m/s)")
    print(f"largest gap: {format_largest_gap(data)}")
