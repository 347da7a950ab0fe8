"""How fast, as ratios: ``python -m tools.benchmark``.

Kernel, FMU calls and a sampled solver, measured one after the other in one run on one core; times
are of this machine, the ratios travel.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import time
from os import PathLike

from orchestrate.access import OSCILLATOR, Channel, Instance, find

from . import sampled_solver

ETAS = (0.3, 0.5, 0.8, 1.047, 1.13, 2.0, 2.9, 4.2, 6.3)
SETTLE = 50  # periods
COLUMNS = ("eta", "us/period", "ns/impact", "pure Python", "solve_ivp")


def periods(fmu: str | PathLike[str], eta: float, count: int) -> tuple[float, int]:
    """Seconds and impacts of ``count`` periods in one step, after some to settle."""
    period = 2.0 * math.pi / eta
    drive = {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
    with Instance(fmu) as instance:
        instance.initialize(**drive, x_rel_max_on=False)
        instance.step(0.0, SETTLE * period)
        before = instance.get("impact_count")[0]
        begin = time.perf_counter()
        instance.step(SETTLE * period, (SETTLE + count) * period)
        return time.perf_counter() - begin, instance.get("impact_count")[0] - before


def quiet_step(fmu: str | PathLike[str], count: int = 100_000) -> float:
    """Seconds a call of doStep where no impact falls, through FMPy."""
    with Instance(fmu) as instance:
        instance.initialize(bonded=True, x_rel_max_on=False)
        step = Channel(instance, (), ()).step
        begin = time.perf_counter()
        for i in range(count):
            step(i * 1e-3, 1e-3)
        return (time.perf_counter() - begin) / count


def pure_python(fmu: str | PathLike[str], eta: float, count: int) -> float:
    """Seconds of ``count`` periods in the Python kernel, in a process of its own."""
    environment = {**os.environ, "VIBROIMPACT_PURE_PYTHON": "1"}
    command = [sys.executable, "-m", "tools.benchmark", "--once", str(fmu), str(eta), str(count)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return float(done.stdout)


def compare(count: int) -> None:
    """Print the table."""
    native, python = find(OSCILLATOR).path, find(OSCILLATOR, "fmi2-python").path
    print("".join(f"{name:>12}" for name in COLUMNS), "  (the last two: times the native FMU)")
    seconds, impacts = 0.0, 0
    for eta in ETAS:
        taken, found = min(periods(native, eta, count) for _ in range(3))
        seconds, impacts = seconds + taken, impacts + found
        each = taken / count
        ratios = (
            pure_python(python, eta, 30) / 30 / each,
            sampled_solver.seconds(eta, 10) / 10 / each,
        )
        row = (eta, each * 1e6, taken / max(found, 1) * 1e9, *ratios)
        print("".join(f"{value:12.4g}" for value in row), flush=True)
    quiet = quiet_step(native) * 1e9
    print(f"all: {seconds / impacts * 1e9:.0f} ns an impact; a step without one: {quiet:.0f} ns")


def main() -> None:
    """Compare, or measure one thing in this process."""
    parser = argparse.ArgumentParser(prog="python -m tools.benchmark", description=__doc__)
    parser.add_argument("--periods", type=int, default=2000, help="periods a frequency")
    parser.add_argument("--once", nargs=3, metavar=("FMU", "ETA", "PERIODS"), help="seconds of one")
    arguments = parser.parse_args()
    if arguments.once:
        fmu, eta, count = arguments.once
        print(periods(fmu, float(eta), int(count))[0])
    else:
        compare(arguments.periods)


if __name__ == "__main__":
    main()
