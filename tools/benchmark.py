"""Measure the FMU's speed beside other solvers and versions: ``python -m tools.benchmark``.

Kernel, FMU calls and a sampled solver, measured one after the other in one run on one core; times
are of this machine, the ratios travel. With ``--before FMU``, another version's native FMI 3.0 FMU,
both are measured in turn.
"""

from __future__ import annotations

import argparse
import math
import operator
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from os import PathLike
from pathlib import Path

import numpy as np

from orchestrate.constants import TURN
from orchestrate.fmu import OSCILLATOR, Channel, Instance, find
from orchestrate.model import Structure
from orchestrate.response.resonance import resonance

from . import c_host, sampled_solver

PAPER = Structure.nondimensional(e=0.7, D=0.005, kappa=1.2)
ETAS = (0.3, 0.5, 0.8, 1.047, 1.13, 2.0, 2.9, 4.2, 6.3)
SETTLE = 50  # periods
COLUMNS = ("eta", "us/period", "ns/impact", "pure Python", "solve_ivp")


def harmonic_acceleration(eta: float, time: float) -> float:
    """Return the acceleration at a time of the paper's box, of amplitude 1/eta^2 m."""
    return -math.sin(eta * time)


def time_periods(fmu: str | PathLike[str], eta: float, count: int) -> tuple[float, int]:
    """Return the seconds and impacts of ``count`` periods in one step, after some to settle."""
    period = 2.0 * math.pi / eta
    drive = {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
    with Instance(fmu) as instance:
        instance.initialize(**drive, x_rel_max_on=False)
        instance.step(0.0, SETTLE * period)
        before = instance.get("impact_count")[0]
        begin = time.perf_counter()
        instance.step(SETTLE * period, (SETTLE + count) * period)
        return time.perf_counter() - begin, instance.get("impact_count")[0] - before


def time_quiet_step(fmu: str | PathLike[str], count: int = 100_000) -> float:
    """Return the seconds of one doStep call without an impact, through FMPy."""
    with Instance(fmu) as instance:
        instance.initialize(bonded=True, x_rel_max_on=False)
        step = Channel(instance, (), ()).step
        begin = time.perf_counter()
        for i in range(count):
            step(i * 1e-3, 1e-3)
        return (time.perf_counter() - begin) / count


def time_pure_python(fmu: str | PathLike[str], eta: float, count: int) -> float:
    """Return the seconds of ``count`` periods in the Python kernel, in its own process."""
    environment = {**os.environ, "VIBROIMPACT_PURE_PYTHON": "1"}
    command = [sys.executable, "-m", "tools.benchmark", "--once", str(fmu), str(eta), str(count)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return float(done.stdout)


def time_figure_6(
    fmu: str | PathLike[str], watched: bool = False, step: float = 0.02
) -> tuple[float, int]:
    """Compute a part of Figure 6, the gap watched or not; return its seconds and impacts."""
    seconds, impacts = 0.0, 0
    state = dict.fromkeys(("x1_start", "x2_start", "v1_start", "v2_start"), 0.0)
    with Instance(fmu) as instance:
        for eta in np.arange(0.1, 8.0, step):
            period = 2.0 * math.pi / eta
            instance.reset()
            drive = {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
            instance.initialize(**state, **drive, x_rel_max_on=watched)
            begin = time.process_time()
            instance.step(0.0, 500 * period)
            seconds += time.process_time() - begin
            instance.set(x_rel_max_on=True)
            begin = time.process_time()
            instance.step(500 * period, 700 * period)
            seconds += time.process_time() - begin
            impacts += instance.get("impact_count")[0]
            state = dict(zip(state, instance.get("x1", "x2", "v1", "v2"), strict=True))
    return seconds, impacts


def time_resonance(fmu: str | PathLike[str], count: int = 500) -> tuple[float, float]:
    """Return the seconds of resonance curves, and of the FMU alone for as many periods."""
    etas = np.linspace(0.9, 1.5, count)
    begin = time.process_time()
    resonance(PAPER, eta=etas, transient=500, samples=60, progress=False, jobs=1, fmu=fmu)
    asked, alone = time.process_time() - begin, 0.0
    with Instance(fmu) as instance:
        for bonded in (True, False):
            for eta in (*etas, *etas[::-1]):
                instance.reset()
                drive = {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
                instance.initialize(**drive, bonded=bonded, x_rel_max_on=False)
                begin = time.process_time()
                instance.step(0.0, 560 * TURN / eta)
                alone += time.process_time() - begin
    return asked, alone


def fastest_of_each(
    measure: Callable[[Path], float], fmus: Sequence[Path], rounds: int
) -> list[float]:
    """Return the shortest of several measurements of each FMU, taken in turn."""
    return [
        min(row) for row in zip(*([measure(f) for f in fmus] for _ in range(rounds)), strict=True)
    ]


def compare_versions(before: Path, rounds: int = 5) -> None:
    """Print times in ns of this version and another one by measure, and their ratio."""
    fmus = (find(OSCILLATOR).path, before)
    measures: dict[str, Callable[[Path], float]] = {
        "Figure 6, an impact": lambda fmu: operator.truediv(*time_figure_6(fmu)),
        "Figure 6, largest gap watched all along": lambda fmu: operator.truediv(
            *time_figure_6(fmu, True)
        ),
        "a step without impact, from C": c_host.time_quiet_step,
        "the same, largest gap watched": lambda fmu: c_host.time_quiet_step(fmu, watched=True),
    }
    for name, measure in measures.items():
        now, then = (seconds * 1e9 for seconds in fastest_of_each(measure, fmus, rounds))
        print(f"{name:40}{now:8.1f} ns{then:8.1f} ns before{now / then:8.3f}", flush=True)


def compare_solvers(count: int) -> None:
    """Print times per period and impact over eta, and how much slower other solvers are."""
    native, python = find(OSCILLATOR).path, find(OSCILLATOR, "fmi2-python").path
    print("".join(f"{name:>12}" for name in COLUMNS), "  (the last two: times the native FMU)")
    seconds, impacts = 0.0, 0
    for eta in ETAS:
        taken, count_of_impacts = min(time_periods(native, eta, count) for _ in range(3))
        seconds, impacts = seconds + taken, impacts + count_of_impacts
        each = taken / count
        ratios = (
            time_pure_python(python, eta, 30) / 30 / each,
            sampled_solver.simulate_from_rest(
                PAPER, partial(harmonic_acceleration, eta), 10 * TURN / eta
            )[0]
            / 10
            / each,
        )
        row = (eta, each * 1e6, taken / max(count_of_impacts, 1) * 1e9, *ratios)
        print("".join(f"{value:12.4g}" for value in row), flush=True)
    quiet = time_quiet_step(native) * 1e9
    print(f"all: {seconds / impacts * 1e9:.0f} ns an impact; a step without one: {quiet:.0f} ns")
    asked, alone = time_resonance(native)
    print(f"resonance at 500 frequencies: {asked:.2f} s, {asked / alone:.2f} times the FMU's steps")


def main() -> None:
    """Run a comparison, or one measurement in this process, as the options say."""
    parser = argparse.ArgumentParser(prog="python -m tools.benchmark", description=__doc__)
    parser.add_argument("--periods", type=int, default=2000, help="periods a frequency")
    parser.add_argument("--once", nargs=3, metavar=("FMU", "ETA", "PERIODS"), help="seconds of one")
    parser.add_argument("--before", type=Path, metavar="FMU", help="another version's FMI 3.0 FMU")
    arguments = parser.parse_args()
    if arguments.before:
        compare_versions(arguments.before)
    elif arguments.once:
        fmu, eta, count = arguments.once
        print(time_periods(fmu, float(eta), int(count))[0])
    else:
        compare_solvers(arguments.periods)


if __name__ == "__main__":
    main()
