"""Print the table of step times of the manual's page: 100 million steps at 10 kHz, each timed."""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from orchestrate.fmu import OSCILLATOR, find_or_export
from orchestrate.model import Structure
from tests import importers

from .targets import HERE

# chattering into permanent contact each period, up to 0.4; flights of one and many impacts; chaos
FREQUENCIES = (0.1, 0.2, 0.3, 0.4, 0.6, 1.13, 2.0, 2.9)
SIZE = 1e-4  # s
RUNS = 3  # of the same steps: the least time of each counts
PARTS = {"median": 0.5, "99.9 %": 0.999, "99.999 %": 0.99999, "worst": 1.0}


def measure_steps(fmu: Path, eta: float, steps: int) -> tuple[Counter[int], list[int]]:
    """Time many steps of the paper's structure (omega = 75 rad/s) at one frequency.

    Returns how many steps took how many nanoseconds; and impacts and permanent contacts in all of
    them, and the most evaluations in one.
    """
    beam = Structure.from_file("beam")
    values = {**beam.parameters(), "box_frequency": eta * beam.omega}
    values["box_amplitude"] = 1e-3 / eta**2
    with tempfile.TemporaryDirectory() as folder:
        program = importers.compile_against(fmu, Path(folder), [HERE / "steps.c"], ("-O2",))
        library = importers.unpack_binary(fmu, "fmi3", Path(folder))
        importer = importers.Importer(program, library, "fmi3")
        order = (steps, SIZE, RUNS, *importers.settings(values))
        lines = [line.split() for line in importer.run(*order, timeout=3600.0).stdout.splitlines()]
    times = Counter({int(time): int(count) for time, count in lines[3:]})
    return times, [int(count) for _, count in (*lines[1:3], lines[0])]


def table_row(name: str, times: Counter[int], counts: list[int]) -> str:
    """Return a row of the manual's table: times, us, that a part of the steps does not exceed."""
    table = np.array(sorted(times.items()))
    seen = table[:, 1].cumsum()
    parts = [table[np.searchsorted(seen, part * seen[-1]), 0] / 1000 for part in PARTS.values()]
    cells = *(f"{part:.2f}" for part in parts), *(f"{count:,}" for count in counts)
    return f"| {' | '.join([name, f'{seen[-1]:,}', *cells])} |"


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
        print(table_row(str(eta), *rows[-1]), flush=True)
    histograms, counts = zip(*rows, strict=True)
    impacts, contacts, evaluations = zip(*counts, strict=True)
    totals = [sum(impacts), sum(contacts), max(evaluations)]
    print(table_row("all", sum(histograms, Counter()), totals))


if __name__ == "__main__":
    main()
