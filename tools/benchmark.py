"""Compare the FMU's speed with other solvers and versions: ``python -m tools.benchmark``.

Kernel, FMU calls and a sampled solver, measured one after the other in one run on one core; times
are of this machine, the ratios travel. With ``--before CHECKOUT``, another version's clone with its
FMUs built, both are asked the same questions in turn; ``--scale 0.1`` asks for a tenth of each. A
question that one of them cannot answer is left out, with the reason.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from os import PathLike
from pathlib import Path

import numpy as np

from orchestrate.constants import TURN
from orchestrate.fmu import OSCILLATOR, Instance, find_or_export
from orchestrate.model import Structure
from orchestrate.response.resonance import resonance
from tests import importers

from . import sampled_solver

PAPER = Structure.nondimensional(e=0.7, D=0.005, kappa=1.2)
ETAS = (0.3, 0.5, 0.8, 1.047, 1.13, 2.0, 2.9, 4.2, 6.3)
COLUMNS = ("eta", "us/period", "ns/impact", "pure Python", "solve_ivp")
SETTLE = 50  # periods
CHATTERING = (0.2, 0.25, 0.3)
QUESTION = """
import resource, subprocess, sys, tempfile, time
import numpy as np
import orchestrate as o
structure, quiet = o.Structure.nondimensional(), {{"progress": False, "jobs": 1}}
motor = o.Structure.from_file("quick"), o.Drive.from_file("quick")
halves = dict(m1=1.5, m2=1.2, f1=42.0, f2=48.0, zeta1=0.007, zeta2=0.007)
etas = lambda first, last, count: np.linspace(first, last, count)
o.simulate(structure, eta=0.8, periods=1)
used = lambda whose: sum(resource.getrusage(whose)[:2])
now = lambda: (used(resource.RUSAGE_SELF) + used(resource.RUSAGE_CHILDREN), time.perf_counter())
begin = now()
{question}
print(*np.subtract(now(), begin))
"""
SIZES = {"sweep": 7901, "side": 87, "starts": 100, "values": 50, "exponents": 100, "runs": 100}
QUESTIONS = {  # the sizes are scaled
    "Figure 6": "o.sweep(structure, eta=etas(0.1, 8.0, {sweep}), **quiet)",
    "Figure 6, jobs=2": "o.sweep(structure, eta=etas(0.1, 8.0, {sweep}), progress=False, jobs=2)",
    "map of 87 x 87 points": "o.map(structure, eta=etas(0.3, 3.0, {side}), "
    "e=etas(0.3, 0.9, {side}), **quiet)",
    "basin of 100 x 100 starts": "o.basin(structure, eta=1.315, x=('x_rel', 0, 1.3, {starts}), "
    "y=('v_rel', -1.3, 1.3, {starts}), **quiet)",
    "attractors, 50 x 60 starts": "o.attractors(structure, eta=etas(0.9, 2.4, {values}), **quiet)",
    "100 exponents": "o.lyapunov(structure, eta=etas(0.3, 3.0, {exponents}), **quiet)",
    "command sweep, two cores": "subprocess.run([sys.executable, '-m', 'orchestrate', 'sweep', "
    "'--eta', f'0.1:8:{{7.9 / {sweep}:.6f}}', '--output', tempfile.mkdtemp()], check=True, "
    "stdout=subprocess.DEVNULL)",
    "simulate, 100 times": "[o.simulate(structure, eta=eta) for eta in etas(0.3, 3.0, {runs})]",
    "orbit, 100 values": "[o.orbit(structure, eta=eta, **quiet) for eta in etas(1.0, 1.1, {runs})]",
    "a minute of vibration at 20 kHz": "o.shake(o.Structure.from_halves(**halves), "
    "o.Random(psd=((20.0, 0.5), (200.0, 0.5)), duration=0.6 * {runs}, seed=1), "
    "sample_rate=2e4, **quiet)",
    "couple, 4000 s": "o.couple(*motor, voltage=1.5, duration=40.0 * {runs}, **quiet)",
    "drive_branch of 200 points": "o.drive_branch(*motor, most=2 * {runs}, **quiet)",
    "jump_voltages of 1.3 to 1.8 V": "o.jump_voltages(*motor, "
    "voltage=(1.8 - 0.005 * {runs}, 1.8), **quiet)",
}


class QuestionFailed(Exception):
    """A question that a checkout does not know, with the reason."""


def box(eta: float) -> dict[str, float]:
    return {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}


def time_periods_and_count_impacts(
    fmu: str | PathLike[str], eta: float, count: int
) -> tuple[float, int]:
    """Return the seconds and impacts of ``count`` periods in one step, after some to settle."""
    period = TURN / eta
    with Instance(fmu) as instance:
        instance.initialize(**box(eta), x_rel_max_on=False)
        instance.step(0.0, SETTLE * period)
        before = instance.get("impact_count")[0]
        begin = time.perf_counter()
        instance.step(SETTLE * period, (SETTLE + count) * period)
        return time.perf_counter() - begin, instance.get("impact_count")[0] - before


def time_quiet_step(fmu: str | PathLike[str], count: int = 100_000) -> float:
    with Instance(fmu) as instance:
        instance.initialize(bonded=True, x_rel_max_on=False)
        begin = time.perf_counter()
        for i in range(count):
            instance.step(i * 1e-3, (i + 1) * 1e-3)
        return (time.perf_counter() - begin) / count


def time_quiet_step_from_c(fmu: Path) -> float:
    """Return the seconds of a step without impact, called from a compiled C program."""
    apart = {"x1_start": -1.0, "x2_start": 1e4, "box_amplitude": 1.0, "box_frequency": 0.4}
    settings = importers.settings({**apart, "x_rel_max_on": 0.0})
    with tempfile.TemporaryDirectory() as folder:
        source = Path(__file__).with_name("c_host.c")
        program = importers.compile_against(fmu, Path(folder), [source], ("-O2",))
        library = importers.unpack_binary(fmu, "fmi3", Path(folder))
        done = importers.Importer(program, library, "fmi3").run(1e-3, *settings)
    return float(done.stdout) * 1e-9


def time_periods_in_pure_python(fmu: str | PathLike[str], eta: float, count: int) -> float:
    """Return the seconds of ``count`` periods in the Python kernel, in its own process."""
    environment = {**os.environ, "VIBROIMPACT_PURE_PYTHON": "1"}
    command = [sys.executable, "-m", "tools.benchmark", "--once", str(fmu), str(eta), str(count)]
    return float(subprocess.check_output(command, env=environment, text=True))


def time_impact(fmu: str | PathLike[str], etas: Sequence[float], count: int) -> float:
    """Return the processor seconds of an impact in steps of many periods, the gap not watched."""
    seconds, impacts = 0.0, 0
    with Instance(fmu) as instance:
        for eta in etas:
            instance.reset()
            instance.initialize(**box(eta), x_rel_max_on=False)
            begin = time.process_time()
            instance.step(0.0, count * TURN / eta)
            seconds += time.process_time() - begin
            impacts += instance.get("impact_count")[0]
    return seconds / impacts


def time_resonance(fmu: str | PathLike[str], count: int = 500) -> tuple[float, float]:
    """Return the seconds of resonance curves, and of the FMU by itself for as many periods."""
    etas = np.linspace(0.9, 1.5, count)
    begin = time.process_time()
    resonance(PAPER, eta=etas, transient=500, samples=60, progress=False, jobs=1, fmu=fmu)
    asked, alone = time.process_time() - begin, 0.0
    with Instance(fmu) as instance:
        for bonded in (True, False):
            for eta in (*etas, *etas[::-1]):
                instance.reset()
                instance.initialize(**box(eta), bonded=bonded, x_rel_max_on=False)
                begin = time.process_time()
                instance.step(0.0, 560 * TURN / eta)
                alone += time.process_time() - begin
    return asked, alone


def time_question(checkout: Path, question: str) -> tuple[float, float]:
    """Return processor and elapsed seconds of a line of Python in a checkout, in its own process.

    The processor time is that of the process and its children, imports of the package left out;
    elapsed time counts where worker processes live on, whose processor time is not seen.
    """
    code = QUESTION.format(repository=str(checkout), question=question)
    command = [sys.executable, "-W", "ignore", "-c", code]
    done = subprocess.run(command, cwd=checkout, capture_output=True, text=True)
    if done.returncode:
        line = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise QuestionFailed(f"left out: {checkout} cannot answer it ({line})")
    busy, elapsed = done.stdout.splitlines()[-1].split()
    return float(busy), float(elapsed)


def print_comparison_of_versions(before: Path, scale: float, rounds: int, only: str) -> None:
    """Print times of this version and of another checkout, measured in turn, and their ratios."""
    checkouts = Path(__file__).parents[1], before
    fmus = [path / "build" / "fmi3" / f"{OSCILLATOR}.fmu" for path in checkouts]
    sizes = {name: max(4, round(size * scale)) for name, size in SIZES.items()}
    periods = max(10, round(4000 * scale))
    measures: dict[str, Callable[[int], tuple[float, ...]]] = {
        name: partial(lambda text, i: time_question(checkouts[i], text), text.format(**sizes))
        for name, text in QUESTIONS.items()
    }
    measures["an impact while chattering"] = lambda i: (time_impact(fmus[i], CHATTERING, periods),)
    measures["an impact elsewhere"] = lambda i: (time_impact(fmus[i], ETAS[3:], 4 * periods),)
    measures["a step without impact, from C"] = lambda i: (time_quiet_step_from_c(fmus[i]),)
    print(f"{'':32}{'processor: now':>16}{'before':>12}{'ratio':>8}{'elapsed: ratio':>16}")
    for name, measure in measures.items():
        if only not in name:
            continue
        try:
            times = np.array([[measure(0), measure(1)] for _ in range(rounds)]).min(axis=0)
        except QuestionFailed as reason:
            print(f"{name:36}{reason}", flush=True)
            continue
        ratios = times[0] / times[1]
        unit, factor = ("s", 1.0) if times[1, 0] > 1e-3 else ("ns", 1e9)
        text = "".join(f"{value * factor:9.3f} {unit:2}" for value in times[:, 0])
        print(f"{name:36}{text}{ratios[0]:8.3f}", *(f"{r:15.3f}" for r in ratios[1:]), flush=True)


def print_comparison_of_solvers(count: int) -> None:
    """Print times per period and impact over eta, and how much slower other solvers are."""
    native, python = find_or_export(OSCILLATOR).path, find_or_export(OSCILLATOR, "fmi2-python").path
    print("".join(f"{name:>12}" for name in COLUMNS), "  (the last two: times the native FMU)")
    seconds, impacts = 0.0, 0
    for eta in ETAS:
        runs = (time_periods_and_count_impacts(native, eta, count) for _ in range(3))
        taken, count_of_impacts = min(runs)
        seconds, impacts = seconds + taken, impacts + count_of_impacts
        each = taken / count
        sine = partial(lambda eta, time: -math.sin(eta * time), eta)  # of amplitude 1/eta^2 m
        solver = sampled_solver.time_simulation_from_rest(PAPER, sine, 10 * TURN / eta) / 10
        ratios = time_periods_in_pure_python(python, eta, 30) / 30 / each, solver / each
        row = (eta, each * 1e6, taken / max(count_of_impacts, 1) * 1e9, *ratios)
        print("".join(f"{value:12.4g}" for value in row), flush=True)
    quiet = time_quiet_step(native) * 1e9
    print(f"all: {seconds / impacts * 1e9:.0f} ns an impact; a step without one: {quiet:.0f} ns")
    asked, alone = time_resonance(native)
    print(f"resonance at 500 frequencies: {asked:.2f} s, {asked / alone:.2f} times the FMU's steps")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tools.benchmark", description=__doc__)
    parser.add_argument("--periods", type=int, default=2000, help="periods a frequency")
    parser.add_argument("--once", nargs=3, metavar=("FMU", "ETA", "PERIODS"), help="seconds of one")
    parser.add_argument("--before", type=Path, metavar="CHECKOUT", help="another version's clone")
    parser.add_argument("--scale", type=float, default=1.0, help="of the questions' sizes")
    parser.add_argument("--only", default="", help="rows whose name contains this")
    parser.add_argument("--rounds", type=int, default=3, help="runs; the shortest counts")
    arguments = parser.parse_args()
    if arguments.before:
        how = arguments.scale, arguments.rounds, arguments.only
        print_comparison_of_versions(arguments.before.resolve(), *how)
    elif arguments.once:
        fmu, eta, count = arguments.once
        print(time_periods_and_count_impacts(fmu, float(eta), int(count))[0])
    else:
        print_comparison_of_solvers(arguments.periods)


if __name__ == "__main__":
    main()
