"""``build``: export the FMUs."""

from __future__ import annotations

import argparse
from pathlib import Path

from .options import Commands

EXAMPLES = """  {program} build
  {program} build --folder /tmp/fmus"""


def add_parser(commands: Commands) -> None:
    """Declare the command."""
    text = "export the FMUs, each form with the same variables and numbers"
    parser = commands.add("build", run, text, EXAMPLES)
    parser.add_argument(
        "--folder",
        type=Path,
        help="where to (default: build/ of a clone, else a cache folder of the user's)",
    )


def run(arguments: argparse.Namespace) -> None:
    """Carry it out."""
    from ..access import build

    for path in build(arguments.folder):
        print(f"{path}  {path.stat().st_size / 1024:.0f} kB")
