"""Command line: ``python -m orchestrate COMMAND``; ``--help`` lists them."""

import sys

from .supervisor import supervised


def run() -> int:
    """The command's exit code; Ctrl-C may come while its modules are still read."""
    try:
        from .cli import main as carry_out

        return carry_out()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


def main() -> int:
    """The command in a process of its own, which ends whatever happens in it."""
    return supervised(run)


if __name__ == "__main__":
    sys.exit(main())
