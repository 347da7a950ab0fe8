"""``python -m tools.benches tutorial``: write the records of the manual's tutorial."""

from __future__ import annotations

import argparse
import hashlib
from pathlib import Path

from . import tutorial


def main(arguments: list[str] | None = None) -> None:
    """Run the command line: ``tutorial`` writes the records of the manual's tutorial."""
    parser = argparse.ArgumentParser(prog="python -m tools.benches", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("tutorial", help="write the CSV files of the manual's tutorial")
    one.add_argument("--folder", type=Path, default=tutorial.FOLDER)
    for path in tutorial.write_records(parser.parse_args(arguments).folder):
        data = path.read_bytes()
        print(f"{path}: {len(data):,} bytes, sha256 {hashlib.sha256(data).hexdigest()[:16]}")


if __name__ == "__main__":
    main()
