"""Curves of roots followed by their arclength, whatever the equations are.

A curve is what n equations leave of n + 1 unknowns. It is followed by Keller's pseudo-arclength
method: a step along the tangent, then Newton's method in the plane across it. It goes round folds,
where no unknown serves as the curve's parameter. (Packages for continuation in Python look for
branch points of smooth systems themselves; what ends a branch here are impacts, so this small
engine only follows, and leaves it to the caller to look.)
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .closed_form import Floats

DENSE = 40  # equations up to which they are solved as if no coefficient were zero
NEARLY = 1e-6  # a step that shrinks no more from here on is rounding
ROUNDED = 0.05
POLISHING = 2  # Newton steps after convergence, with the derivative at the root itself
ACROSS = 1e-6  # cosine below which a tangent lies across the direction that should orient it
LARGE = 0.9  # of the largest component: the first one above it orients a vector


class NoConvergenceError(Exception):
    """Newton's method found no root near where it was sent."""


class Curve(Protocol):
    """n equations in n + 1 unknowns."""

    scale: Floats  # sizes of the unknowns, shape (n + 1,)

    @property
    def accuracy(self) -> float:
        """Largest residual of a root, in the units of the equations."""

    def residual(self, unknowns: Floats) -> Floats:
        """What is left of the equations, shape (n,)."""

    def jacobian(self, unknowns: Floats, at_root: bool = False) -> Floats:
        """Its derivative, shape (n, n + 1): at a root exact, on the way to it perhaps an estimate.

        Raises
        ------
        NoConvergenceError
            Where there is no derivative.
        """


Followed = TypeVar("Followed", bound=Curve)


@dataclass(frozen=True)
class Root:
    """A point of a curve.

    Attributes
    ----------
    unknowns : ndarray, shape (n + 1,)
    tangent : ndarray, shape (n + 1,)
        Of length 1, in unknowns over their scale.
    residual : float
        Largest absolute value of what is left of the equations.
    iterations : int
    """

    unknowns: Floats
    tangent: Floats
    residual: float
    iterations: int


def corrected(
    curve: Curve,
    guess: Floats,
    across: Floats,
    *,
    tolerance: float = 1e-8,
    most: int = 8,
    furthest: float = 0.5,
) -> Root:
    """The root near a guess, in the plane across a direction.

    Parameters
    ----------
    curve : Curve
    guess : ndarray, shape (n + 1,)
    across : ndarray, shape (n + 1,)
        Direction in unknowns over their scale; the root differs from the guess across it alone. A
        unit vector holds an unknown fixed.
    tolerance : float
        Largest last step before the root is polished, in unknowns over their scale.
    most : int
        Iterations.
    furthest : float
        Longest way from the guess, in unknowns over their scale.

    Raises
    ------
    NoConvergenceError
        Where there is none.

    Notes
    -----
    A short step alone does not make a root: with a wrong derivative steps are short anywhere. So
    the derivative is made anew where the steps have become short, two more steps are taken with
    it, and the root is accepted by what is left of the equations then, ``curve.accuracy`` at most.
    It is known to rounding, and so is its tangent: nothing that is decided by them depends on how
    another processor rounds.
    """
    way, length = np.zeros_like(guess), np.inf
    for iteration in range(1, most + 1):
        way, step = newton_step(curve, guess, way, across)
        before, length = length, float(np.abs(step).max())
        if not length < np.inf or float(np.abs(way).max()) > furthest:
            raise NoConvergenceError("Newton's method went too far")
        if length <= tolerance or before * ROUNDED <= length <= before <= NEARLY:
            return polished(curve, guess, way, across, iteration)
    raise NoConvergenceError(f"no root after {most} iterations")


def newton_step(
    curve: Curve, guess: Floats, way: Floats, across: Floats, jacobian: Floats | None = None
) -> tuple[Floats, Floats]:
    """One step of Newton's method: the way from the guess after it, and the step.

    The derivative is the curve's own where none is given.

    Raises
    ------
    NoConvergenceError
        Where the equations are singular, or have no value.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            unknowns = guess + curve.scale * way
            jacobian = curve.jacobian(unknowns) if jacobian is None else jacobian
            left = np.append(curve.residual(unknowns), across @ way)
            step = solved(np.vstack([jacobian * curve.scale, across]), left)
    except (np.linalg.LinAlgError, InputError) as error:
        raise NoConvergenceError(str(error)) from None
    return way - step, step


def polished(curve: Curve, guess: Floats, way: Floats, across: Floats, iterations: int) -> Root:
    """The root that Newton's method has come near to, with its tangent.

    Raises
    ------
    NoConvergenceError
        Where it is none.
    """
    try:
        jacobian = curve.jacobian(guess + curve.scale * way, at_root=True)
        for _ in range(POLISHING):
            way, _ = newton_step(curve, guess, way, across, jacobian)
        unknowns = guess + curve.scale * way
        left = float(np.abs(curve.residual(unknowns)).max(initial=0.0))
    except InputError as error:
        raise NoConvergenceError(str(error)) from None
    if not left <= curve.accuracy:
        raise NoConvergenceError(f"no root: {left:.0e} is left of the equations")
    tangent = null_vector(np.vstack([jacobian * curve.scale, across]))
    return Root(unknowns, tangent, left, iterations)


def solved(matrix: Floats, right: Floats) -> Floats:
    """The solution of linear equations; of many, most of whose coefficients are zero.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the matrix is singular.
    """
    if len(right) <= DENSE:
        return np.asarray(np.linalg.solve(matrix, right), dtype=float)
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    if not np.isfinite(matrix).all():
        raise np.linalg.LinAlgError("not finite")
    try:
        found: Floats = splu(csc_array(matrix)).solve(right)
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from None
    return found


def null_vector(matrix: Floats) -> Floats:
    """The direction of length 1 that all rows but the last map to zero, on the side of the last.

    Where it is across the last row, as at a fold of a parameter that was held, it has no side: a
    component orients it.
    """
    last = np.zeros(len(matrix))
    last[-1] = 1.0
    try:
        found = solved(matrix, last)
    except np.linalg.LinAlgError:
        found = np.linalg.svd(matrix[:-1])[2][-1]
    tangent: Floats = found / np.linalg.norm(found)
    return tangent if abs(float(matrix[-1] @ tangent)) > ACROSS else oriented(tangent)


def oriented(vector: Floats) -> Floats:
    """A vector or its opposite: linear algebra leaves it to the processor which one comes out."""
    return vector if vector[oriented_by(vector)] > 0.0 else -vector


def oriented_by(vector: NDArray[np.inexact]) -> int:
    """The first component that is about as large as the largest one."""
    size = np.abs(vector)
    return int(np.argmax(size > LARGE * size.max()))


def held(curve: Curve, unknown: int) -> Floats:
    """The direction to correct across where an unknown is to stay as it is."""
    found = np.zeros_like(curve.scale)
    found[unknown] = 1.0
    return found


@dataclass
class Walk(Generic[Followed]):
    """A walk along a curve, with steps as long as the curve is straight.

    Attributes
    ----------
    curve : Curve
    root : Root
        Where it stands; the walk goes on along the tangent.
    step : float
        Length of the next step, in unknowns over their scale.
    longest, shortest : float
        Steps allowed.
    sharpest : float
        Cosine of the largest angle between successive tangents.
    tolerance : float
        As :func:`corrected` has it.
    """

    curve: Followed
    root: Root
    step: float
    longest: float
    shortest: float = 1e-7
    sharpest: float = 0.97
    tolerance: float = 1e-8

    def at(self, length: float) -> Root:
        """The root a length along the tangent from where the walk stands."""
        root = self.root
        guess = root.unknowns + length * root.tangent * self.curve.scale
        return corrected(self.curve, guess, root.tangent, tolerance=self.tolerance)

    def ahead(self, acceptable: Callable[[Root], bool] = lambda root: True) -> tuple[Root, float]:
        """The next root, and the length of the step to it: straight and acceptable.

        Raises
        ------
        NoConvergenceError
            Where no step is short enough.
        """
        length = self.step
        while length >= self.shortest:
            try:
                found = self.at(length)
            except NoConvergenceError:
                length *= 0.35
                continue
            cosine = float(found.tangent @ self.root.tangent)
            if cosine >= self.sharpest and acceptable(found):
                easy = cosine > 0.993 and found.iterations <= 4
                self.step = min(self.longest, length * (1.6 if easy else 1.0))
                return found, length
            length *= 0.5
        raise NoConvergenceError("no step is short enough")

    def inside(
        self,
        first: int,
        limits: Sequence[tuple[float, float]],
        acceptable: Callable[[Root], bool] = lambda root: True,
    ) -> tuple[Root, float, bool]:
        """The next root inside limits, as :meth:`ahead`, and whether it lies on one of them.

        Parameters
        ----------
        first : int
            Number of the first unknown that has limits.
        limits : sequence of (float, float)
            Of that one and those after it.
        acceptable : callable
        """
        limit = self.limit_ahead(first, limits)
        if limit is not None:
            with contextlib.suppress(NoConvergenceError):
                found = self.land(*limit)
                if found.tangent @ self.root.tangent >= self.sharpest and acceptable(found):
                    way = (found.unknowns - self.root.unknowns) / self.curve.scale
                    return found, float(way @ self.root.tangent), True
            self.step *= 0.5
        return *self.ahead(acceptable), False

    def limit_ahead(
        self, first: int, limits: Sequence[tuple[float, float]]
    ) -> tuple[int, float] | None:
        """The unknown that the next step takes past its limit, and the limit."""
        rates = self.root.tangent * self.curve.scale
        found, nearest = None, self.step
        for unknown, ends in enumerate(limits, first):
            rate = float(rates[unknown])
            limit = ends[1] if rate > 0.0 else ends[0]
            way = (limit - self.root.unknowns[unknown]) / rate if rate else np.inf
            if way <= nearest:
                found, nearest = (unknown, limit), way
        return found

    def land(self, unknown: int, value: float) -> Root:
        """The root near here at which an unknown has a value."""
        rate = self.root.tangent[unknown] * self.curve.scale[unknown]
        length = (value - self.root.unknowns[unknown]) / rate
        guess = self.root.unknowns + length * self.root.tangent * self.curve.scale
        guess[unknown] = value
        across = held(self.curve, unknown)
        found = corrected(self.curve, guess, across, tolerance=self.tolerance)
        if found.tangent @ self.root.tangent < 0.0:
            return Root(found.unknowns, -found.tangent, found.residual, found.iterations)
        return found
