"""Search for the numbers with which a hypothesis comes closest to a record, from many starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..fmu import Player
from ..laboratory.pieces import Floats
from .evidence import Evidence
from .hypotheses import Hypothesis
from .misfit import SOFT_LIMIT, LinearModel, misfit

STEPS = {  # of the differences that make derivatives; f and common: parts of the resonance's
    **{"common": 3e-4, "f": 1e-4, "split": 3e-3, "e": 0.02, "clearance": 0.01},
    **{"log_zeta": 0.02, "log_zeta1": 0.05, "log_zeta2": 0.05},
    **{"square": 0.01, "cube": 0.02, "friction": 0.01, "stop": 0.02, "position": 0.02},
    "apart": 3e-3,
}
MIN_DISTANCES = {"split": 0.04, "clearance": 0.1}  # between two solutions that count as two


@dataclass(frozen=True)
class Solution:
    """Hold a minimum of the misfit of a hypothesis: its numbers and its misfit."""

    values: Mapping[str, float]
    misfit: float  # see `misfit`; 1 is as far as `model_error` and the noise allow


class EnoughMotionsError(Exception):
    """Raised where a way downhill would take more motions than it may."""


@dataclass
class Search:
    """Search for the numbers of a hypothesis that fit a record; counts the computed motions."""

    hypothesis: Hypothesis
    evidence: Evidence
    player: Player | None = None  # for hypotheses that need the FMU
    evaluations: int = field(default=0, init=False)
    _last: tuple[dict[str, float], Floats] | None = field(default=None, init=False)

    def residuals(self, values: Mapping[str, float]) -> Floats:
        """Return the residuals of the motion with these numbers, shape (sensors, 4, windows)."""
        if self._last is None or self._last[0] != values:
            self._last = dict(values), self.compute_residuals(values)
        return self._last[1]

    def compute_residuals(self, values: Mapping[str, float]) -> Floats:
        """Compute the motion with these numbers and return its residuals, without the cache."""
        from ..errors import FmuError, InputError

        self.evaluations += 1
        try:
            motion = self.hypothesis.displacements(values, self.evidence, self.player)
        except (FmuError, InputError):  # numbers that the FMU refuses: nothing to be found there
            return self.evidence.unbounded_residuals()
        return self.evidence.residuals_of_motion(motion)

    def residual_derivatives(
        self, values: Mapping[str, float], bounds: Mapping[str, Any]
    ) -> Floats:
        """Differentiate the residuals by the numbers, shape (residuals, numbers)."""
        here = self.residuals(values).ravel()
        columns = []
        for name in values:
            step = difference_step(self, name)
            if values[name] + step > bounds[name][1]:
                step = -step
            there = self.residuals({**values, name: values[name] + step}).ravel()
            columns.append((there - here) / step)
        return np.stack(columns, axis=1)

    def find_minima(self, starts: Sequence[Mapping[str, float]]) -> list[Solution]:
        """Minimise from the best starts that differ; return the minima, the best first."""
        settings = self.evidence.settings
        count = settings.rugged_starts if self.hypothesis.is_rugged else settings.starts
        chosen = without_neighbours(self.rank_starts(starts))[:count]
        return sorted((self.minimise(one.values) for one in chosen), key=lambda one: one.misfit)

    def minimise(self, start: Mapping[str, float]) -> Solution:
        """Go downhill from a start, by SciPy's trf; at most ``steps`` motions and one more."""
        from scipy.optimize import least_squares

        settings, bounds = self.evidence.settings, self.hypothesis.bounds(self.evidence)
        limits = np.array([*bounds.values()]).T
        tried = [np.clip([start[name] for name in bounds], *limits)]

        def named(numbers: Floats) -> dict[str, float]:
            return dict(zip(bounds, numbers.tolist(), strict=True))

        def residuals(numbers: Floats) -> Floats:
            tried.append(numbers.copy())
            if len(tried) > 1 + settings.steps:
                raise EnoughMotionsError
            return self.residuals(named(numbers)).ravel()

        def derivatives(numbers: Floats) -> Floats:
            return self.residual_derivatives(named(numbers), bounds)

        scales: Any = {"loss": "soft_l1", "f_scale": SOFT_LIMIT, "x_scale": "jac"}
        ends = {"ftol": settings.tolerance, "xtol": settings.tolerance}
        try:
            end = least_squares(residuals, tried[0], derivatives, limits, **scales, **ends).x
        except EnoughMotionsError:
            end = tried[-1]  # which need not be the lowest
        return Solution(named(end), misfit(self.residuals(named(end))))

    def polish(self, start: Solution) -> Solution:
        """Improve a minimum by linear regressions over clouds of points."""
        here, size, settings = start, 1.0, self.evidence.settings
        shape = np.diag([difference_step(self, name) ** 2 for name in start.values])
        bounds = self.hypothesis.bounds(self.evidence)
        for number in range(settings.rounds):
            model = LinearModel.fit_to_cloud(
                self.residuals, bounds, here.values, size * shape, number, settings.points
            )
            best = self.rank_starts(model.damped_minima(bounds, here.values))[0]
            if model.lowest < best.misfit:
                best = Solution(model.best, model.lowest)
            shape = model.cloud_covariance()
            if best.misfit < (1.0 - settings.gain) * here.misfit:
                here, size = best, min(1.0, 1.5 * size)
            elif size > 0.1:
                size *= 0.2
            else:
                break
        return here

    def rank_starts(self, starts: Sequence[Mapping[str, float]]) -> list[Solution]:
        """Compute the misfits at these starts, and return them as solutions, the best first."""
        names = self.hypothesis.bounds(self.evidence)
        found = []
        for start in starts:
            values = {name: float(np.clip(start[name], *names[name])) for name in names}
            found.append(Solution(values, misfit(self.residuals(values))))
        return sorted(found, key=lambda solution: solution.misfit)


def difference_step(search: Search, name: str) -> float:
    return STEPS[name] * (search.evidence.resonance if name in ("f", "common") else 1.0)


def with_distinct_misfits(solutions: Sequence[Solution], ratio: float) -> list[Solution]:
    """Return the minima whose misfits differ by a ratio, the best first."""
    found: list[Solution] = []
    for one in sorted(solutions, key=lambda solution: solution.misfit):
        if not found or one.misfit > ratio * found[-1].misfit:
            found.append(one)
    return found


def without_neighbours(solutions: Sequence[Solution]) -> list[Solution]:
    """Drop the solutions that have nearly the split and clearance of a better one."""

    def is_neighbour(one: Mapping[str, float], other: Mapping[str, float]) -> bool:
        names = [name for name in MIN_DISTANCES if name in one]
        near = all(abs(one[name] - other[name]) <= MIN_DISTANCES[name] for name in names)
        same_half_below = one.get("split", 0.0) * other.get("split", 0.0) >= 0.0
        return bool(names) and near and same_half_below

    found: list[Solution] = []
    for one in solutions:
        if not any(is_neighbour(one.values, other.values) for other in found):
            found.append(one)
    return found
