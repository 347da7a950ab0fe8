"""Attractors of random structures: each returns in the FMU and by Newton's method."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import orchestrate
from orchestrate.errors import InputError
from orchestrate.flags import flag_words
from orchestrate.fmu import EventInstance, Instance, start_motion
from orchestrate.model import Excitation, Structure
from tests.draws import draw_structure

from .findings import expect_none

STARTS = 16  # random ones at each of two neighbouring frequencies
NEIGHBOUR = 1.003  # ratio of these
RETURNS = 1e-6  # of the motion's size: an orbit's state after its periods
DIFFERS = 1e-5  # of the motion's size: another orbit's state
# of the motion's size, or of the distance at which an orbit closes after all its periods: its state
# after fewer of them, which next to a period doubling is as near as that doubling is narrow
EARLIER, TIMES = 1e-9, 100.0
TURNS = 3  # times through an orbit, whose impacts are counted
Floats = NDArray[np.float64]


class ReportedMotion:
    """A periodic attractor as reported, with its motion simulated by the FMU."""

    def __init__(self, fmu: Path, structure: Structure, eta: float, reported: xr.Dataset) -> None:
        """Read the reported motion and compute its stroboscopic states."""
        self.fmu, self.structure, self.eta, self.reported = fmu, structure, eta, reported
        self.excitation = Excitation.nondimensional(eta, structure)
        self.periods = int(reported.multiplicity)
        self.impacts = float(reported.impacts_per_period) * self.periods
        self.state: Floats = reported.state.values
        self.states = self.stroboscopic_states()
        lengths = self.states / (1.0, 1.0, self.excitation.frequency, self.excitation.frequency)
        self.size = float(np.abs(lengths).max())
        self.gap = float(reported.xi_rel_max) * self.excitation.length(structure)

    def stroboscopic_states(self) -> Floats:
        """Return the states at phase 0 after 0, 1, ... periods."""
        states, period = [self.state], self.excitation.period
        with Instance(self.fmu) as instance:
            start_motion(instance, self.structure, self.excitation, self.state)
            for i in range(self.periods):
                instance.step(i * period, (i + 1) * period)
                states.append(np.array(instance.get("x1", "x2", "v1", "v2")))
        return np.array(states)

    def distance(self, one: Floats, other: Floats) -> float:
        """Return the distance of two states relative to the motion's size; of gaps to the gap's."""
        frequency = self.excitation.frequency
        x1, x2, v1, v2 = (one - other) / (1.0, 1.0, frequency, frequency)
        size, gap = self.size or 1.0, max(self.gap, 1e-6 * self.size) or 1.0
        return float(max(abs(np.array([x1, x2, v1, v2])).max() / size, abs(x2 - x1) / gap))

    def problems(self) -> Iterator[str]:
        """Yield a text for each way in which the FMU contradicts the reported attractor."""
        n = self.periods
        closes = self.distance(self.states[n], self.states[0])
        if closes > RETURNS:
            yield f"the FMU does not return after {n} T"
        for part in (part for part in range(1, n) if n % part == 0):
            if self.distance(self.states[part], self.states[0]) < max(EARLIER, TIMES * closes):
                yield f"the FMU returns after {part} T already, not {n} T"
        if abs(self.impacts - round(self.impacts)) > 1e-9:
            yield f"{self.impacts!r} impacts in {n} T are no whole number"
        count = self.count_impacts()
        if count != TURNS * round(self.impacts):
            yield f"{count} impacts in {TURNS} times {n} T, not {TURNS} x {self.impacts:g}"
        yield from self.orbit_problems()

    def count_impacts(self) -> int:
        """Count impacts over some periods, from the middle of the longest flight or contact."""
        span = self.periods * self.excitation.period
        with EventInstance(self.fmu) as instance:
            start_motion(instance, self.structure, self.excitation, self.state)
            times = instance.record_impacts(0.0, (TURNS + 1) * span).time
        if not len(times):
            return 0
        once = times[times <= span]
        between = np.diff(np.append(once, once[0] + span)) if len(once) else np.array([span])
        longest = int(between.argmax())
        begun = (once[longest] if len(once) else 0.0) + 0.5 * between[longest]
        begun = begun % span
        return int(((times > begun) & (times <= begun + TURNS * span)).sum())

    def orbit_problems(self) -> Iterator[str]:
        """Yield texts on what Newton's method from its state at phase 0 does not confirm."""
        if not math.isfinite(float(self.reported.multiplier)):
            return
        quiet: Any = {"progress": False, "jobs": 1}
        asked: Any = {"eta": self.eta, "period": self.periods, "guess": self.state}
        try:
            orbit = orchestrate.orbit(self.structure, **asked, **quiet)
        except InputError as error:
            yield f"orbit: {error}"
            return
        largest = float(np.hypot(*orbit.multipliers.transpose("part", "multiplier").values).max())
        if not bool(orbit.stable):
            yield f"orbit: unstable, a multiplier of {largest:.6g}"
        elif abs(largest - float(self.reported.multiplier)) > 1e-6:
            yield f"orbit: a multiplier of {largest:.6g}, not {float(self.reported.multiplier):.6g}"
        impacts = int(np.isfinite(orbit.impact_time.values).sum())
        if impacts != round(self.impacts):
            yield f"orbit: {impacts} impacts, not {self.impacts:g}"
        if min(self.distance(row, self.state) for row in orbit.state.values) > DIFFERS:
            yield "orbit: another one"


def problems(
    fmu: Path, structure: Structure, etas: Sequence[float], seed: int, counts: Counter[str]
) -> Iterator[str]:
    """Yield what is wrong with the attractors of one structure."""
    quiet: Any = {"progress": False, "jobs": 1}
    answer = orchestrate.attractors(structure, eta=list(etas), starts=STARTS, seed=seed, **quiet)
    words = flag_words(answer.decided_by.attrs)
    for place, eta in enumerate(etas):
        motions: list[ReportedMotion] = []
        for attractor in range(answer.sizes["attractor"]):
            reported = answer.isel(eta=place, attractor=attractor)
            word = words[int(reported.decided_by)]
            counts[word] += word != "absent"
            if word not in ("orbit", "repeated"):
                continue
            motion, where = ReportedMotion(fmu, structure, eta, reported), f"eta {eta:.6g}"
            yield from (f"{where}, attractor {attractor}: {line}" for line in motion.problems())
            pairs = ((row, other.state) for other in motions for row in motion.states)
            if any(motion.distance(*pair) < DIFFERS for pair in pairs):
                yield f"{where}, attractor {attractor}: is there twice"
            motions.append(motion)


@pytest.mark.slow
@pytest.mark.budget(24)  # structures
def test_attractors_are_true(fmu, seed, budget):
    """Sixteen random starts at a frequency ratio and at 1.003 times that; undecided are counted."""
    counts, findings = Counter[str](), []
    for number in range(budget):
        rng = np.random.default_rng([seed, number])
        structure, eta = draw_structure(rng)
        etas = (eta, NEIGHBOUR * eta)
        lines = problems(fmu, structure, etas, int(rng.integers(2**31)), counts)
        findings += [f"structure {number}, {structure!r}: {line}" for line in lines]
    assert counts["orbit"] > budget
    expect_none(findings, counts)
