"""Measure the speed of ``shake`` beside ``solve_ivp``: ``python -m tools.shake_benchmark``.

A minute of random excitation of a beam at 45 Hz, recorded at 20 kHz, in processor time: against
the time that the test itself would take, and against SciPy's ``solve_ivp`` with events.
"""

from __future__ import annotations

import argparse
import time
from bisect import bisect_right

from orchestrate import Random, Structure, shake
from orchestrate.laboratory.pieces import Pieces

from . import sampled_solver
from .sampled_solver import Acceleration

BEAM = Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=48.0, zeta1=0.007, zeta2=0.007, e=0.6)
BAND = ((20.0, 0.5), (200.0, 0.5))  # Hz, (m/s2)^2/Hz: 1 g rms
RATE = 20_000.0


def make_excitation(duration: float) -> Random:
    """Return the benchmark's excitation, a random vibration of a duration in s."""
    return Random(psd=BAND, duration=duration, seed=1)


def time_shake(duration: float) -> tuple[float, int]:
    """Time :func:`orchestrate.shake`; return processor seconds and impacts."""
    begin = time.process_time()
    history = shake(BEAM, make_excitation(duration), sample_rate=RATE, progress=False, jobs=1)
    return time.process_time() - begin, history.sizes["impact"]


def make_acceleration(pieces: Pieces) -> Acceleration:
    """Return a fast function of time for the acceleration given by cubic pieces."""
    nodes, rows = pieces.nodes.tolist(), pieces.derivatives.tolist()

    def acceleration(t: float) -> float:
        index = min(bisect_right(nodes, t), len(rows)) - 1
        a, b, c, d = rows[index]
        t -= nodes[index]
        return float(a + t * (b + t * (c / 2.0 + t * d / 6.0)))

    return acceleration


def time_solver(duration: float) -> tuple[float, int]:
    """Time ``solve_ivp`` under the same pieces; return processor seconds and impacts."""
    signal = make_excitation(duration)
    acceleration = make_acceleration(signal.pieces())
    scale = signal.rms / BEAM.omega**2
    return sampled_solver.simulate_from_rest(BEAM, acceleration, duration, scale, RATE)


def main() -> None:
    """Print both solvers' times per impact and per second of the motion."""
    parser = argparse.ArgumentParser(prog="python -m tools.shake_benchmark", description=__doc__)
    parser.add_argument("--duration", type=float, default=60.0, help="s")
    parser.add_argument("--solver", type=float, default=3.0, help="s that solve_ivp integrates")
    arguments = parser.parse_args()
    time_shake(1.0)  # imports, and the FMU unpacked
    seconds, impacts = min(time_shake(arguments.duration) for _ in range(3))
    pace = arguments.duration / seconds
    print(f"shake: {arguments.duration:g} s at {RATE:g} Hz, {impacts} impacts: {seconds:.3g} s,")
    print(f"  {pace:.3g} times as fast as the test")
    slow, slow_impacts = time_solver(arguments.solver)
    each = slow / arguments.solver
    print(f"solve_ivp: {arguments.solver:g} s, {slow_impacts} impacts: {slow:.3g} s,")
    print(f"  {each:.3g} times as long as the test, {each * pace:.3g} times as long as shake")


if __name__ == "__main__":
    main()
