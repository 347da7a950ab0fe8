"""Command ``paper``: compute all figures and claims of the paper and write a report."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .options import Commands
from .output import (
    add_running_options,
    add_units_option,
    check_output,
    read_running_options,
    refuse_units,
)

EXAMPLES = """\
  {program} paper                     all at the paper's resolution, into results/paper/
  {program} paper --quick             on fewer periods and points, in a minute or two
  {program} paper --figures 5,7       some of it
  {program} paper --cluster tcp://HOST:8786      on the workers of a running Dask scheduler
Interrupted, the same command goes on where it was. Finished data is left as it is."""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``paper`` with its options."""
    text = "the whole paper through the FMU: figures, claims, report"
    parser = commands.add("paper", run, text, EXAMPLES)
    option = parser.add_argument_group("question").add_argument
    option(
        "--figures",
        metavar="NAME,...",
        help="some of it: 5 to 12, claims, lyapunov, attractors, basin, maps, spectra (default: "
        "all)",
    )
    option(
        "--quick",
        action="store_true",
        help="reduced resolution: the same frequencies, fewer periods, starts and map points",
    )
    add_units_option(parser)
    add_running_options(
        parser, output=None, shown="results/paper, with --quick results/paper-quick"
    )


def run(arguments: argparse.Namespace) -> None:
    """Run ``paper``: compute its figures and numbers; print the claims; write the report."""
    refuse_units(arguments, "figures and numbers are those of the paper, ratios")
    from ..paper.reproduce import reproduce
    from ..paper.resolution import FULL, QUICK

    folder = Path("results") / ("paper-quick" if arguments.quick else "paper")
    output = arguments.output or folder
    check_output(output)
    figures = None if arguments.figures is None else arguments.figures.split(",")
    resolution = QUICK if arguments.quick else FULL
    outcome = reproduce(output, resolution, figures, read_running_options(arguments))
    print_verdicts(outcome.found)
    for picture in outcome.pictures.values():
        print(picture)
    print(outcome.report)


def print_verdicts(verdicts: Mapping[str, Any]) -> None:
    """Print each claim's verdict, and answers to further questions, a line each."""
    for row in verdicts["claims"]:
        text, printed = row["text"], row["printed"]
        verdict = f"{row['section']:4} {row['verdict']:7}"
        print(f"{verdict} {text}: paper {printed}, found {row['found']}")
    for row in verdicts["regions"]:
        shares = f"chaotic {row['chaotic']:5} neutral {row['neutral']:5}"
        where = f"{row['case']:18} {row['region']:13} {row['verdict']:16}"
        print(f"{where} {shares} largest {row['largest']}")
    for sentence in verdicts["answers"]:
        print(sentence)
