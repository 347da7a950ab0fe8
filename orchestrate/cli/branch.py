"""Command ``branch``: continue a periodic orbit along a parameter, through its bifurcations."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .grammar import plain_int
from .options import (
    CONTINUED,
    Commands,
    frequency_option,
    parse_varied,
    read_amplitude,
    read_excitation,
)
from .question import (
    answer_question,
    format_parameter,
    has_flag,
    parameter_parts,
    read_earlier_result,
)
from .start_file import keep_file_name, read_structure_and_question

if TYPE_CHECKING:
    import xarray as xr

    from ..structures import Structure

EXAMPLES = """\
  {program} branch --eta 2.5 --limits 2.4:2.8
  {program} branch --over e --eta 2.5 --limits 0.5:0.9
  {program} branch --structure beam --over hz --limits 20:30 --amplitude 1e-4
  {program} branch --start branch.nc --switch 1 --limits 2.4:2.9   the branch that leaves there
The excitation says where a first orbit is looked for; without it that is the lower limit."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``branch`` with its options."""
    text = "follow periodic motions along a parameter, stable and unstable, to their bifurcations"
    question = commands.add_response_command(
        "branch", run, text, EXAMPLES, several=False, from_file=True
    )
    option = question.group.add_argument
    over = f"what varies: {CONTINUED} (default: %(default)s)"
    option("--over", default="eta", metavar="NAME", help=over)
    option("--limits", metavar="FIRST:LAST", help="between which it is followed, in its own unit")
    start = "NetCDF file of an orbit or a branch to begin with"
    question.add("start", read_earlier_result, type=Path, metavar="FILE", help=start)
    switch = "number of a bifurcation of --start: the branch that leaves there"
    question.add("switch", type=plain_int, metavar="N", help=switch)
    question.declare("period", "box_acceleration", "longest", "most")


def run(arguments: argparse.Namespace) -> None:
    """Run ``branch``: trace a branch of periodic orbits; print its bifurcations; store, draw."""
    if arguments.limits is None:
        raise InputError("--limits: nothing given; expected FIRST:LAST")
    over, limits = parse_varied(arguments.over, arguments.limits)
    structure, keywords = read_structure_and_question(arguments)
    keywords = keep_file_name(keywords)
    excitation = excitation_arguments(arguments, structure, over, keywords["start"] is not None)
    question = {**excitation, "over": over, "limits": limits, **keywords}
    answer_question(arguments, structure, question, print_result, draw_result)


def excitation_arguments(
    arguments: argparse.Namespace, structure: Structure, over: str, begun: bool
) -> dict[str, Any]:
    """Return the excitation at which the first orbit is searched, as keywords for ``branch``."""
    name, amplitude = frequency_option(arguments), read_amplitude(arguments)
    if over == "frequency" and arguments.g is not None:
        raise InputError(
            "--g: a branch over the frequency has one amplitude; expected --amplitude in m "
            "(impacts and bifurcations do not depend on the level)"
        )
    if over == "frequency" and amplitude is None and not begun:
        raise InputError(f"--over {arguments.over}: expected --amplitude in m with it")
    if name is None and over in ("eta", "frequency") or begun and name is None:
        return {} if amplitude is None else {"amplitude": amplitude}
    excitation = read_excitation(arguments, structure, one=True)
    needed = "frequency" if over in ("frequency", "amplitude") else over
    if over in ("eta", "frequency", "amplitude") and needed not in excitation:
        expected = "--eta without an amplitude" if over == "eta" else "a frequency and --amplitude"
        raise InputError(f"--over {over}: expected {expected} with it")
    return excitation


def draw_result(data: xr.Dataset) -> Any:
    """Draw a branch over its parameter; return the figure."""
    from ..figures.lines import draw_branch

    return draw_branch(data)


def print_result(data: xr.Dataset) -> None:
    """Print a branch's bifurcations as a table, and why the branch ends."""
    from ..flags import flag_words

    name = str(data.attrs["over"])
    stable, undecided = int(data.stable.sum()), int(has_flag(data.stability, "undecided").sum())
    unsure = f", {undecided} undecided (the FMU has other impacts)" if undecided else ""
    print(f"{data.sizes['point']} orbits, {stable} of them stable{unsure}")
    low, high = float(data[name].min()), float(data[name].max())
    print(f"from {format_parameter(data, name, low)} to {format_parameter(data, name, high)}")
    count = data.sizes.get("bifurcation", 0)
    if not count:
        print("no bifurcation in this range")
    else:
        words = flag_words(data.bifurcation_kind.attrs)
        values = data.bifurcation_value.values.tolist()
        parts = [parameter_parts(data, name, value, ".8f") for value in values]
        before, _, unit = parts[0]
        heading = before or ("frequency" if name == "eta" else name)
        print(f"number  {'bifurcation':28}{heading}{f' ({unit})' if unit else ''}")
        for i, (_, number, _) in enumerate(parts):
            kind = words[int(data.bifurcation_kind[i])]
            print(f"{i:6}  {kind:28}{number}")
    print(f"first end: {data.attrs['first_end']}; last end: {data.attrs['last_end']}")
