"""The fits of a record as a job: sound hypotheses and parts of the scan in parallel."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ..fmu import OSCILLATOR, Player
from ..laboratory.analysis.channels import Channels
from ..laboratory.pieces import Floats
from ..model import Structure
from ..running.job import Job, Table
from .curve_evidence import CurveData
from .decision_rule import SETTINGS
from .errors import Estimate, estimate
from .even_orders import even_orders
from .evidence import MODEL_ERROR, Evidence
from .fitting import POLISH_ROUNDS, Search, Solution, difference_step, distinct_minima
from .hypotheses import SOUND, STARTING_SPLITS, Delaminated, DelaminatedWithClearance, Hypothesis
from .misfit import misfit
from .orders import RecordOrders, channel_orders

BONDED_STEPS = 15  # steps downhill from the bonded solution
SCAN_STARTS = 1  # starts of each part of the scan from which to go downhill
# Steps downhill from each start of the scan where a delamination is possible, and elsewhere
COARSE_STEPS, SHORT_STEPS = 4, 2
CLEARANCE_STARTS = 6  # starts with a clearance from which to go downhill
# How many of the best starts go on, and for how many steps
CONTINUED_STARTS, CONTINUED_STEPS = 3, 6
# How many of the best are polished, and how close their misfits are
POLISHED_STARTS, CLOSE_RATIO = 2, 1.3
GOOD_MISFIT = 1.2  # misfit of a delaminated one from which no other kind of clearance is looked for
COARSE_SAMPLES = 7.0  # samples in a period of the highest frequency for a coarse search
GUESS_DEVIATION = 0.06  # standard deviation of a guessed frequency's logarithm
# A misfit counts more by this part of the guess's squared deviations, and at most so many of them
GUESS_WEIGHT, MAX_GUESS_SQUARES = 0.02, 20.0
MIN_DISTANCES = {"split": 0.04, "clearance": 0.1}  # between two solutions that count as two
FINAL_ROUNDS = 4  # rounds on the whole record after those near the resonance
GAPS = (-0.3, -0.1, -0.03, 0.03, 0.1, 0.3)  # clearances over the largest displacement
# Rows and columns of tables: solutions, values in each, misfits of minima
MAX_SOLUTIONS, MAX_NUMBERS, MAX_MINIMA = 4, 6, 8


@dataclass(frozen=True)
class RecordData:
    """Hold the channels of a record as plain tuples, the form in which a job keeps them."""

    names: tuple[str, ...]
    # hz, s
    sample_rate: float
    begin: float
    channels: tuple[tuple[float, ...], ...]  # m/s2
    participation: tuple[float | None, ...] = ()  # of each sensor; None, or (): to be fitted

    @classmethod
    def from_channels(
        cls, channels: Channels, participation: tuple[float | None, ...] = ()
    ) -> RecordData:
        """Copy the samples of checked channels."""
        values = tuple(tuple(row.tolist()) for row in channels.values)
        begin = float(channels.time[0])
        return cls(channels.names, channels.sample_rate, begin, values, participation)

    def to_channels(self) -> Channels:
        """Return the record as channels, which were checked before."""
        time = self.begin + np.arange(len(self.channels[0])) / self.sample_rate
        return Channels(time, self.sample_rate, self.names, np.array(self.channels), "record")

    def evidence(self) -> Evidence:
        """Return the evidence of the record."""
        return Evidence.from_orders(cached_orders(self), participation=self.participation)

    def coarse_evidence(self) -> Evidence:
        """Return the evidence near the resonance with fewer samples, for a coarse search."""
        orders = cached_orders(self)
        return Evidence.from_orders(orders, COARSE_SAMPLES, self.participation).near_resonance()


@lru_cache(maxsize=2)
def cached_evidence(data: RecordData | CurveData) -> Evidence:
    """Return the evidence of a record or a resonance curve, computed once per process."""
    return data.evidence()


@lru_cache(maxsize=2)
def cached_orders(data: RecordData) -> RecordOrders:
    """Return the orders of the whole record, computed once per process."""
    return channel_orders(data.to_channels())


@lru_cache(maxsize=2)
def cached_coarse_evidence(data: RecordData | CurveData) -> Evidence:
    """Return the evidence for a coarse search, with which a motion takes a third of the time."""
    return data.coarse_evidence()


@lru_cache(maxsize=2)
def is_worth_a_search(data: RecordData | CurveData) -> bool:
    """Return whether the verdict may depend on the delaminated fit, by a short bonded fit.

    Elsewhere the search is short.
    """
    evidence = cached_evidence(data)
    search = Search(SOUND[0], evidence)
    best = search.best_minima(search.hypothesis.starts(evidence), keep=2, coarse=8, fine=0)[0]
    motion = search.hypothesis.displacements(best.values, evidence, None)
    return may_be_delaminated(evidence, motion, best.misfit)


def may_be_delaminated(evidence: Evidence, bonded_motion: Floats, sound_misfit: float) -> bool:
    """Return whether the verdict may depend on the delaminated fit.

    It may where faces are seen to part or do not move as one, or where a sound structure does not
    describe the record.
    """
    even = even_orders(evidence, evidence.fitted_orders(bonded_motion))
    return even.is_opening_seen or sound_misfit > SETTINGS.sound


@dataclass(frozen=True, kw_only=True)
class SearchJob(Job):
    """Search for the minima of all hypotheses; the last item uses the results of all others."""

    data: RecordData | CurveData
    guess: Structure
    free: tuple[str, ...]  # what is fitted of a delaminated structure
    sound: tuple[int, ...] = tuple(range(len(SOUND)))  # which of `SOUND`
    delaminated: bool = True  # whether that is searched too
    gathers: ClassVar[bool] = True
    item: ClassVar[str] = "search"

    @property
    def evidence(self) -> Evidence:
        """Evidence of the record or the resonance curve."""
        return cached_evidence(self.data)

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """All hypotheses of the job, in the order of the results."""
        found: list[Hypothesis] = [SOUND[number] for number in self.sound]
        if self.delaminated:
            free = tuple(name for name in self.free if name != "clearance")
            found.append(Delaminated(self.guess, free))
            if "clearance" in self.free:
                found.append(DelaminatedWithClearance(self.guess, (*free, "clearance")))
        return tuple(found)

    def items(self) -> Sequence[tuple[str, float]]:
        """Return the independent searches (sound hypotheses, parts of the scan), then the end."""
        sound = [("sound", float(position)) for position in range(len(self.sound))]
        scan = [("scan", split) for split in STARTING_SPLITS] if self.delaminated else []
        return [*scan, *sound, ("end", 0.0)]

    def work(
        self,
        fmus: Mapping[str, Path],
        items: Sequence[tuple[str, float]],
        previous: Table | None,
    ) -> Table:
        """Do one search; the last one refines the best of all others."""
        kind, number = items[0]
        if kind == "sound":
            return self.search_sound(int(number))
        with Player(fmus[OSCILLATOR]) as player:
            if kind == "scan":
                return self.search_split(number, player)
            assert previous is not None
            return self.finish(previous, player)

    def search_sound(self, position: int) -> Table:
        """Search for the minima of a sound hypothesis."""
        search = Search(self.hypotheses[position], self.evidence)
        starts = search.hypothesis.starts(self.evidence)
        found = search.best_minima(starts, keep=3, coarse=10, fine=20)
        if found[0].misfit > SETTINGS.sound:  # a jump of the response makes it rugged
            found[0] = search.polish(found[0])
        return solutions_table(position, found, search.evaluations)

    def search_split(self, split: float, player: Player) -> Table:
        """Search for the delaminated minima from the starts with one split of the halves."""
        position = len(self.sound)
        search = Search(self.hypotheses[position], cached_coarse_evidence(self.data), player)
        starts = [s for s in search.hypothesis.starts(self.evidence) if s["split"] == split]
        coarse = COARSE_STEPS if is_worth_a_search(self.data) else SHORT_STEPS
        found = search.best_minima(starts, keep=SCAN_STARTS, coarse=coarse, fine=0)
        return solutions_table(position, found, search.evaluations)

    def solutions(self, table: Table, position: int) -> list[Solution]:
        """Read the solutions of a hypothesis from a table, the best first."""
        hypothesis = self.hypotheses[position]
        names = list(hypothesis.bounds(self.evidence))
        rows = table["solutions"][table["place"] == position].reshape(-1, 1 + MAX_NUMBERS)
        found = [
            Solution(hypothesis.name, dict(zip(names, row[1:].tolist(), strict=False)), row[0])
            for row in rows[np.isfinite(rows[:, 0])]
        ]
        return sorted(found, key=lambda solution: solution.misfit)

    # -- the end of it ----------------------------------------------------------------------------

    def finish(self, previous: Table, player: Player) -> Table:
        """Refine the best delaminated solutions, and compute all misfits and errors."""
        sound = [self.minima(position, previous, player) for position in range(len(self.sound))]
        bonded = sound[0][1][0]
        sound = [(search, with_bonded_solution(bonded, search, found)) for search, found in sound]
        best = int(np.argmin([found[0].misfit for _, found in sound]))
        worth = self.is_worth_polishing(sound)
        made = [
            self.hypothesis_result(position, one, player, position in (0, best))
            for position, one in enumerate(sound)
        ]
        if self.delaminated:
            search, found = self.minima(len(made), previous, player)
            found = (
                self.refine_best(search, found) if worth else search.rank_starts([found[0].values])
            )
            plain = self.hypothesis_result(len(made), (search, found), player, worth)
            made.append(plain)
            if "clearance" in self.free:
                made.append(self.search_with_clearance(plain, player, worth))
        spent = previous["evaluations"]
        for position, result in enumerate(made):
            result["end_evaluations"] += spent[previous["place"] == position].sum()
        return {name: np.stack([part[name] for part in made])[np.newaxis] for name in made[0]}

    def minima(
        self, position: int, previous: Table, player: Player
    ) -> tuple[Search, list[Solution]]:
        """Return a search for a hypothesis, and the minima that the independent searches found."""
        search = Search(self.hypotheses[position], self.evidence, player)
        return search, self.solutions(previous, position)

    def is_worth_polishing(self, sound: Sequence[tuple[Search, list[Solution]]]) -> bool:
        """Return whether the verdict may depend on the delaminated fit, by the sound fits."""
        search, found = sound[0]
        motion = search.hypothesis.displacements(found[0].values, self.evidence, None)
        lowest = min(found[0].misfit for _, found in sound)
        return may_be_delaminated(self.evidence, motion, lowest)

    def refine_best(self, search: Search, starts: Sequence[Solution]) -> list[Solution]:
        """Refine the best coarse solutions, first near the resonance, then on the whole record."""
        coarse = Search(search.hypothesis, cached_coarse_evidence(self.data), search.player)
        hypothesis = search.hypothesis
        assert isinstance(hypothesis, Delaminated)
        guessed = hypothesis.values_from_structure(self.guess, self.evidence)
        both = [guessed, with_halves_exchanged(guessed)]
        starts = [*starts, *coarse.rank_starts(both)]
        chosen = without_neighbours(self.sort_by_misfit_and_guess(search, starts))[
            :CONTINUED_STARTS
        ]
        found = self.sort_by_misfit_and_guess(
            search, [coarse.refine(s.values, CONTINUED_STEPS, 3e-3) for s in chosen]
        )
        lowest = min(one.misfit for one in found)
        close = [one for one in found[:POLISHED_STARTS] if one.misfit < CLOSE_RATIO * lowest]
        polished = [coarse.polish(one).values for one in close]
        rest = [one.values for one in found[len(close) :]]
        best, *others = self.sort_by_misfit_and_guess(
            search, search.rank_starts([*polished, *rest])
        )
        search.evaluations += coarse.evaluations
        rounds = FINAL_ROUNDS if best.misfit < GOOD_MISFIT else POLISH_ROUNDS
        return [search.polish(best, rounds), *others]

    def sort_by_misfit_and_guess(
        self, search: Search, solutions: Sequence[Solution]
    ) -> list[Solution]:
        """Sort delaminated solutions by misfit, with a penalty for distance from the guess.

        Of one sensor's record both halves may change places at nearly the same misfit; what is
        known of the halves before then decides, as far as a guess may be trusted.
        """
        hypothesis = search.hypothesis
        assert isinstance(hypothesis, Delaminated)

        def penalised_misfit(solution: Solution) -> float:
            """Return the misfit, raised by the distance of f1 and f2 from the guess."""
            made = hypothesis.structure_from_values(solution.values, self.evidence)
            off = (
                math.log(made.get(f) / self.guess.get(f)) / GUESS_DEVIATION for f in ("f1", "f2")
            )
            return solution.misfit * (
                1.0 + GUESS_WEIGHT * min(sum(one**2 for one in off), MAX_GUESS_SQUARES)
            )

        return sorted(solutions, key=penalised_misfit)

    def search_with_clearance(
        self, plain: dict[str, Any], player: Player, worth: bool
    ) -> dict[str, Any]:
        """Search for gaps and preloads, from the best solution without them.

        Where that does not describe the record already, the hypothesis's own starts are tried too.
        """
        search = Search(self.hypotheses[-1], self.evidence, player)
        names = list(search.hypothesis.bounds(self.evidence))
        best = dict(zip(names, plain["end_values"][: len(names) - 1].tolist(), strict=False))
        starts = [{**best, "clearance": clearance} for clearance in (0.0, *GAPS)]
        if not worth:
            found = search.rank_starts(starts[:1])
        elif plain["end_misfit"] < GOOD_MISFIT:
            found = search.rank_starts(starts)
            found[0] = search.polish(found[0], FINAL_ROUNDS)
        else:
            starts += search.hypothesis.starts(self.evidence)
            coarse = Search(search.hypothesis, cached_coarse_evidence(self.data), player)
            begun = without_neighbours(coarse.rank_starts(starts))[:CLEARANCE_STARTS]
            found = [coarse.refine(one.values, COARSE_STEPS, 3e-3) for one in begun]
            found = self.refine_best(search, found)
            search.evaluations += coarse.evaluations
        return self.hypothesis_result(len(self.hypotheses) - 1, (search, found), player, worth)

    def hypothesis_result(
        self,
        position: int,
        minima: tuple[Search, list[Solution]],
        player: Player,
        with_errors: bool = True,
    ) -> dict[str, Any]:
        """Return the best solution of a hypothesis with its errors, residuals and fitted orders."""
        search, found = minima
        values, known = found[0].values, None
        if with_errors:
            known = estimate(search, values)
            values = known.values
        motion = search.hypothesis.displacements(values, self.evidence, player)
        computed = self.evidence.fitted_orders(motion)
        residuals = self.evidence.order_residuals(computed)
        numbers = np.full(MAX_NUMBERS, np.nan)
        numbers[: len(values)] = list(values.values())
        covariance = np.full((MAX_NUMBERS, MAX_NUMBERS), np.nan)
        if known is not None:
            covariance[: len(values), : len(values)] = known.covariance
        factors = participations_with_errors(search, values, motion, known)
        levels = np.full(MAX_MINIMA, np.nan)
        different = distinct_minima(found)[:MAX_MINIMA]
        levels[: len(different)] = [one.misfit for one in different]
        return {
            "end_values": numbers,
            "end_covariance": covariance,
            "end_minima": levels,
            "end_misfit": misfit(residuals),
            "end_residuals": residuals,
            "end_fitted": np.stack([computed.real, computed.imag]),
            "end_participation": factors,
            "end_evaluations": float(search.evaluations),
        }


def participations_with_errors(
    search: Search, values: Mapping[str, float], motion: Floats, known: Estimate | None
) -> Floats:
    """Return the sensors' participation factors and their standard errors, shape (2, sensors).

    They follow from the numbers, whose errors they have beside those of a good model; NaN where
    these are not known, 0 where the factor was given.
    """
    evidence = search.evidence
    here = evidence.participations(motion)
    if known is None:
        return np.stack([here, np.full(len(here), np.nan)])
    free = np.array([evidence.given_participation(row) is None for row in range(len(here))])
    slopes = []
    for name, value in values.items():
        step = difference_step(search, name)
        there = search.hypothesis.displacements(
            {**values, name: value + step}, evidence, search.player
        )
        slopes.append((evidence.participations(there) - here) / step)
    slope = np.stack(slopes, axis=1)
    variance = np.diag(slope @ known.covariance @ slope.T) + (MODEL_ERROR[0] * here) ** 2
    return np.stack([here, np.where(free, np.sqrt(variance), 0.0)])


def with_halves_exchanged(values: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers of a delaminated structure whose halves have changed places."""
    zeta1, zeta2 = values["log_zeta1"], values["log_zeta2"]
    return {**values, "split": -values["split"], "log_zeta1": zeta2, "log_zeta2": zeta1}


def without_neighbours(solutions: Sequence[Solution]) -> list[Solution]:
    """Drop the solutions that have nearly the split and clearance of a better one.

    Halves that change places are another solution, however near each other their frequencies are.
    """
    found: list[Solution] = []
    for one in solutions:
        if not any(is_neighbour(one.values, other.values) for other in found):
            found.append(one)
    return found


def is_neighbour(one: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Return whether two solutions have the same half below and nearly the same numbers."""
    near = all(abs(one.get(n, 0.0) - other.get(n, 0.0)) <= s for n, s in MIN_DISTANCES.items())
    return near and one.get("split", 0.0) * other.get("split", 0.0) >= 0.0


def solutions_table(position: int, solutions: Sequence[Solution], evaluations: int) -> Table:
    """Convert solutions to a table, one row each: misfit, then values in the bounds' order."""
    rows = np.full((1, MAX_SOLUTIONS, 1 + MAX_NUMBERS), np.nan)
    for row, one in zip(rows[0], solutions, strict=False):
        row[: 1 + len(one.values)] = [one.misfit, *one.values.values()]
    return {
        "place": np.array([position]),
        "solutions": rows,
        "evaluations": np.array([float(evaluations)]),
    }


def with_bonded_solution(bonded: Solution, search: Search, found: list[Solution]) -> list[Solution]:
    """Add the refined bonded solution to a sound hypothesis's minima where it is better.

    Each of them contains the linear spring, so none may be further from the record.
    """
    names = search.hypothesis.bounds(search.evidence)
    (contained,) = search.rank_starts([{name: bonded.values.get(name, 0.0) for name in names}])
    if contained.misfit >= found[0].misfit:
        return found
    return [search.refine(contained.values, BONDED_STEPS, 1e-4), *found]
