"""Entry point of ``python -m orchestrate COMMAND``; ``--help`` lists the commands."""

import sys

from .supervisor import run_supervised


def run() -> int:
    """Run the command line in this process; return its exit code, 130 after Ctrl-C."""
    try:
        from .cli import main as run_command_line

        return run_command_line()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def main() -> int:
    """Run the command line in a supervised child process; return its exit code in any case."""
    return run_supervised(run)


if __name__ == "__main__":
    sys.exit(main())
