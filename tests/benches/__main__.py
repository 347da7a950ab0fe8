"""``python -m tests.benches``: records of the manual's tutorial, rates of verdicts."""

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
    two = commands.add_parser("verdicts", help="judge random beams and print rates of verdicts")
    two.add_argument("--kinds", nargs="+", choices=verdicts.MAKERS, default=list(verdicts.MAKERS))
    two.add_argument("--seed", type=int, default=0)
    two.add_argument("--count", type=int, default=1, help="beams of each kind, twice if split")
    two.add_argument("--budget", type=float, default=600.0, help="processor time, s")
    two.add_argument("--out", type=Path, required=True, help="a line for each beam, which resumes")
    chosen = parser.parse_args(arguments)
    if chosen.command == "verdicts":
        chosen.out.touch()
        beams = chosen.kinds, chosen.seed, chosen.count, chosen.budget, chosen.out
        print(*verdicts.table_rows(verdicts.judged_beams(*beams)), sep="\n")
        return
    for path in tutorial.write_records(chosen.folder):
        data = path.read_bytes()
        print(f"{path}: {len(data):,} bytes, sha256 {hashlib.sha256(data).hexdigest()[:16]}")


if __name__ == "__main__":
    main()
