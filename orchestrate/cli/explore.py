"""Command ``explore``: write the interactive page and open it in the browser."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .grammar import parse_changes
from .options import Commands, add_structure_options, read_structure_options
from .output import add_units_option, read_units
from .question import read_earlier_result
from .start_file import print_difference, structure_of

if TYPE_CHECKING:
    import xarray as xr

EXAMPLES = """  {program} explore                              the paper's Figure 6
  {program} explore results/orbit_e0.7_D0.005_up.nc   an own sweep: a click replays its responses
  {program} explore --set e=0.3 --no-open --output page.html"""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``explore`` with its options."""
    text = "open a page that shows orbit diagrams and motions, computed in the browser"
    parser = commands.add("explore", run, text, EXAMPLES)
    sweep = "NetCDF file of a sweep along the frequency (default: the paper's Figure 6)"
    parser.add_argument("result", type=Path, nargs="?", metavar="RESULT", help=sweep)
    add_structure_options(parser, "RESULT or --branches")
    option = parser.add_argument_group("page").add_argument
    branches = "NetCDF file of branches over eta, drawn over the diagram"
    option("--branches", type=Path, metavar="FILE", help=branches)
    output_help = "the page (default: %(default)s)"
    option("--output", type=Path, default=Path("explorer.html"), metavar="FILE", help=output_help)
    add_units_option(parser)
    option("--no-open", action="store_true", help="only write it")
    folder = "where the compiled kernel is looked for and put"
    option("--build-folder", type=Path, metavar="FOLDER", help=folder)


def read_diagram(arguments: argparse.Namespace, branches: xr.Dataset | None) -> Any:
    """Return the sweep of RESULT, or else the structure: asked for, of ``--branches``, the paper's.

    A printed line says so if the branches are of another structure.
    """
    drawn = None if branches is None else structure_of("--branches", arguments.branches, branches)
    data: Any
    if arguments.result is not None:
        if arguments.set or arguments.structure:
            raise InputError(f"{arguments.result} with --structure or --set: expected one of them")
        data = read_earlier_result("RESULT", arguments.result)
        structure = structure_of("RESULT", arguments.result, data) if drawn else None
    elif drawn and not arguments.structure:
        data = structure = drawn.replace(**parse_changes(arguments.set))
    else:
        arguments.structure = arguments.structure or "paper"
        data = structure = read_structure_options(arguments)
    if drawn and structure:
        print_difference("--branches", arguments.branches, drawn, structure)
    return data


def run(arguments: argparse.Namespace) -> None:
    """Run ``explore``: write the explorer's HTML page and open it in the browser."""
    from ..explorer.page import explore

    branches = arguments.branches and read_earlier_result("--branches", arguments.branches)
    data = read_diagram(arguments, branches)
    page = explore(
        data,
        output=arguments.output,
        branches=branches,
        units=read_units(arguments),
        build_folder=arguments.build_folder,
    )
    print(f"{page}  {page.stat().st_size / 1024:.0f} kB")
    if not arguments.no_open:
        import webbrowser

        webbrowser.open(page.resolve().as_uri())
