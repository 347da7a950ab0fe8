"""Pseudo-arclength continuation: curves of roots of n equations in n + 1 unknowns.

Keller's method (1977): a step along the tangent, then Newton's method in the plane orthogonal to
it, round folds too. What ends a branch here are impacts, so :mod:`.tracer` detects that itself.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .closed_form import Floats


class NoConvergenceError(Exception):
    """An iteration has not converged to a root near its start."""


SOLVER_ERRORS = NoConvergenceError, np.linalg.LinAlgError  # of iterations, on the way along a curve


class Curve(Protocol):
    """Protocol of n equations in n + 1 unknowns: residual, Jacobian, scales and accuracy."""

    scale: Floats  # sizes of the unknowns, shape (n + 1,)

    @property
    def accuracy(self) -> float:
        """Largest residual with which a root counts as solved, in the equations' units."""

    def residual(self, unknowns: Floats) -> Floats:
        """Return the residual of the equations, shape (n,)."""

    def jacobian(self, unknowns: Floats, at_root: bool = False) -> Floats:
        """Return the residual's Jacobian, shape (n, n + 1); exact if ``at_root``."""


AnyCurve = TypeVar("AnyCurve", bound=Curve)


@dataclass(frozen=True)
class Root:
    """A solved point of a curve: unknowns, unit tangent and residual."""

    unknowns: Floats
    tangent: Floats  # of length 1, in unknowns over their scale
    residual: float  # largest absolute residual of the equations
    iterations: int  # of Newton's method

    def reversed(self) -> Root:
        return replace(self, tangent=-self.tangent)


def solve_by_brent(
    function: Callable[[float], float], low: float, high: float, **tolerances: float
) -> float:
    """Solve by Brent's method for the zero of a function between two numbers."""
    from scipy.optimize import brentq

    try:
        position, result = brentq(function, low, high, full_output=True, disp=False, **tolerances)
    except ValueError as error:  # no change of sign, or no number
        raise NoConvergenceError(str(error)) from None
    if not result.converged:
        raise NoConvergenceError(f"no root after {result.iterations} iterations")
    return float(position)


def newton_correct(
    curve: Curve,
    guess: Floats,
    normal: Floats,
    *,
    tolerance: float = 1e-8,
    max_iterations: int = 8,
    max_distance: float = 0.5,
) -> Root:
    """Solve by Newton's method for the root in the plane through ``guess`` with this normal."""
    # with a wrong derivative steps are short anywhere: it is recomputed there, two more steps are
    # taken, and the residual decides; so nothing depends on how another processor rounds
    offset, size = np.zeros_like(guess), np.inf
    for iteration in range(1, max_iterations + 1):
        offset, step = newton_step(curve, guess, offset, normal)
        before, size = size, float(np.abs(step).max())
        if not size < np.inf or float(np.abs(offset).max()) > max_distance:
            raise NoConvergenceError("Newton's method went too far")
        # a step below 1e-6 that hardly shrinks has reached rounding
        if size <= tolerance or before * 0.05 <= size <= before <= 1e-6:
            return polish_root(curve, guess, offset, normal, iteration)
    raise NoConvergenceError(f"no root after {max_iterations} iterations")


def newton_step(
    curve: Curve, guess: Floats, offset: Floats, normal: Floats, jacobian: Floats | None = None
) -> tuple[Floats, Floats]:
    """Take one step of Newton's method: return the new offset from the guess, and the step."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            unknowns = guess + curve.scale * offset
            jacobian = curve.jacobian(unknowns) if jacobian is None else jacobian
            residual = np.append(curve.residual(unknowns), normal @ offset)
            step = solve_linear(np.vstack([jacobian * curve.scale, normal]), residual)
    except (np.linalg.LinAlgError, InputError) as error:
        raise NoConvergenceError(str(error)) from None
    return offset - step, step


def polish_root(
    curve: Curve, guess: Floats, offset: Floats, normal: Floats, iterations: int
) -> Root:
    """Refine a nearly converged root with an exact Jacobian; return it with its tangent."""
    try:
        jacobian = curve.jacobian(guess + curve.scale * offset, at_root=True)
        for _ in range(2):  # known to rounding then
            offset, _ = newton_step(curve, guess, offset, normal, jacobian)
        unknowns = guess + curve.scale * offset
        residual = float(np.abs(curve.residual(unknowns)).max(initial=0.0))
    except InputError as error:
        raise NoConvergenceError(str(error)) from None
    if not residual <= curve.accuracy:
        raise NoConvergenceError(f"no root: the residual is {residual:.0e}")
    tangent = unit_tangent(np.vstack([jacobian * curve.scale, normal]))
    return Root(unknowns, tangent, residual, iterations)


def solve_linear(matrix: Floats, right: Floats) -> Floats:
    """Solve linear equations, by dense LU; large systems by sparse LU."""
    if len(right) <= 40:  # faster up to this number of equations
        return np.asarray(np.linalg.solve(matrix, right), dtype=float)
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    if not np.isfinite(matrix).all():
        raise np.linalg.LinAlgError("not finite")
    try:
        return np.asarray(splu(csc_array(matrix)).solve(right), dtype=float)
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from None


def unit_tangent(matrix: Floats) -> Floats:
    """Return the unit null vector of the Jacobian rows, oriented along the last row."""
    last = unit_vector(len(matrix), -1)
    try:
        vector = solve_linear(matrix, last)
    except np.linalg.LinAlgError:
        vector = np.linalg.svd(matrix[:-1])[2][-1]
    tangent: Floats = vector / np.linalg.norm(vector)
    # a tangent orthogonal to the last row has no side of it
    sided = abs(float(matrix[-1] @ tangent)) > 1e-6
    return tangent if sided else with_positive_leading_component(tangent)


def with_positive_leading_component(vector: Floats) -> Floats:
    """Return a vector or its negative, so that its sign does not depend on rounding."""
    return vector if vector[leading_index(vector)] > 0.0 else -vector


def leading_index(vector: NDArray[np.inexact]) -> int:
    """Return the index of the first component nearly as large as the largest in size."""
    size = np.abs(vector)
    return int(np.argmax(size > 0.9 * size.max()))


def unit_vector(size: int, component: int) -> Floats:
    vector = np.zeros(size)
    vector[component] = 1.0
    return vector


@dataclass
class ArclengthStepper(Generic[AnyCurve]):
    """Pseudo-arclength stepper along a curve; its step follows the turning of the tangent."""

    curve: AnyCurve
    root: Root  # where the stepper is; the next step goes along its tangent
    length: float  # of the next step, in unknowns over their scale
    max_length: float  # steps allowed
    min_length: float = 1e-7
    min_cosine: float = 0.97  # smallest cosine between successive tangents
    tolerance: float = 1e-8  # as newton_correct has it

    @classmethod
    def at_start(cls, curve: AnyCurve, root: Root, max_length: float) -> ArclengthStepper[AnyCurve]:
        """Return a stepper whose first step is short, as the curve is not known yet."""
        return cls(curve, root, min(1e-3, max_length), max_length)

    def root_after(self, length: float) -> Root:
        """Return the root at an arclength ahead: predicted on the tangent, then corrected."""
        root = self.root
        guess = root.unknowns + length * root.tangent * self.curve.scale
        return newton_correct(self.curve, guess, root.tangent, tolerance=self.tolerance)

    def step(
        self, first: int, limits: Sequence[tuple[float, float]], accepts: Callable[[Root], bool]
    ) -> tuple[Root, float, bool]:
        """Find the next root that ``accepts``, at most on a limit, and adapt the step.

        ``limits`` are those of the unknowns from ``first`` on. Return the root, its arclength, and
        whether it is on a limit.
        """
        limit = self.next_limit(first, limits)
        if limit is not None:
            with contextlib.suppress(NoConvergenceError):
                root = self.solve_at(*limit)
                if root.tangent @ self.root.tangent >= self.min_cosine and accepts(root):
                    offset = (root.unknowns - self.root.unknowns) / self.curve.scale
                    return root, float(offset @ self.root.tangent), True
            self.length *= 0.5
        low, high = np.transpose(limits)
        length = self.length
        while length >= self.min_length:
            try:
                root = self.root_after(length)
            except NoConvergenceError:
                length *= 0.35  # of a step without a root
                continue
            cosine = float(root.tangent @ self.root.tangent)
            limited = root.unknowns[first : first + len(limits)]
            inside = bool(((low <= limited) & (limited <= high)).all())
            if cosine >= self.min_cosine and inside and accepts(root):
                easy = cosine > 0.993 and root.iterations <= 4  # nearly straight
                self.length = min(self.max_length, length * (1.6 if easy else 1.0))
                return root, length, False
            length *= 0.5  # after a sharp bend
        raise NoConvergenceError("no step is short enough")

    def next_limit(
        self, first: int, limits: Sequence[tuple[float, float]]
    ) -> tuple[int, float] | None:
        """Return (unknown, limit) that the next step would cross first; None without one."""
        rates = self.root.tangent * self.curve.scale
        nearest, shortest = None, self.length
        for unknown, ends in enumerate(limits, first):
            rate = float(rates[unknown])
            limit = ends[1] if rate > 0.0 else ends[0]
            length = (limit - self.root.unknowns[unknown]) / rate if rate else np.inf
            if length <= shortest:
                nearest, shortest = (unknown, limit), length
        return nearest

    def solve_at(self, unknown: int, value: float) -> Root:
        """Solve for the root near the tangent at which an unknown has this value."""
        rate = self.root.tangent[unknown] * self.curve.scale[unknown]
        length = (value - self.root.unknowns[unknown]) / rate
        guess = self.root.unknowns + length * self.root.tangent * self.curve.scale
        guess[unknown] = value
        normal = unit_vector(len(guess), unknown)
        root = newton_correct(self.curve, guess, normal, tolerance=self.tolerance)
        return root.reversed() if root.tangent @ self.root.tangent < 0.0 else root
