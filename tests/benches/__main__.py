"""``python -m tests.benches``: records of the manual's tutorial; rates of verdicts and fits."""

from __future__ import annotations

import argparse
import hashlib
from pathlib import Path

from . import intervals, plans, tutorial, verdicts
from .lines import judged_cases
from .recipe import SPLIT

RATES = {  # command: what judges a case, kinds of cases, what makes a table, what it is
    "verdicts": (
        verdicts.judged_beam,
        tuple(verdicts.MAKERS),
        verdicts.table_rows,
        "judge random beams and print rates of verdicts",
    ),
    "plans": (plans.judged_plan, SPLIT, verdicts.table_rows, "plan tests, and follow them"),
    "intervals": (intervals.judged_fit, SPLIT, intervals.table_rows, "fit random delaminations"),
}


def main(arguments: list[str] | None = None) -> None:
    """Run the command line: ``tutorial`` writes records, others print tables of rates."""
    parser = argparse.ArgumentParser(prog="python -m tests.benches", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("tutorial", help="write the CSV files of the manual's tutorial")
    one.add_argument("--folder", type=Path, default=tutorial.FOLDER)
    for name, (_, kinds, _, text) in RATES.items():
        two = commands.add_parser(name, help=text)
        two.add_argument("--kinds", nargs="+", choices=kinds, default=list(kinds))
        two.add_argument("--seed", type=int, default=0)
        two.add_argument("--count", type=int, default=1, help="of each kind; twice of split beams")
        two.add_argument("--budget", type=float, default=600.0, help="processor time, s")
        two.add_argument("--out", type=Path, required=True, help="a line for each, which resumes")
    chosen = parser.parse_args(arguments)
    if chosen.command in RATES:
        judge, _, rows, _ = RATES[chosen.command]
        cases = verdicts.cases(chosen.kinds, chosen.count)
        print(*rows(judged_cases(judge, cases, chosen.seed, chosen.budget, chosen.out)), sep="\n")
        return
    for path in tutorial.write_records(chosen.folder):
        data = path.read_bytes()
        print(f"{path}: {len(data):,} bytes, sha256 {hashlib.sha256(data).hexdigest()[:16]}")


if __name__ == "__main__":
    main()
