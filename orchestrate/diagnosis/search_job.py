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
from ..laboratory.analysis.order_tracking import bound_on_sweep_frequency, decimate
from ..laboratory.pieces import Floats
from ..model import Structure
from ..running.job import Job, Table
from .curve_evidence import COARSE_SAMPLES, CurveData
from .evidence import Evidence
from .hypotheses import SOUND, Delaminated, DelaminatedWithClearance, Hypothesis, Onset
from .misfit import misfit
from .multistart import Search, Solution, difference_step, with_distinct_misfits, without_neighbours
from .opening_measures import OpeningMeasures, measure_opening
from .order_windows import MIN_WINDOWS, SAMPLES_PER_PERIOD, RecordOrders, compute_orders
from .settings import SETTINGS, Settings
from .standard_errors import estimate_with_errors

MAX_SOLUTIONS, MAX_NUMBERS, MAX_MINIMA = 4, 7, 8  # rows and columns of tables


@dataclass(frozen=True, eq=False)
class RecordData:
    """Hold the channels of a record, in the form in which a job keeps and compares them."""

    names: tuple[str, ...]
    # hz, s
    sample_rate: float
    begin: float
    channels: Floats  # m/s2, shape (channels, samples)
    participation: tuple[float | None, ...] = ()  # of each sensor; None, or (): to be fitted
    settings: Settings = SETTINGS

    def __eq__(self, other: object) -> bool:
        """Whether another one has the same samples and settings, as the copy in a worker has."""
        return self is other or (
            isinstance(other, RecordData)
            and {**vars(self), "channels": 0} == {**vars(other), "channels": 0}
            and np.array_equal(self.channels, other.channels)
        )

    def __hash__(self) -> int:
        """Hash without the samples, which are many."""
        return hash((self.names, self.sample_rate, self.begin, self.channels.shape))

    @classmethod
    def from_channels(
        cls,
        channels: Channels,
        participation: tuple[float | None, ...] = (),
        settings: Settings = SETTINGS,
    ) -> RecordData:
        """Copy the samples of checked channels."""
        begin, values = float(channels.time[0]), np.array(channels.values, order="C")
        return cls(channels.names, channels.sample_rate, begin, values, participation, settings)

    def evidence(self, samples_per_period: float = SAMPLES_PER_PERIOD) -> Evidence:
        """Return the evidence of the record, with so many samples in a period at least."""
        orders = cached_orders(self)
        return Evidence.from_orders(orders, samples_per_period, self.participation, self.settings)

    def coarse_evidence(self) -> Evidence:
        """Return the evidence near the resonance with fewer samples, for a coarse search."""
        return self.evidence(COARSE_SAMPLES).near_resonance()


@lru_cache(maxsize=2)
def cached_evidence(data: RecordData | CurveData) -> Evidence:
    """Return the evidence of a record or a resonance curve, computed once per process."""
    return data.evidence()


@lru_cache(maxsize=2)
def cached_channels(data: RecordData) -> Channels:
    """Return the channels of a record as arrays, made once per process."""
    time = data.begin + np.arange(data.channels.shape[1]) / data.sample_rate
    return Channels(time, data.sample_rate, data.names, data.channels, "record")


@lru_cache(maxsize=2)
def cached_orders(data: RecordData) -> RecordOrders:
    """Return the orders of the whole record, thinned to what they need, once per process."""
    channels = cached_channels(data)
    highest = bound_on_sweep_frequency(channels)
    return compute_orders(decimate(channels, highest, SAMPLES_PER_PERIOD))


@lru_cache(maxsize=2)
def cached_coarse_evidence(data: RecordData | CurveData) -> Evidence:
    """Return the evidence for a coarse search, with which a motion takes a third of the time."""
    return data.coarse_evidence()


@lru_cache(maxsize=8)
def cached_opening_measures(data: RecordData | CurveData) -> OpeningMeasures:
    """Return order 2 of a record beyond that of a bonded structure, by a short fit."""
    evidence = cached_evidence(data)
    search = Search(SOUND[0], evidence)
    best = search.find_minima(SOUND[0].starts(evidence))[0]
    motion = SOUND[0].displacements(best.values, evidence, None)
    return measure_opening(evidence, evidence.sensor_orders(motion))


@lru_cache(maxsize=8)
def cached_face_difference(data: RecordData) -> float:
    """Return the faces' difference over its threshold; 0 if two modes of a sound beam make it."""
    even, modes = cached_opening_measures(data), SOUND[-1]
    if even.is_order_2_seen or even.largest_sensor_difference <= 1.0:
        return even.largest_sensor_difference
    coarse = Search(modes, cached_coarse_evidence(data))
    nearest = coarse.find_minima(modes.starts(coarse.evidence))[0]
    best = Search(modes, cached_evidence(data)).minimise(nearest.values)
    return 0.0 if best.misfit <= data.settings.sound else even.largest_sensor_difference


@lru_cache(maxsize=2)
def cached_onset(data: RecordData | CurveData) -> Onset | None:
    """Return where order 2 begins and the bonded fit of the windows without it, or None."""
    evidence = cached_evidence(data)
    even = measure_opening(evidence, np.zeros_like(evidence.measured_orders))
    loud = even.ratio > even.threshold
    silent = ~loud & np.isfinite(even.ratio)
    if not loud.any() or silent.sum() < MIN_WINDOWS:
        return None
    first = int(np.argmax(loud))
    search = Search(SOUND[0], evidence.select_windows(~loud))
    best = search.find_minima(search.hypothesis.starts(evidence))[0].values
    begin = float(evidence.frequency[first]), float(evidence.level[first])
    return Onset(*begin, best["f"], best["log_zeta"])


@dataclass(frozen=True, kw_only=True)
class SearchJob(Job):
    """Search for the minima of all hypotheses; the last item uses the results of all others."""

    data: RecordData | CurveData
    guess: Structure
    free: tuple[str, ...]  # what is fitted of a delaminated structure
    sound: tuple[int, ...] = tuple(range(len(SOUND)))  # which of `SOUND`
    delaminated: bool = True  # whether that is searched too
    last_item_uses_all: ClassVar[bool] = True
    item_columns: ClassVar[tuple[str, ...]] = ()  # solutions
    last_weight: ClassVar[int] = 8  # refining takes about as long as all searches
    item: ClassVar[str] = "step"

    @property
    def evidence(self) -> Evidence:
        return cached_evidence(self.data)

    @property
    def is_worth_a_search(self) -> bool:
        """Whether two masses are searched: only of an opening their numbers are stated."""
        return cached_opening_measures(self.data).is_opening_seen

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        found: list[Hypothesis] = [SOUND[number] for number in self.sound]
        if self.delaminated:
            free = tuple(name for name in self.free if name != "clearance")
            found.append(Delaminated(self.guess, free))
            if "clearance" in self.free:
                onset = cached_onset(self.data)
                found.append(DelaminatedWithClearance(self.guess, (*free, "clearance"), onset))
        return tuple(found)

    def items(self) -> Sequence[int]:
        return [*reversed(range(len(self.hypotheses))), -1]  # longest first

    def progress_note(self, first: int) -> str:
        return "refining the best fits" if first == self.count() - 1 else ""

    def work(self, fmus: Mapping[str, Path], items: Sequence[int], previous: Table | None) -> Table:
        with Player(fmus[OSCILLATOR]) as player:
            if items[0] >= 0:
                return self.search_coarsely(items[0], player)
            assert previous is not None
            return self.refine_all(previous, player)

    def search_coarsely(self, position: int, player: Player) -> Table:
        hypothesis = self.hypotheses[position]
        search = Search(hypothesis, cached_coarse_evidence(self.data), player)
        starts = hypothesis.starts(self.evidence)
        worth = position < len(self.sound) or self.is_worth_a_search
        found = search.find_minima(starts) if worth else search.rank_starts(starts[:1])
        rows = np.full((1, MAX_SOLUTIONS, 1 + MAX_NUMBERS), np.nan)  # misfit, then the numbers
        for row, one in zip(rows[0], found, strict=False):
            row[: 1 + len(one.values)] = [one.misfit, *one.values.values()]
        spent = np.array([float(search.evaluations)])
        return {"place": np.array([position]), "solutions": rows, "evaluations": spent}

    def read_solutions(self, table: Table, position: int) -> list[Solution]:
        """Read the solutions of a hypothesis from a table, the best first."""
        names = list(self.hypotheses[position].bounds(self.evidence))
        rows = table["solutions"][table["place"] == position].reshape(-1, 1 + MAX_NUMBERS)
        rows = rows[np.isfinite(rows[:, 0])].tolist()
        found = [Solution(dict(zip(names, row[1:], strict=False)), row[0]) for row in rows]
        return sorted(found, key=lambda solution: solution.misfit)

    # -- the end of it ----------------------------------------------------------------------------

    def refine_all(self, previous: Table, player: Player) -> Table:
        """Refine the best solutions of each hypothesis, and compute all misfits and errors."""
        worth = self.delaminated and self.is_worth_a_search
        made: list[tuple[Search, list[Solution]]] = []
        for position in range(len(self.hypotheses)):
            search = Search(self.hypotheses[position], self.evidence, player)
            starts = [one.values for one in self.read_solutions(previous, position)]
            minima = self.refine_minima(search, starts, [one for _, one in made], worth)
            made.append((search, minima))
        count = len(self.sound)
        best = min(range(count), key=lambda position: made[position][1][0].misfit)
        if worth:  # what two masses are compared with is polished as they are
            search, found = made[best]
            made[best] = search, [search.polish(found[0]), *found[1:]]
        rows = []
        for position, one in enumerate(made):
            with_errors = position >= count if worth else position in (0, best)  # may be stated
            rows.append(self.result_columns(one, player, with_errors))
            spent = previous["evaluations"][previous["place"] == position]
            rows[-1]["end_evaluations"] += spent.sum()
        return {name: np.stack([part[name] for part in rows])[np.newaxis] for name in rows[0]}

    def refine_minima(
        self,
        search: Search,
        starts: list[Mapping[str, float]],
        others: Sequence[Sequence[Solution]],
        worth: bool,
    ) -> list[Solution]:
        """Return a hypothesis's minima, the best first, from the ends of all its searches."""
        hypothesis, contained = search.hypothesis, others[:1]
        if isinstance(hypothesis, Delaminated):
            guessed = hypothesis.values_from_structure(self.guess, self.evidence)
            dampings = {"log_zeta1": guessed["log_zeta2"], "log_zeta2": guessed["log_zeta1"]}
            exchanged = {**guessed, "split": -guessed["split"], **dampings}  # both halves
            starts = [*starts, guessed, exchanged]
            contained = others[len(self.sound) :]
        zero = dict.fromkeys(hypothesis.bounds(self.evidence), 0.0)
        above = [{**zero, **one[0].values} for one in contained]
        coarse = Search(hypothesis, cached_coarse_evidence(self.data), search.player)
        ranked = self.sort_by_misfit_and_guess(search, coarse.rank_starts([*starts, *above]))
        best, *rest = without_neighbours(ranked)
        if hypothesis.is_rugged and not worth:
            return search.rank_starts([best.values])
        near = self.data.settings.close * best.misfit * hypothesis.is_rugged
        tried = [best.values, *(one.values for one in rest[:1] if one.misfit < near)]
        search.evaluations += coarse.evaluations
        best, *rest = self.sort_by_misfit_and_guess(search, search.rank_starts([*tried, *above]))
        return [search.polish(best) if hypothesis.is_rugged or not worth else best, *rest]

    def sort_by_misfit_and_guess(
        self, search: Search, solutions: Sequence[Solution]
    ) -> list[Solution]:
        """Sort by misfit, those of two halves with a penalty for distance from the guess."""
        hypothesis, settings = search.hypothesis, self.data.settings

        def penalised_misfit(solution: Solution) -> float:
            if not isinstance(hypothesis, Delaminated):
                return solution.misfit
            made = hypothesis.structure_from_values(solution.values, self.evidence)
            off = (math.log(made.get(f) / self.guess.get(f)) for f in ("f1", "f2"))
            squares = sum((one / settings.guess_deviation) ** 2 for one in off)
            more = settings.guess_weight * min(squares, settings.guess_squares)
            return solution.misfit * (1.0 + more)

        return sorted(solutions, key=penalised_misfit)

    def result_columns(
        self, minima: tuple[Search, list[Solution]], player: Player, with_errors: bool
    ) -> dict[str, Any]:
        """Return the best solution of a hypothesis with its errors, residuals and fitted orders."""
        search, found = minima
        values, known = found[0].values, None
        if with_errors:
            values, known = estimate_with_errors(search, values)
        motion = search.hypothesis.displacements(values, self.evidence, player)
        computed = self.evidence.sensor_orders(motion)
        residuals = self.evidence.residuals_of_orders(computed)
        numbers = np.full(MAX_NUMBERS, np.nan)
        numbers[: len(values)] = list(values.values())
        covariance = np.full((MAX_NUMBERS, MAX_NUMBERS), np.nan)
        if known is not None:
            covariance[: len(values), : len(values)] = known
        factors = participations_with_errors(search, values, motion, known)
        levels = np.full(MAX_MINIMA, np.nan)
        different = with_distinct_misfits(found, self.data.settings.distinct)[:MAX_MINIMA]
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
    search: Search, values: Mapping[str, float], motion: Floats, covariance: Floats | None
) -> Floats:
    """Return the sensors' participation factors and their standard errors, shape (2, sensors)."""
    evidence = search.evidence
    here = evidence.fit_participations(motion)
    if covariance is None:
        return np.stack([here, np.full(len(here), np.nan)])
    free = np.array([evidence.fixed_participation(row) is None for row in range(len(here))])
    slopes = []
    for name, value in values.items():
        step = difference_step(search, name)
        moved = {**values, name: value + step}
        there = search.hypothesis.displacements(moved, evidence, search.player)
        slopes.append((evidence.fit_participations(there) - here) / step)
    slope = np.stack(slopes, axis=1)
    variance = np.diag(slope @ covariance @ slope.T)
    variance = variance + (evidence.settings.model_error * here) ** 2
    return np.stack([here, np.where(free, np.sqrt(variance), 0.0)])
