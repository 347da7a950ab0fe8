"""Command line: ``python -m orchestrate COMMAND``; ``--help`` lists them."""

import sys

from .supervisor import supervised


def run() -> int:
    """Run the command line in this process; return its exit code, 130 after Ctrl-C."""
    try:
        from .cli import main as carry_out

        return carry_out()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def main() -> int:
    """Run the command line in a supervised child process; return its exit code in any case."""
    return supervised(run)


if __name__ == "__main__":
    sys.exit(main())
