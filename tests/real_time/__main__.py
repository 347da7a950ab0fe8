"""Print the table of step times of the manual's page: 100 million steps at 10 kHz, each timed."""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from dataclasses import dataclass
from functools import reduce
from operator import add
from pathlib import Path

from orchestrate.fmu import OSCILLATOR, find_or_export
from orchestrate.model import Structure
from tests import importers

from .targets import HERE

# chattering into permanent contact each period, up to 0.4; flights of one and many impacts; chaos
FREQUENCIES = (0.1, 0.2, 0.3, 0.4, 0.6, 1.13, 2.0, 2.9)
SIZE = 1e-4  # s
RUNS = 3  # of the same steps: the least time of each counts
PARTS = {"median": 0.5, "99.9 %": 0.999, "99.999 %": 0.99999, "worst": 1.0}


@dataclass(frozen=True)
class StepTimes:
    """Histogram of the times of communication steps."""

    histogram: Counter[int]  # steps by nanoseconds
    # most evaluations in a step; impacts and permanent contacts in all of them
    evaluations: int
    impacts: int
    contacts: int

    def __add__(self, other: StepTimes) -> StepTimes:
        most = max(self.evaluations, other.evaluations)
        counts = self.impacts + other.impacts, self.contacts + other.contacts
        return StepTimes(self.histogram + other.histogram, most, *counts)

    def quantile(self, part: float) -> int:
        """Return the time, ns, that a part of the steps does not exceed."""
        wanted, seen = part * self.histogram.total(), 0
        for time, count in sorted(self.histogram.items()):
            seen += count
            if seen >= wanted:
                return time
        raise ValueError("expected steps")


def measure_steps(fmu: Path, eta: float, steps: int) -> StepTimes:
    """Time many steps of the paper's structure (omega = 75 rad/s) at one frequency."""
    beam = Structure.from_file("beam")
    values = {**beam.parameters(), "box_frequency": eta * beam.omega}
    values["box_amplitude"] = 1e-3 / eta**2
    with tempfile.TemporaryDirectory() as folder:
        program = importers.compile_against(fmu, Path(folder), [HERE / "steps.c"], ("-O2",))
        library = importers.unpack_binary(fmu, "fmi3", Path(folder))
        importer = importers.Importer(program, library, "fmi3")
        order = (steps, SIZE, RUNS, *importers.settings(values))
        text = importer.run(*order, timeout=3600.0).stdout
    lines = [line.split() for line in text.splitlines()]
    evaluations, impacts, contacts = (int(count) for _, count in lines[:3])
    times = Counter({int(time): int(count) for time, count in lines[3:]})
    return StepTimes(times, evaluations, impacts, contacts)


def table_row(name: str, times: StepTimes) -> str:
    """Return a row of the manual's table, times in microseconds."""
    parts = [f"{times.quantile(part) / 1000.0:.2f}" for part in PARTS.values()]
    counts = [f"{n:,}" for n in (times.impacts, times.contacts, times.evaluations)]
    return f"| {' | '.join([name, f'{times.histogram.total():,}', *parts, *counts])} |"


def main() -> None:
    """Run communication steps and print a table of their times, us."""
    parser = argparse.ArgumentParser(prog="python -m tests.real_time", description=__doc__)
    parser.add_argument("--steps", type=int, default=100_000_000, help="to be timed (default 1e8)")
    steps, fmu = parser.parse_args().steps, Path(find_or_export(OSCILLATOR).path)
    columns = ["eta", "steps", *PARTS, "impacts", "contacts", "most evaluations"]
    print(f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    rows = []
    for eta in FREQUENCIES:
        rows.append(measure_steps(fmu, eta, steps // len(FREQUENCIES)))
        print(table_row(str(eta), rows[-1]), flush=True)
    print(table_row("all", reduce(add, rows)))


if __name__ == "__main__":
    main()
