"""Command ``report``: put stored results on one HTML page to read, print and sign."""

from __future__ import annotations

import argparse
from pathlib import Path

from .options import Commands
from .output import add_units_option, check_output, read_units
from .question import read_earlier_result

EXAMPLES = """  {program} report results/sweep.nc --title Beam --notes November
  {program} report results/map.nc results/resonance.nc --output study"""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``report`` with its options."""
    text = "stored results as one page with pictures and numbers, to read, print and sign"
    parser = commands.add("report", run, text, EXAMPLES)
    files = "results of earlier commands; a verdict of diagnose comes first"
    parser.add_argument("results", type=Path, nargs="+", metavar="FILE.nc", help=files)
    option = parser.add_argument_group("page").add_argument
    option("--title", default="", metavar="WORDS", help="by default that of the first result")
    option("--notes", default="", metavar="WORDS", help="below the title: what, who, when")
    add_units_option(parser)
    folder_help = "folder of the page (default: results)"
    option("--output", type=Path, default=Path("results"), metavar="FOLDER", help=folder_help)


def run(arguments: argparse.Namespace) -> None:
    """Run ``report``: write stored results as one HTML page; print its path."""
    import orchestrate

    from ..files import open_folder

    check_output(arguments.output)
    answers = [read_earlier_result("FILE", path) for path in arguments.results]
    page = open_folder(arguments.output) / f"report_{arguments.results[0].stem}.html"
    words = {"title": arguments.title, "notes": arguments.notes}
    print(orchestrate.report(*answers, output=page, **words, units=read_units(arguments)))
