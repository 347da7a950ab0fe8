"""Command line: ``python -m orchestrate COMMAND``; ``--help`` lists them."""

import sys

from .cli import main

if __name__ == "__main__":
    sys.exit(main())
