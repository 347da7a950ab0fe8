"""``python -m orchestrate build``: export the FMUs."""

from pathlib import Path


def add_parser(commands):
    """Declare the command."""
    text = "export the FMUs into a folder, each with the same variables and numbers"
    parser = commands.add_parser("build", help=text, description=text)
    parser.add_argument("--folder", type=Path, default=Path("build"), help="where to (default: %(default)s)")
    parser.set_defaults(run=run)


def run(arguments):
    """Carry it out."""
    from ..build import build

    for path in build(arguments.folder):
        print(f"{path}  {path.stat().st_size / 1024:.0f} kB")
