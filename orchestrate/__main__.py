"""Command line: ``python -m orchestrate COMMAND``; ``--help`` lists them."""

import sys


def run() -> int:
    """The command's exit code; Ctrl-C may come while its modules are still read."""
    try:
        from .cli import main

        return main()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(run())
