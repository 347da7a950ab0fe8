"""Command line: ``python -m orchestrate COMMAND``; ``--help`` lists them."""

import sys

from .supervisor import supervised


def run() -> int:
    """Run the command line; return its exit code, also when Ctrl-C comes while modules are read."""
    try:
        from .cli import main as carry_out

        return carry_out()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def main() -> int:
    """Run the command in a process of its own, which ends in any case; return its exit code."""
    return supervised(run)


if __name__ == "__main__":
    sys.exit(main())
