"""Print the results of the manual's page on real-time targets."""

from __future__ import annotations

import argparse
import tempfile
from functools import reduce
from operator import add
from pathlib import Path

from orchestrate.fmu import OSCILLATOR, find

from .footprint import MACHINES, stack_table
from .sources import compiler_version, missing_programs, unpack
from .step_times import FREQUENCIES, PARTS, measure_steps, table_row
from .targets import run_on_all_targets


def print_stack(sources: Path) -> None:
    """Print a table of the stack bytes of each kind of call."""
    if missing_programs(*(compiler for compiler, *_ in MACHINES.values())):
        return
    for machine, calls in stack_table(sources, "-O2").items():
        compiler = compiler_version(MACHINES[machine][0])
        print(f"stack, {machine} ({compiler}): {', '.join(f'{k} {v}' for k, v in calls.items())}")


def print_times(fmu: Path, steps: int) -> None:
    """Run communication steps and print a table of their times, us."""
    columns = ["eta", "steps", *PARTS, "impacts", "contacts", "most evaluations"]
    print(f"| {' | '.join(columns)} |")
    print(f"|{'---|' * len(columns)}")
    rows = []
    for eta in FREQUENCIES:
        rows.append(measure_steps(fmu, eta, steps // len(FREQUENCIES)))
        print(table_row(str(eta), rows[-1]), flush=True)
    print(table_row("all", reduce(add, rows)))


def main() -> None:
    """Run the measurements on real-time targets that the options name."""
    parser = argparse.ArgumentParser(prog="python -m tests.real_time", description=__doc__)
    parser.add_argument("--steps", type=int, default=100_000_000, help="to be timed (default 1e8)")
    arguments = parser.parse_args()
    fmu = Path(find(OSCILLATOR).path)
    with tempfile.TemporaryDirectory() as folder:
        sources = unpack(fmu, Path(folder))
        for name, result in run_on_all_targets(sources, Path(folder)).items():
            print(f"{name}: " + ", ".join(f"{key} {value}" for key, value in result.items()))
        print_stack(sources)
    print_times(fmu, arguments.steps)


if __name__ == "__main__":
    main()
