"""Command line: ``python -m orchestrate COMMAND``; ``--help`` lists them."""

import argparse
import logging
import re
import sys

from . import __version__
from .commands import build_command, couple_command, paper_command, spectra_command, sweep_command
from .errors import UserError

COMMANDS = (build_command, sweep_command, paper_command, couple_command, spectra_command)


def parser():
    """The command line's parser, one subparser a command."""
    top = argparse.ArgumentParser(
        prog="python -m orchestrate",
        description="Build the two-mass impact oscillator's FMUs and compute the paper's results through them.",
        epilog="examples:\n  python -m orchestrate build\n  python -m orchestrate sweep\n  python -m orchestrate sweep --help",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=__version__)
    commands = top.add_subparsers(title="commands", required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add_parser(commands)
    return top


def with_negative_values(argv):
    """``--eta -1:2:0.5`` as ``--eta=-1:2:0.5``, or argparse takes the value for an option and cannot say what is wrong with it."""
    joined: list = []
    for text in argv:
        if joined and joined[-1].startswith("--") and "=" not in joined[-1] and re.match(r"-[\d.]", text):
            joined[-1] += f"={text}"
        else:
            joined.append(text)
    return joined


def main(argv=None):
    """Run a command; returns the exit code: 0 success, 1 a failure, 2 a user's mistake, 130 interrupted."""
    logging.basicConfig(format="%(message)s")
    arguments = parser().parse_args(with_negative_values(sys.argv[1:] if argv is None else argv))
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
