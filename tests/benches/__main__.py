"""``python -m tests.benches``: records of the manual's tutorial, rates of verdicts by kind."""

from __future__ import annotations

import argparse
import hashlib
from pathlib import Path

from . import tutorial, verdicts


def main(arguments: list[str] | None = None) -> None:
    """Run the command line: ``tutorial`` writes records, ``verdicts`` prints a table of rates."""
    parser = argparse.ArgumentParser(prog="python -m tests.benches", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("tutorial", help="write the CSV files of the manual's tutorial")
    one.add_argument("--folder", type=Path, default=tutorial.FOLDER)
    two = commands.add_parser("verdicts", help="diagnose random beams and print their verdicts")
    two.add_argument("--kinds", nargs="+", choices=verdicts.GROUPS, default=list(verdicts.GROUPS))
    two.add_argument("--seed", type=int, default=0)
    two.add_argument("--count", type=int, default=1, help="beams of each kind")
    two.add_argument("--budget", type=float, default=600.0, help="processor time, s")
    chosen = parser.parse_args(arguments)
    if chosen.command == "verdicts":
        rates = chosen.kinds, chosen.seed, chosen.count, chosen.budget
        for line in verdicts.table_rows(*rates):
            print(line, flush=True)
        return
    for path in tutorial.write_records(chosen.folder):
        data = path.read_bytes()
        print(f"{path}: {len(data):,} bytes, sha256 {hashlib.sha256(data).hexdigest()[:16]}")


if __name__ == "__main__":
    main()
