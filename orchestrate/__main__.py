"""Command line: ``python -m orchestrate COMMAND``; ``--help`` lists them."""

import argparse
import logging
import sys

from . import __version__
from .commands import build_command, sweep_command
from .errors import UserError

COMMANDS = (build_command, sweep_command)


def parser():
    """The command line's parser, one subparser a command."""
    top = argparse.ArgumentParser(
        prog="python -m orchestrate",
        description="Build the two-mass impact oscillator's FMUs and compute the paper's results through them.",
    )
    top.add_argument("--version", action="version", version=__version__)
    commands = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add_parser(commands)
    return top


def main(argv=None):
    """Run a command; returns the exit code: 0 success, 1 a failure, 2 a user's mistake, 130 interrupted."""
    logging.basicConfig(format="%(message)s")
    arguments = parser().parse_args(argv)
    try:
        return arguments.run(arguments) or 0
    except UserError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: nothing computed is lost, the same command goes on from here", file=sys.stderr)
        return 130
    except (RuntimeError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
