"""``python -m orchestrate build``: export the FMUs."""

import argparse
from pathlib import Path


def add_parser(commands):
    """Declare the command."""
    text = "export the FMUs into a folder, each with the same variables and numbers"
    epilog = "examples:\n  python -m orchestrate build\n  python -m orchestrate build --folder /tmp/fmus"
    parser = commands.add_parser("build", help=text, description=text, epilog=epilog, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path("build"), help="where to (default: %(default)s)")
    parser.set_defaults(run=run)


def run(arguments):
    """Carry it out."""
    from ..build import build

    for path in build(arguments.folder):
        print(f"{path}  {path.stat().st_size / 1024:.0f} kB")
