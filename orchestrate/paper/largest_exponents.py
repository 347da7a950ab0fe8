"""Job: each region's largest Lyapunov exponent, repeated by a long run of its own.

The largest of many estimates is chosen for its error too: its own standard error does not know of
that. So the sweep's exponents only say where to look. What is quoted is a run of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..access import OSCILLATOR, EventInstance
from ..dynamics.following import State
from ..dynamics.long_runs import (
    ENDED,
    NOT_RUN,
    STEADY,
    UNDECIDED,
    WORDS,
    LongRun,
    perturbed_start,
    run_until_steady,
    wander_error,
)
from ..response.labels import flags, variable
from ..response.questions import Point
from ..running.job import Inputs, Job, Table
from ..structures import Excitation, Structure
from .regions import COUNT, list_regions

if TYPE_CHECKING:
    import xarray as xr

LOST = 3
OUTCOMES = {**WORDS, LOST: "steady, but no more what it was chosen for"}
NUMBERS = {
    "eta": "frequency ratio Omega/omega of the candidate",
    "screened": "exponent by which it was chosen, one of many noisy ones",
    "exponent": "exponent of the long run from another start, per unit of tau",
    "standard_error": "standard error of the exponent, by the scatter of the parts",
    "outcome": "what the successive parts say",
}


class Candidate(NamedTuple):
    """A response that may have its region's largest Lyapunov exponent: point, start, exponent."""

    point: Point
    start: State  # state at phase 0 on the settled response, m and m/s
    screened: float  # the exponent it was chosen by


class RegionCandidates(NamedTuple):
    """A region's number and its candidates, the largest exponent first."""

    number: int
    candidates: Sequence[Candidate]


@dataclass(frozen=True, kw_only=True)
class LargestExponentJob(Job):
    """Job: long runs of each region's candidates until one has a steady exponent."""

    case: str  # of cases.CASES
    structure: Structure
    # names of the results that say where to look: exponents along the up-sweep, states on the
    # responses, and the limits of the regions
    exponents: str
    settled: str
    limits: str
    periods: int = 10_000  # excitation periods of each part
    # of each run, and how many runs until an exponent is undecided
    parts: int = 10
    runs: int = 3
    # frequencies tried in a region, the largest exponent first, until one is steady
    candidates: int = 10
    seed: int = 23  # of the other starts

    def needs(self) -> tuple[str, ...]:
        """Return the names of the jobs whose results it needs."""
        return self.exponents, self.settled, self.limits

    def count(self) -> int:
        """Return the number of regions."""
        return COUNT

    def items(self, inputs: Inputs) -> Sequence[RegionCandidates]:
        """Return the regions with their candidates; a region may have none."""
        exponents = inputs[self.exponents].sortby("eta")
        ends = inputs[self.settled].sortby("eta").end_state
        searched = []
        for number, region in enumerate(list_regions(inputs[self.limits], self.case)):
            part = exponents.exponent.sel(eta=slice(region.low, region.high))
            order = np.argsort(-part.values, kind="stable")[: self.candidates]
            rows = part.isel(eta=order)
            candidates = [
                self.make_candidate(eta, ends.sel(eta=eta, method="nearest").values, value)
                for eta, value in zip(rows.eta.values.tolist(), rows.values.tolist(), strict=True)
            ]
            searched.append(RegionCandidates(number, candidates))
        return searched

    def make_candidate(self, eta: float, end: np.ndarray, screened: float) -> Candidate:
        """Return a candidate at eta from a non-dimensional end state and its exponent."""
        point = Point(self.structure, Excitation.nondimensional(eta, self.structure))
        return Candidate(point, tuple((end * point.scale).tolist()), screened)

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[RegionCandidates], previous: Table | None
    ) -> Table:
        """Run one region's candidates in turn until one is steady; return a row for each."""
        ((number, candidates),) = items
        rows = np.full((self.candidates, len(NUMBERS)), np.nan)
        rows[:, -1] = NOT_RUN
        with EventInstance(fmus[OSCILLATOR]) as instance:
            for index, (point, start, screened) in enumerate(candidates):
                other = perturbed_start(point, start, [self.seed, number, index])
                run = run_until_steady(instance, point, other, self.periods, self.parts, self.runs)
                eta = point.excitation.eta(point.structure)
                outcome = self.classify_run(run, screened, eta)
                rows[index] = [eta, screened, *run.exponent, outcome]
                if outcome == STEADY:
                    break
        return {"rows": rows[np.newaxis]}

    def classify_run(self, run: LongRun, screened: float, eta: float) -> int:
        """Return a long run's outcome: ``LOST`` if less than half of the growth is left.

        Chaos may have ended before the first part that counts, or the other start may lead to
        another attractor.
        """
        lost = screened - run.exponent.value > max(0.5 * screened, wander_error(self.periods, eta))
        return LOST if run.outcome == STEADY and screened > 0.0 and lost else run.outcome

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """Return the runs as a dataset over region and candidate."""
        import xarray as xr

        dims = "region", "candidate"
        columns = np.moveaxis(table["rows"], -1, 0)
        variables = {
            name: flags(dims, column, text, OUTCOMES)
            if name == "outcome"
            else variable(dims, column, "1", text)
            for (name, text), column in zip(NUMBERS.items(), columns, strict=True)
        }
        named = list_regions(inputs[self.limits], self.case)
        variables["low"] = variable("region", [one.low for one in named], "1", "where it begins")
        variables["high"] = variable("region", [one.high for one in named], "1", "where it ends")
        text = "orbit of the window, or those of the windows around it"
        coordinates = {"region": variable("region", [one.name for one in named], "1", text)}
        title = f"Largest Lyapunov exponents by region: {self.structure.label()}"
        return xr.Dataset(variables, coordinates, {"title": title})


class LargestExponent(NamedTuple):
    """A region's largest exponent with error and frequency, and notes on other candidates."""

    # naN where none of the candidates was decided
    exponent: float
    error: float
    eta: float
    others: tuple[str, ...]  # A phrase for each candidate whose response was not steady

    def text(self) -> str:
        """Return the exponent as text; notes on candidates that were not steady in brackets."""
        if np.isnan(self.exponent):
            value = "undecided"
        else:
            value = f"{self.exponent:.4f} ± {self.error:.4f} at {self.eta:.3f}"
        return f"{value} ({'; '.join(self.others)})" if self.others else value


def largest_exponent(data: xr.Dataset, region: str) -> LargestExponent:
    """Return a region's largest exponent among its candidates that were decided."""
    rows = data.sel(region=region)
    tried = rows.isel(candidate=rows.outcome.values != NOT_RUN)
    others = []
    for k in range(tried.sizes["candidate"]):
        one = tried.isel(candidate=k)
        head = f"{float(one.screened):.4f} at {float(one.eta):.3f}"
        value = f"{float(one.exponent):.4f} ± {float(one.standard_error):.4f}"
        if one.outcome == ENDED:
            others.append(f"{head}: the parts of its long run did not agree at first, {value} then")
        elif one.outcome == LOST:
            others.append(f"{head} did not last, {value} in its long run")
        elif one.outcome == UNDECIDED:
            others.append(f"{head} is undecided: the parts of its long run do not agree")
    sure = tried.isel(candidate=tried.outcome.values != UNDECIDED)
    if not sure.sizes["candidate"]:
        return LargestExponent(np.nan, np.nan, np.nan, tuple(others))
    best = sure.isel(candidate=int(sure.exponent.values.argmax()))
    numbers = float(best.exponent), float(best.standard_error), float(best.eta)
    return LargestExponent(*numbers, tuple(others))
