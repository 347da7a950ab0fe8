"""Jumps that ``couple`` reports on random drives, against held voltages and averaged theory.

The judge holds voltages in one long run, of which nothing is restored, and compares the mean speed
at the end of each hold. An answer on one direction of the voltage is wrong where

- it brackets a loss, but held past the bracket the speed goes on as before it, or it comes back;
- it lacks a loss: on a grid, there and back, two motions last at a voltage before a step of the
  speed that is in none of its brackets, and a ramp straight to that step finds it too;
- it brackets a loss, but on that grid the speed comes back everywhere;
- the structure is bonded, and loses its motion elsewhere by the averaged theory, or not at all;
- at another rate of the ramp it is the contrary.

"Undecided" is never wrong, and counted. What speaks against an answer has to do so on a slow way
too: a ramp throws a motion with a narrow basin out of it long before it ends.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pytest

from orchestrate import couple
from orchestrate.errors import VibroimpactError
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple import schedule_from_arguments
from orchestrate.weak_drive.schedule import Course, Ramp
from tests.draws import RATES, System, draw_with_folds, ramp_ends, scale_to_slope, smallest_slope

from .findings import expect_none

WAYS = {"up": 1.0, "down": -1.0}
SLOPES = (-0.6, 0.3)  # least slopes d eta0 / d Omega of drives that nearly have, or lack, folds
THEORY = 5e-4  # of eta0: its own error is 1.1e-4
FLAT = 0.02  # least slope d eta0 / d Omega of a branch that has no folds for sure
TOLERANCE = 2e-4  # of eta0: how far a bracket may lie from where the motion is lost
EARLY = 2e-3  # of eta0: how far before its end an irregular motion may be lost
CHANGE = 8e-3  # of omega: least difference of the speeds of two motions
SAME = 4e-3  # of omega: speeds at one voltage that differ by more are of two motions
GRID = 4e-3  # of eta0
AROUND = (0.06, 0.04)  # of eta0: of the grid, below the lowest fold and above the highest
RATE, SLOW_RATE = 5e-5, 5e-6  # of eta0 in a time 1/omega, between holds
LONG, LONG_OF_ROTOR = 4000.0, 200.0  # holds: 1/omega, 1/b
SHORT, PATIENT = 0.25, 10.0  # of a hold: on the grid, and at a bracket wider than `TOLERANCE`
SETTLED = 1e-3  # of omega: mean speeds of the last two quarters of a hold


class Jump(NamedTuple):
    """A bracket of the voltage, over K omega, in which a motion is lost, or may be."""

    low: float
    high: float
    decided: bool = True

    def contains(self, low: float, high: float, beside: float) -> bool:
        """Return whether the bracket meets a range, up to ``beside``."""
        return self.low <= high + beside and low - beside <= self.high


def reported_jumps(system: System, rate: float) -> dict[str, list[Jump]]:
    """Run ``couple`` at a rate; return its jumps in both directions."""
    structure, drive = system
    volts = drive.volts(structure)
    first, last = (end * volts for end in ramp_ends(system))
    rate *= volts * structure.omega
    run = couple(structure, drive, voltage=(first, last), rate=rate, progress=False)
    found: dict[str, list[Jump]] = {way: [] for way in WAYS}
    for label in run.jump.values:
        at = run.sel(jump=label)
        low, high = sorted(float(at[name]) / volts for name in ("jump_low", "jump_high"))
        if np.isfinite(low):
            found[str(label).split()[0]].append(Jump(low, high, at.decided != "undecided"))
    return found


def held_speeds(
    system: System, way: str, voltages: Sequence[float], rate: float, part: float = 1.0
) -> np.ndarray:
    """Hold voltages in one run that begins as a ramp does; NaN where a speed does not settle.

    Where motions coexist another beginning leads to another one.
    """
    structure, drive = system
    omega, volts = structure.omega, drive.volts(structure)
    first, last = ramp_ends(system)[:: int(WAYS[way])]
    ramp = schedule_from_arguments(structure, drive, (first * volts, last * volts))
    assert isinstance(ramp, Ramp)
    times, course = [0.0], [first]
    if ramp.spin_up:
        times, course = [0.0, ramp.spin_up * omega], [ramp.low / volts, first]
    times, course, ends = [*times, ramp.ramp_start * omega], [*course, first], []
    hold = part * (LONG + LONG_OF_ROTOR / drive.b(structure))
    for voltage in voltages:
        arrival = times[-1] + max(abs(voltage - course[-1]) / rate, 1.0)
        times, course = [*times, arrival, arrival + hold], [*course, voltage, voltage]
        ends.append(times[-1])
    schedule = Course(tuple(np.array(times) / omega), tuple(np.array(course) * volts))
    run = couple(structure, drive, voltage=schedule, hold=0.0, progress=False)
    time, speed = run.time.values * omega, np.abs(run.Omega.values)
    last = np.array([speed[(time > end - 0.25 * hold) & (time <= end)].mean() for end in ends])
    before = [speed[(time > end - 0.5 * hold) & (time <= end - 0.25 * hold)].mean() for end in ends]
    return np.where(np.abs(last - before) < SETTLED, last, np.nan)


def bracket_problem(system: System, way: str, jump: Jump, rate: float) -> str:
    """Hold voltages around a bracket; return any contradiction.

    Where the speed does not change over the bracket, it has to have changed from before to it by
    more than a branch does that is as steep as further before.
    """
    sign = WAYS[way]
    stays, lost = sorted((jump.low, jump.high), reverse=sign < 0.0)
    far, past = stays - sign * EARLY, lost + sign * TOLERANCE
    course = (far - sign * EARLY, far, stays, past, stays)
    is_slow = jump.high - jump.low > TOLERANCE  # it is as wide as growth takes to be seen
    problem = ""
    for part in (PATIENT,) if is_slow else (1.0, PATIENT):  # a motion may be lost only after long
        first, before, there, beyond, back = held_speeds(system, way, course, rate, part)
        steep = abs(before - first) < CHANGE  # else a motion was lost between the two
        expected = before + (before - first) * steep
        if abs(beyond - there) < SAME and abs(beyond - expected) < SAME:
            problem = f"past it, held, the speed goes on as from {far:.5f}"
        elif abs(back - there) < SAME and abs(back - expected) < SAME:
            problem = "the speed comes back there"
        else:
            return ""
    return f"lost at {stays:.5f}, but {problem}"


def grid_problem(system: System, way: str, jumps: Sequence[Jump], rate: float) -> str:
    """Hold a grid of voltages there and back; return any contradiction.

    On the way there the speed lags until it jumps. Two motions the other way round exchange beside
    the resonance, and no verdict lacks them.
    """
    low, high = ramp_ends(system)
    first = min([low + 0.15, *(jump.low for jump in jumps)]) - AROUND[0]
    last = max([high - 0.15, *(jump.high for jump in jumps)]) + AROUND[1]
    sign, grid = WAYS[way], np.arange(max(first, low), min(last, high), GRID)
    voltages = grid[:: int(sign)]
    speeds = held_speeds(system, way, [*voltages, *voltages[::-1]], rate, SHORT)
    there, back = speeds[: len(grid)], speeds[: len(grid) - 1 : -1]
    behind, gained = sign * (back - there), np.append(sign * np.diff(there), 0.0)
    if any(jump.decided for jump in jumps) and (np.abs(behind) < SAME).all():
        return "lost, but held speeds come back everywhere"
    for i in np.flatnonzero((behind > CHANGE) & (np.append(behind[1:], 0.0) < SAME)):
        if not jumps:  # from nearer ones on, at which motions part, none is a jump
            return f"none, but two motions last at {voltages[i]:.5f}: {behind[i]:.4f} apart"
    usual = np.fmax(GRID, np.roll(gained, 1))  # a branch is as steep as before, or steeper
    for i in np.flatnonzero((gained > usual + CHANGE) & (behind > CHANGE)):
        ends = sorted(voltages[i : i + 2])
        if any(jump.contains(*ends, EARLY) for jump in jumps):
            continue
        straight = np.diff(held_speeds(system, way, voltages[i : i + 2], RATE))
        if not abs(straight[0]) < CHANGE:  # else the holds before led to another motion
            return f"not lost from {ends[0]:.5f} to {ends[1]:.5f}, where held speeds jump"
    return ""


def theory_problem(system: System, way: str, jumps: Sequence[Jump]) -> str:
    """Compare an answer on the bonded structure with the averaged theory; return the error.

    The motion is lost at a fold, or between a Neimark-Sacker point and the last fold.
    """
    limit = averaged.stability_limits(*system)[list(WAYS).index(way)]
    folds = sorted(fold.eta0 for fold in averaged.folds(*system))
    lost = [jump for jump in jumps if jump.decided]
    if limit is None or not folds:
        is_flat = smallest_slope(system) > FLAT
        return "lost, and in theory no motion is" if lost and is_flat and limit is None else ""
    if folds[-1] - folds[0] < THEORY or len(lost) < len(jumps):
        return ""
    ends = sorted((limit.eta0, folds[-1] if way == "up" else folds[0]))
    if all(jump.contains(*ends, THEORY) for jump in lost) and lost:
        return ""
    return f"{lost or 'none'}, in theory lost between {ends[0]:.5f} and {ends[1]:.5f}"


def judge(system: System, kind: str, rates: Sequence[float]) -> Iterator[tuple[str, str]]:
    """Yield each answer on a structure, with any error; what is held is held once an answer."""
    own, said, seen = system.of_kind(kind), Counter[tuple[str, str]](), set[object]()
    for rate in rates:
        for way, jumps in reported_jumps(own, rate).items():
            lost = [jump for jump in jumps if jump.decided]
            word = "lost" if lost else "undecided" if jumps else "none"
            said[way, word] += 1
            problems = [theory_problem(own, way, jumps)] if kind == "bonded" else []
            checks = [(bracket_problem, jump) for jump in lost]
            for check, what in [*checks, (grid_problem, tuple(jumps))]:
                key = check, way, np.round(np.array(what, float), 3).tobytes()
                if key not in seen:
                    problem = check(own, way, what, RATE)
                    problems.append(problem and check(own, way, what, SLOW_RATE))
                seen.add(key)
            for problem in filter(None, problems):
                yield "wrong", f"{kind}, {way}, rate {rate:g}: {problem}"
            yield word, ""
    for way in WAYS:
        if said[way, "lost"] and said[way, "none"]:
            yield "wrong", f"{kind}, {way}: lost at some rates, none at others"


@pytest.mark.slow
@pytest.mark.budget(1)  # drives; of more than one each takes some minutes
def test_jump_verdicts_of_random_drives(exported, seed, budget):
    """With folds at four rates, and with so little unbalance that folds are close or just vanish.

    A short run, of one drive, judges its bonded structure with folds at one rate.
    """
    counts, findings = Counter[str](), []
    for number in range(budget):
        rng = np.random.default_rng([seed, number])
        folded = draw_with_folds(rng)
        edge = scale_to_slope(folded, float(rng.uniform(*SLOPES)))
        drives = {"folds": (folded, RATES), "near the edge": (edge, RATES[::3])}
        cases = [(name, kind) for name in drives for kind in ("bonded", "delaminated")]
        for name, kind in cases if budget > 1 else cases[:1]:
            system, rates = drives[name]
            try:
                for word, problem in judge(system, kind, rates[: 4 * budget - 3]):
                    counts[word] += 1
                    findings += [f"drive {number}, {name}, {problem}"] if problem else []
            except VibroimpactError as error:
                findings.append(f"drive {number}, {name}: {error}")
    expect_none(findings, counts)
