"""Command ``build``: export the FMUs."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..errors import InputError
from .options import Commands
from .output import add_units_option, check_output, refuse_units

EXAMPLES = """  {program} build
  {program} build --folder /tmp/fmus
  {program} build --platforms all
  {program} build --plain
  {program} build --sources-only"""


def add_parser(commands: Commands) -> None:
    """Add the parser of the command ``build`` with its options."""
    text = (
        "export the FMUs, each form with the same variables and numbers, and compile the master "
        "and the explorer's kernels"
    )
    parser = commands.add("build", run, text, EXAMPLES)
    parser.add_argument(
        "--folder",
        type=Path,
        help="where to (default: build/ of a clone, else a cache folder of the user's)",
    )
    parser.add_argument(
        "--platforms",
        default="",
        metavar="LIST",
        help="binaries in the native FMUs: all, this, or names such as aarch64-linux,x86_64-darwin "
        "(default: Linux and Windows on x86-64, and this machine)",
    )
    parser.add_argument(
        "--plain",
        action="store_true",
        help="instead, into fmi2-plain/ and fmi3-plain/: native FMUs for tools that stumble over "
        "arrays, clocks or long lists of variables; the same numbers",
    )
    parser.add_argument(
        "--sources-only",
        action="store_true",
        help="instead, into fmi2-sources/ and fmi3-sources/ (with --plain: fmi2-plain-sources/, "
        "fmi3-plain-sources/): native FMUs without binaries, for targets that compile the C "
        "sources inside; no compiler is needed here",
    )
    add_units_option(parser)


def run(arguments: argparse.Namespace) -> None:
    """Run ``build``: export the FMUs of the chosen models and forms; print their paths."""
    refuse_units(arguments, "FMUs are in SI")
    from ..access import (
        FORMS,
        PLAIN_FORMS,
        build,
        build_libraries,
        build_web_kernels,
        sources_of,
    )

    if arguments.folder is not None:
        check_output(arguments.folder, "--folder")
    forms = PLAIN_FORMS if arguments.plain else FORMS
    platforms = [name for name in arguments.platforms.split(",") if name]
    if arguments.sources_only:
        if platforms:
            raise InputError("--platforms with --sources-only: expected one of them")
        forms = sources_of(forms)
    made = build(arguments.folder, forms, platforms=platforms)
    if not (arguments.plain or arguments.sources_only):
        made += build_libraries(arguments.folder, platforms)
        made += build_web_kernels(arguments.folder)
    for path in made:
        print(f"{path}  {path.stat().st_size / 1024:.0f} kB")
