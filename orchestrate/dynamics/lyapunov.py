"""Largest Lyapunov exponents from impacts, with errors: periodic, neutral or chaotic responses.

By exact flow and saltation matrices (:mod:`.variational`), not from two neighbours, which near
grazing impacts and in chattering are never both near enough and far enough.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Annotated, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..fmu import Impacts
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Positive, Transient, whole
from ..response.labels import Variable, flags, make_dataset, variable
from ..response.questions import Point, Values
from ..response.signatures import as_given, question
from ..running.job import Table
from ..running.options import Running
from .closed_form import FREE, INNER, ClosedForm
from .impacts_after_transient import FollowedResponse, ImpactsQuestion
from .lyapunov_spectrum import (
    STATES,
    bonded_spectrum,
    kaplan_yorke_dimension,
    lyapunov_spectrum,
    unknown_spectrum,
)
from .variational import exponent_library, library_arguments, period_in_tau

PERIODIC, NEUTRAL, CHAOTIC = -1, 0, 1
WORDS = {PERIODIC: "periodic", NEUTRAL: "neutral", CHAOTIC: "chaotic"}
LARGEST, SAYS = "largest Lyapunov exponent", "what the exponent says of the response"
ORDER = "exponent's place, the largest first"
DIMENSION = "Kaplan-Yorke dimension of the attractor in the stroboscopic section"
BLOCKS, BATCHES, SIGMAS, WANDER = 40, 8, 3.0, 10.0  # defaults of the parameters of these names
Floats = NDArray[np.float64]


class Exponent(NamedTuple):
    """Largest Lyapunov exponent per unit of tau and its standard error; NaN where unknown."""

    value: float
    error: float


def min_impacts(batches: int = BATCHES) -> int:
    """Return the fewest impacts from which an exponent has an error."""
    return 2 * batches


def exponent_from_impacts(
    impacts: Impacts, end: float, point: Point, blocks: int = BLOCKS, batches: int = BATCHES
) -> Exponent:
    """Return the largest exponent by non-dimensional impacts up to ``end``; NaN if too few."""
    if len(impacts.time) < min_impacts(batches):
        return Exponent(math.nan, math.nan)
    *arguments, memory = library_arguments(impacts, end, point)
    result, averaging = np.empty(2), (blocks, batches)
    exponent_library().largest_exponent(*arguments, *averaging, memory.ctypes, result.ctypes)
    return Exponent(*result.tolist())


def largest_exponent(
    impacts: Impacts, periods: int, point: Point, blocks: int = BLOCKS, batches: int = BATCHES
) -> Exponent:
    """Return a response's largest exponent and its error, the exact one if it never impacts."""
    exact = None if len(impacts.time) else exact_exponent_without_impacts(point)
    end = periods * period_in_tau(point.excitation.eta(point.structure))
    return exact or exponent_from_impacts(impacts, end, point, blocks, batches)


def exact_exponent_without_impacts(point: Point) -> Exponent | None:
    """Return the exponent of the settled response that never impacts; None if there is none."""
    structure = point.structure
    form = ClosedForm.from_structure(*point)
    mode = INNER if structure.bonded else form.impact_free_mode
    if mode < 0:
        return None
    if structure.wall and mode != FREE:  # nothing moves
        return Exponent(-math.inf, math.nan)
    rates = []  # of decay, of those that move; of overdamped ones the slower rate
    for i in range(2 - structure.wall) if mode == FREE else (2,):
        damping, stiffness = form.damping[i], form.stiffness[i]
        root = math.sqrt(max(damping**2 - stiffness, 0.0))
        rates.append(stiffness / (damping + root) if root else damping)
    return Exponent(-min(rates), 0.0)


def exponent_floors(etas: Iterable[float], periods: int, wander: float = WANDER) -> Floats:
    """Return the exponents below which a deviation may only wander, by this factor, not grow."""
    spans = [periods * period_in_tau(eta) for eta in etas]
    return np.array([exponent_library().wander_floor(wander, span) for span in spans])


def classify_exponents(
    exponent: ArrayLike, error: ArrayLike, floor: ArrayLike, sigmas: float = SIGMAS
) -> NDArray[np.int8]:
    """Classify: 1 chaotic, -1 periodic, 0 neutral (within `sigmas` errors or `floor`, or NaN)."""
    columns = np.broadcast_arrays(exponent, error, floor)
    rows = zip(*(each.ravel().tolist() for each in columns), strict=True)
    verdicts = [exponent_library().classify_exponent(*map(float, row), sigmas) for row in rows]
    return np.array(verdicts, dtype=np.int8).reshape(columns[0].shape)


class LyapunovJob(ImpactsQuestion):
    """Job of :func:`orchestrate.lyapunov`: largest Lyapunov exponents along a parameter."""

    result: ClassVar[str] = "exponent"
    chunk_size: ClassVar[int] = 5

    def row(self, impacts: Impacts, item: FollowedResponse) -> Sequence[float]:
        """Return the largest exponent, its error, impacts a period, and all four with errors."""
        point, count = item.point, len(impacts.time)
        eta, needed = point.excitation.eta(point.structure), min_impacts(self.batches)
        exact = None if count else exact_exponent_without_impacts(point)
        if exact is None and count < needed:
            enough = f" (periods >= {-(-needed * self.periods // count)})" if count else ""
            raise InputError(
                f"periods = {self.periods}: {count} impacts at eta = {eta:g}; "
                f"expected periods with at least {needed} impacts{enough}"
            )
        rate, measured = count / self.periods, (self.periods * period_in_tau(eta), point)
        averaging = self.blocks, self.batches
        if not self.spectrum:
            return [*(exact or exponent_from_impacts(impacts, *measured, *averaging)), rate]
        spectrum = unknown_spectrum()  # of equal masses that never separate
        if count:
            spectrum = lyapunov_spectrum(impacts, *measured, *averaging)
        elif point.structure.bonded:
            spectrum = bonded_spectrum(point.structure)
        largest = exact or (spectrum.exponents[0], spectrum.errors[0])
        return [*largest, rate, *spectrum.exponents, *spectrum.errors]

    def dataset(self, table: Table) -> xr.Dataset:
        along, (exponent, error, impacts) = self.series.name, table["rows"].T[:3]
        floor = exponent_floors(self.series.etas, self.periods, self.wander)
        verdicts = classify_exponents(exponent, error, floor, self.sigmas)
        variables: dict[str, Variable] = {
            "exponent": variable(along, exponent, "1", f"{LARGEST}, per unit of tau"),
            "standard_error": variable(along, error, "1", "standard error of the exponent"),
            "verdict": flags(along, verdicts, SAYS, WORDS),
            "impacts_per_period": variable(along, impacts, "1", "impacts per excitation period"),
        }
        coordinates = self.series.coordinates()
        if self.spectrum:
            exponents, errors = np.split(table["rows"][:, 3:], 2, axis=1)
            dimensions = [kaplan_yorke_dimension(row) for row in exponents]
            text, dims = "Lyapunov exponents, per tau", (along, "order")
            variables["exponents"] = variable(dims, exponents, "1", text)
            variables["exponent_errors"] = variable(dims, errors, "1", "their standard errors")
            variables["kaplan_yorke_dimension"] = variable(along, dimensions, "1", DIMENSION)
            coordinates["order"] = variable("order", np.arange(1, STATES + 1), "1", ORDER)
        title = f"{LARGEST} along {along}: {self.structure.label()}"
        return make_dataset(variables, coordinates, title)


@question(LyapunovJob)
def lyapunov(
    structure: Structure,
    *,
    eta: Values = None,
    frequency: Values = None,
    amplitude: Values = None,
    box_acceleration: Values = 0.0,
    force1: Values = 0.0,
    force2: Values = 0.0,
    over: str | None = None,
    values: ArrayLike | None = None,
    transient: Transient = 500,
    periods: Count = 2500,
    start: ArrayLike | xr.Dataset | None = None,
    spectrum: bool = False,
    blocks: Count = BLOCKS,
    batches: Annotated[int, whole(3)] = BATCHES,
    sigmas: Positive = SIGMAS,
    wander: Positive = WANDER,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute largest Lyapunov exponents along a parameter, with verdicts periodic to chaotic.

    Parameters
    ----------
    structure : Structure
        Masses of different damping, and overdamped ones, included.
    eta, frequency, amplitude, box_acceleration, force1, force2, over, values
        As in :func:`orchestrate.sweep`.
    transient : int
        Excitation periods dropped at each value.
    periods : int
        Periods followed after them.
    start : array_like or xarray.Dataset, optional
        State at phase 0 that each response starts from, x1, x2 in m, v1, v2 in m/s, or one state
        for each; or what :func:`orchestrate.sweep` has answered for the same values, whose
        responses are followed on. At rest by default.
    spectrum : bool
        Whether to compute all four exponents and the Kaplan-Yorke dimension too.
    blocks : int
        Products of the impacts' matrices whose growth is averaged.
    batches : int
        Groups of them whose spread is the uncertainty (batch means).
    sigmas : float
        Standard errors that an exponent must be away from zero for a verdict.
    wander : float
        Factor by which a deviation may wander that neither grows nor shrinks.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``exponent`` per unit of tau (multiply by omega for 1/s), ``standard_error``, ``verdict``
        (-1 periodic, 0 neutral: quasi-periodic or not decided, 1 chaotic) and
        ``impacts_per_period``. With ``spectrum=True`` also ``exponents`` over ``order``, the
        largest first, ``exponent_errors``, and the ``kaplan_yorke_dimension`` of the attractor in
        the stroboscopic section (add 1 for that of the flow). The third and the fourth exponent
        are minus infinity where permanent contact occurs, which forgets the gap; all are NaN of
        masses that are alike and never part.

    Raises
    ------
    InputError
        Also where a response has too few impacts in ``periods`` for an uncertainty; it says how
        many it takes.

    Notes
    -----
    A deviation of the state of (6) is carried from impact to impact by exact flow matrices of (10),
    at each by the saltation matrix of (15), in permanent contact as the common motion of (10) until
    the release (19). Structures that move as linear ones, bonded or with masses that are alike,
    have an exact exponent.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.lyapunov import lyapunov
    >>> found = lyapunov(Structure.nondimensional(), eta=[0.8, 1.047], periods=400)
    >>> found.verdict.values.tolist(), float(found.exponent[1].round(3))
    ([1, -1], -0.007)
    >>> found = lyapunov(Structure.nondimensional(), eta=0.8, periods=800, spectrum=True)
    >>> float(found.kaplan_yorke_dimension[0].round(1))
    3.1
    """
    return as_given()
