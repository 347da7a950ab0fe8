"""Coexisting attractors: random starts, followed until settled and told apart."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import OSCILLATOR, REST, Instance, finder
from ..errors import InputError
from ..response.labels import Variable, si_state, variable
from ..response.questions import (
    Numbers,
    Point,
    SeriesQuestion,
    asked_along,
    numbers,
    positive,
    whole,
)
from ..running.job import Inputs, Table
from ..running.runner import answer
from ..structures import Structure
from .clusters import ABOUT, FEATURES, Telling, attractors_of, clusters, features, response_from

if TYPE_CHECKING:
    import xarray as xr
    from typing_extensions import Unpack

    from ..running.options import Running

ATTRACTOR = "attractor, the most frequent one first"
OF_ATTRACTORS = {
    "multiplicity": "excitation periods after which it repeats; 0: irregular",
    "impacts_per_period": "impacts per excitation period",
    "xi_rel_max": "largest gap over a eta^2",
}


class Start(NamedTuple):
    """One of the random starts at one value of the parameter.

    Attributes
    ----------
    place : int
        Of the value among all.
    point : Point
    scale : float, optional
        Half width of the box of starts, m; None: from the response from rest.
    number : int
        Of the start.
    """

    place: int
    point: Point
    scale: float | None
    number: int


@dataclass(frozen=True, kw_only=True)
class AttractorsJob(SeriesQuestion):
    """Random starts along a parameter.

    Attributes
    ----------
    starts, seed : int
        Number of starts at each value, and seed of their random numbers.
    scale : float or tuple of float, optional
        Half width of the box of starts, m: one, or one for each value.
    width : float
        Half width in units of the largest gap there, where no scale is given.
    follows : str
        Name of a sweep over the same parameter that tells the gaps instead of responses from rest.
    telling : Telling
    """

    starts: int = 60
    seed: int = 0
    scale: Numbers | None = None
    width: float = 3.0
    follows: str = ""
    telling: Telling = Telling()
    asked: ClassVar[str] = "attractors"
    chunk: ClassVar[int] = 240

    def __post_init__(self) -> None:
        super().__post_init__()
        if any(point.structure.bonded for point in self.series.points):
            raise InputError("structure: is bonded; expected one whose masses can part")
        if isinstance(self.scale, tuple) and len(self.scale) != len(self.series.values):
            raise InputError(
                f"scale: {len(self.scale)} values for {len(self.series.values)} of "
                f"{self.series.name}; expected one number or one for each"
            )

    def needs(self) -> tuple[str, ...]:
        """The sweep, if any."""
        return (self.follows,) if self.follows else ()

    def count(self) -> int:
        """Number of starts in all."""
        return self.starts * super().count()

    def items(self, inputs: Inputs) -> Sequence[Start]:
        """Every start at every value."""
        points = self.series.points
        scales = self.scales(inputs)
        return [
            Start(place, point, scales[place], number)
            for place, point in enumerate(points)
            for number in range(self.starts)
        ]

    def scales(self, inputs: Inputs) -> Sequence[float | None]:
        """Half widths of the boxes of starts, where they are known."""
        series = self.series
        if self.follows:
            along = {series.name: list(series.values)}
            gaps = inputs[self.follows].xi_rel_max.sel(along, method="nearest").values
            lengths = (point.length for point in series.points)
            return [
                self.width * float(gap) * length for gap, length in zip(gaps, lengths, strict=True)
            ]
        if isinstance(self.scale, tuple):
            return self.scale
        return [self.scale] * len(series.points)

    def work(self, fmus: Mapping[str, Path], items: Sequence[Start], carry: Table | None) -> Table:
        """Some starts."""
        rows, ends = [], []
        with Instance(fmus[OSCILLATOR]) as instance:
            for item, start in self.drawn(instance, items):
                response, _ = response_from(instance, item.point, start, self.telling)
                rows.append(features(response, item.point.length))
                ends.append(response.end)
        return {"features": np.array(rows, dtype=float), "end": np.array(ends)}

    def drawn(
        self, instance: Instance, items: Sequence[Start]
    ) -> Iterator[tuple[Start, NDArray[np.float64]]]:
        """Starts with their states."""
        for place, group in itertools.groupby(items, lambda item: item.place):
            some = list(group)
            point, scale = some[0].point, some[0].scale
            scale = self.scale_from_rest(instance, point) if scale is None else scale
            states = random_starts(self.starts, scale, (self.seed, place), point.structure.omega)
            for item in some:
                yield item, states[item.number]

    def scale_from_rest(self, instance: Instance, point: Point) -> float:
        """Half width of the box of starts from the response from rest, m."""
        gap = response_from(instance, point, REST, self.telling).response.x_rel_max
        return self.width * (gap or point.length)

    def dataset(self, table: Table, inputs: Inputs) -> xr.Dataset:
        """The attractors of each value with their shares of starts."""
        import xarray as xr

        count, along = len(self.series.values), self.series.name
        rows = table["features"].reshape(count, self.starts, len(FEATURES))
        ends = table["end"].reshape(count, self.starts, 4)
        labels = np.array([clusters(row, self.telling) for row in rows])
        variables = {
            "number": variable(along, labels.max(axis=1) + 1, "1", "attractors found"),
            **self.of_attractors(labels, rows, ends),
            "attractor_of": variable(
                (along, "start"), labels, "1", "attractor that the start leads to"
            ),
            "features": variable(
                (along, "start", "feature"), rows, "1", f"what tells responses apart{ABOUT}"
            ),
        }
        found = np.arange(labels.max() + 1)
        coordinates = {
            **self.series.coordinates(),
            **si_state(),
            "attractor": variable("attractor", found, "1", ATTRACTOR),
            "start": variable("start", np.arange(self.starts), "1", "number of the start"),
            "feature": variable("feature", np.array(FEATURES), "1", "feature"),
        }
        title = f"Coexisting attractors along {along}: {self.structure.label()}"
        return xr.Dataset(variables, coordinates, {"title": title})

    def of_attractors(
        self,
        labels: NDArray[np.intp],
        rows: NDArray[np.float64],
        ends: NDArray[np.float64],
    ) -> dict[str, Variable]:
        """Variables along ``attractor``; share 0 and NaN where there are fewer than elsewhere."""
        shape = (len(labels), int(labels.max()) + 1)
        share, about, states = (
            np.zeros(shape),
            np.full((*shape, 3), np.nan),
            np.full((*shape, 4), np.nan),
        )
        for i in range(len(labels)):
            for k, found in enumerate(attractors_of(labels[i], rows[i], ends[i])):
                share[i, k], about[i, k], states[i, k] = found.share, found.about, found.state
        along = (self.series.name, "attractor")
        text = "a state on it at phase 0: x1, x2 in m, v1, v2 in m/s"
        return {
            "share": variable(along, share, "1", "share of the starts"),
            **{
                name: variable(along, about[..., i], "1", OF_ATTRACTORS[name])
                for i, name in enumerate(OF_ATTRACTORS)
            },
            "state": variable((*along, "coordinate"), states, "1", text),
        }


def random_starts(
    count: int, scale: float, seed: tuple[int, int], omega: float
) -> NDArray[np.float64]:
    """Starts in a box.

    Parameters
    ----------
    count : int
    scale : float
        Displacement of mass 1 in +-scale, gap in [0, scale], m; velocity of mass 1 and of the gap
        in +-omega scale, m/s.
    seed : (int, int)
        Of the random numbers: the question's, and the index of the value.
    omega : float

    Returns
    -------
    ndarray, shape (count, 4)
        x1, x2, v1, v2.
    """
    draws = np.random.default_rng(list(seed)).uniform(-scale, scale, (count, 4))
    x1, gap, v1, rate = draws[:, 0], np.abs(draws[:, 1]), draws[:, 2] * omega, draws[:, 3] * omega
    return np.column_stack([x1, x1 + gap, v1, v1 + rate])


def told_apart(**given: Any) -> Telling:
    """What tells responses apart, checked: keywords of :class:`.clusters.Telling`."""
    least = {"transient": 0, "samples": 4, "longest": 0}  # whole numbers
    checked: dict[str, Any] = {
        name: whole(name, value, least[name]) if name in least else positive(name, value)
        for name, value in given.items()
    }
    return Telling(**checked)


def attractors(
    structure: Structure,
    *,
    eta: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    amplitude: ArrayLike | None = None,
    over: str | None = None,
    values: ArrayLike | None = None,
    starts: int = 60,
    seed: int = 0,
    scale: ArrayLike | None = None,
    width: float = 3.0,
    transient: int = 400,
    settle: float = 300.0,
    samples: int = 48,
    converged: float = 1e-6,
    longest: int = 20_000,
    alike: float = 0.02,
    alike_irregular: float = 0.25,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Coexisting attractors: how many, what they are, and how many random starts lead to each.

    Parameters
    ----------
    structure : Structure
    eta : array_like, optional
        Frequency ratios Omega/omega; the box's amplitude is 1/eta^2 m.
    frequency, amplitude : array_like, optional
        The physical form instead: rad/s and m, one amplitude or one for each frequency.
    over : str, optional
        Parameter that takes ``values``; by default what is given as a list.
    values : array_like, optional
    starts, seed : int
        Starts at each value, and seed of their random numbers: the same seed, the same starts.
    scale : array_like, optional
        Half width of the box of starts, m: one, or one for each value. Displacement of mass 1 in
        +-scale, gap in [0, scale], velocity of mass 1 and of the gap in +-omega scale. By default
        ``width`` times the largest gap of the response from rest there.
    width : float
    transient : int
        Periods dropped at least.
    settle : float
        Periods dropped at least, over eta: a slow decay takes time, not periods.
    samples : int
        Periods looked at.
    converged : float
        Relative deviation within which a repeated state decides.
    longest : int
        Periods up to which a response is run on that does not repeat; beyond it is irregular.
    alike, alike_irregular : float
        Relative difference within which responses of the same multiplicity belong to one attractor:
        periodic ones, irregular ones.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over the parameter: ``number``; over ``attractor``, the most frequent one first: ``share``
        of the starts, ``multiplicity``, ``impacts_per_period``, ``xi_rel_max``, and ``state`` on
        it at phase 0 (x1, x2 in m, v1, v2 in m/s); over ``start``: ``attractor_of`` and the
        ``features`` that tell responses apart.

    Raises
    ------
    InputError
        Where the question is not whole, or a number is out of its range.

    Notes
    -----
    The non-unique solutions of the paper's sections 3.2 and 4.1. Responses are told apart by
    multiplicity, impacts per period, largest gap, and mean and deviation of the gap's samples.
    A response is run on until its state repeats within ``converged``: a long transient is none of
    the attractors. What has not repeated after ``longest`` periods is irregular, a torus or chaos;
    how many of these there are depends on ``alike_irregular``. Where an impact falls on the
    sampling phase itself, samples show either side of it, and a periodic response may count as
    irregular.

    Examples
    --------
    >>> from orchestrate.structures import Structure
    >>> from orchestrate.dynamics.attractors import attractors
    >>> found = attractors(Structure.nondimensional(), eta=1.315, starts=40, seed=1)
    >>> found.multiplicity.values[0], found.share.values[0]
    (array([1., 2.]), array([0.95, 0.05]))
    """
    job = AttractorsJob(
        **asked_along(structure, eta, frequency, amplitude, over, values),
        name=f"attractors_{structure.label()}",
        starts=whole("starts", starts, 1),
        seed=whole("seed", seed, 0, 2**32 - 1),
        scale=checked_scale(scale),
        width=positive("width", width),
        telling=told_apart(
            transient=transient,
            settle=settle,
            samples=samples,
            converged=converged,
            longest=longest,
            alike=alike,
            alike_irregular=alike_irregular,
        ),
    )
    return answer(job, running, finder(running))


def checked_scale(given: ArrayLike | None) -> Numbers | None:
    """Half widths above zero.

    Raises
    ------
    InputError
        Where one is not.
    """
    found = numbers("scale", given)
    each = found if isinstance(found, tuple) else () if found is None else (found,)
    wrong = [value for value in each if value <= 0.0]
    if wrong:
        raise InputError(f"scale = {wrong[0]!r}: expected numbers > 0, m")
    return found
