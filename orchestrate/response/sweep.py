"""Sweeps (orbit diagrams), ``orchestrate.sweep``: the job and the columns of its result and CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..fmu import OSCILLATOR, Instance, gaps_of_states
from ..fmu.oscillator import PEAKS
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Positive, Transient
from ..running.array_blocks import lazy_array_of_rows
from ..running.job import FAMILY, Table
from ..running.options import Running
from ..running.store import StoredRows
from . import labels
from .multiplicity import DECIDED
from .questions import Point, StartedSeriesQuestion, Values
from .response_loop import LoopSettings, response_loop
from .signatures import as_given, question

Direction = Literal["up", "down", "both", "given"]
DISTANCE = "largest distance of mass {} from the box's middle, its rest under a preload included"
RESPONSE_QUANTITIES = {  # one a response: units, long name
    "xi_rel_max": ("1", "largest gap over the sampled periods, between samples too"),
    "impacts_per_period": (
        "1",
        "impacts per excitation period: exact where the response repeats, else mean over samples",
    ),
    "x1_max": ("m", DISTANCE.format(1)),
    "x2_max": ("m", DISTANCE.format(2)),
    "xi1_max": ("1", f"{DISTANCE.format(1)}, over a eta^2"),
    "xi2_max": ("1", f"{DISTANCE.format(2)}, over a eta^2"),
    "a1_max": ("m/s2", "largest absolute acceleration of mass 1 between impacts"),
    "a2_max": ("m/s2", "largest absolute acceleration of mass 2 between impacts"),
}
END = "state at the last sample, from which the next value starts"
MULTIPLICITY = "least n such that the state repeats after n periods; 0: none"
HOW_DECIDED = "how the multiplicity was decided; where it is undecided it is a guess"


class SweepJob(StartedSeriesQuestion):
    """Job of :func:`orchestrate.sweep`: responses along one parameter, up, down or both."""

    family: ClassVar[tuple[str, ...]] = FAMILY
    chunk_size: ClassVar[int] = 100
    in_threads: ClassVar[bool] = True
    bulk: ClassVar[tuple[str, ...]] = ("gap",)
    sequential: ClassVar[bool] = True
    warmup_items: ClassVar[int] = 16  # most responses forget where they came from within as many

    def __post_init__(self) -> None:
        super().__post_init__()
        values, name = self.series.values, self.series.name
        if self.direction != "given" and len(set(values)) < len(values):
            twice = next(value for value in values if values.count(value) > 1)
            text = "expected each value once, or direction='given'"
            raise InputError(f"{name}: {twice!r} twice; {text}")

    def answering_job(self) -> SweepJob:
        """Return the job; that of values that do not depend on another if each has its start."""
        if len(self.start) == len(labels.COORDINATES):
            return self
        starts = np.reshape(self.start, (-1, len(labels.COORDINATES)))
        return IndependentStartsJob(**vars(self) | {"direction": "given", "start": starts})

    def computing_orders(self) -> list[NDArray[np.intp]]:
        """Return the indices of the values in the order of computing, one array a direction."""
        up = np.argsort(self.series.values, kind="stable")
        known = {"up": [up], "down": [up[::-1]], "both": [up, up[::-1]]}
        return known.get(self.direction) or [np.arange(len(up))]

    def count_independent_series(self) -> int:
        return len(self.computing_orders())

    def count(self) -> int:
        return self.count_independent_series() * super().count()

    def items(self) -> Sequence[Point]:
        return self.series.points.select(np.concatenate(self.computing_orders()))

    def work(
        self, fmus: Mapping[str, Path], items: Sequence[Point], previous: Table | None
    ) -> Table:
        start, offset = self.start, self.structure.gap_offset
        if previous is not None:
            start, offset = previous["end"][-1], float(previous["gap_offset"][-1])
        return self.compute_table(fmus, items, [start], is_chain=True, chain_gap=offset)

    def compute_table(
        self, fmus: Mapping[str, Path], points: Sequence[Point], starts: ArrayLike, **chain: Any
    ) -> Table:
        names = ("transient", "samples", "tolerance", "peak_periods")
        arguments: Any = {name: getattr(self, name) for name in names}
        settings = LoopSettings(**arguments, decides=True, **chain)
        with Instance(fmus[OSCILLATOR]) as instance:
            results = response_loop(instance).simulate(points, starts, settings)
        offsets = np.array([point.structure.gap_offset for point in points])
        return {
            "gap": gaps_of_states(results.states, offsets.repeat(self.samples)),
            "gap_offset": offsets,
            "x_rel_max": results.x_rel_max,
            "impacts_per_period": results.impacts,
            "permanent_contact": results.permanent_contact,
            **{name: results.counts[name] for name in ("multiplicity", "decided")},
            "end": results.ends,
            **dict(zip(PEAKS, results.peaks.T, strict=True)),
        }

    def boundary_state(self, table: Table) -> bytes:
        return bytes(table["end"][-1].tobytes())

    def dataset(self, table: Table) -> xr.Dataset:
        reorder = {"gap": self.reorder_gaps}
        del table["gap_offset"]  # what a next chunk needed
        # each column leaves the table: of a long sweep there is no room for two
        ordered = {name: reorder.get(name, self.reorder_rows)(table.pop(name)) for name in [*table]}
        title = f"Responses along {self.series.name}, {self.direction}: {self.structure.label()}"
        return labels.make_dataset(self.variables(ordered), self.coordinates(), title)

    def reorder_rows(self, values: NDArray[np.generic]) -> NDArray[np.generic]:
        """Reorder rows from computing order to the values' order, (direction, value) if both."""
        orders = self.computing_orders()
        rows = values.reshape(len(orders), -1, *values.shape[1:])
        ordered = np.empty_like(rows)
        for index, order in enumerate(orders):
            ordered[index, order] = rows[index]
        return ordered if self.direction == "both" else ordered[0]

    def reorder_gaps(self, gaps: NDArray[np.float64] | StoredRows) -> Any:
        """Return the samples of the gap over a eta^2 in the values' order, lazily if stored."""
        length = self.series.displacement_and_velocity_units[:, :1]
        if isinstance(gaps, np.ndarray):
            return np.asarray(self.reorder_rows(gaps), dtype=float) / length
        numbers = self.reorder_rows(np.arange(gaps.shape[0], dtype=np.intp))
        source = numbers.ravel().view(np.intp)

        def read(rows: NDArray[np.intp]) -> NDArray[np.float64]:
            return gaps.read_rows(source[rows]) / length[rows % len(length)]

        return lazy_array_of_rows(numbers.shape, gaps.shape[1], read)

    def variables(self, table: Table) -> dict[str, labels.Variable]:
        along = (*(("direction",) if self.direction == "both" else ()), self.series.name)
        text = "stroboscopic samples of the gap xi_2 - xi_1 (21)"
        units, end = self.series.displacement_and_velocity_units, table["end"]
        end[..., :2] /= units[:, :1]  # in place, of a long sweep
        end[..., 2:] /= units[:, 1:]
        return {
            "xi_rel": labels.variable((*along, "sample"), table["gap"], "1", text),
            **response_variables(along, table, units[:, 0], RESPONSE_QUANTITIES),
            "end_state": labels.variable((*along, "coordinate"), end, "1", END),
        }

    def coordinates(self) -> dict[str, labels.Variable]:
        numbers = self.transient + np.arange(1, self.samples + 1)
        coordinates = {
            **self.series.coordinates(),
            **labels.nondimensional_state_coordinate(),
            "sample": labels.variable("sample", numbers, "1", "excitation period n of the sample"),
        }
        if self.direction == "both":
            words, text = np.array(["up", "down"]), "order in which the values were computed"
            coordinates["direction"] = labels.variable("direction", words, "1", text)
        return coordinates


class IndependentStartsJob(SweepJob):
    """Job of :func:`orchestrate.sweep` from another sweep: each value has a start of its own."""

    chunk_size: ClassVar[int] = 20
    sequential: ClassVar[bool] = False
    warmup_items: ClassVar[int] = 0

    def items(self) -> Sequence[Any]:
        points = self.series.points
        states = np.broadcast_to(np.reshape(self.start, (-1, 4)), (len(points), 4))
        return list(zip(points, map(tuple, states.tolist()), strict=True))

    def work(self, fmus: Mapping[str, Path], items: Sequence[Any], previous: Table | None) -> Table:
        points, starts = zip(*items, strict=True)
        return self.compute_table(fmus, points, starts)


def response_variables(
    along: labels.Dims, table: Table, length: NDArray[np.float64], quantities: Mapping[str, Any]
) -> dict[str, labels.Variable]:
    """Return the variables of responses: those asked for, contact, multiplicity and how decided."""
    names = {"xi_rel_max": "x_rel_max", "xi1_max": "x1_max", "xi2_max": "x2_max"}
    numbers = {**table, **{xi: table[x] / length for xi, x in names.items()}}
    contact = "whether permanent contact occurs in the sampled periods"
    return {
        **{name: labels.variable(along, numbers[name], *quantities[name]) for name in quantities},
        "permanent_contact": labels.yes_or_no(along, table["permanent_contact"], contact),
        "multiplicity": labels.variable(along, table["multiplicity"], "1", MULTIPLICITY),
        "multiplicity_decided": labels.flags(along, table["decided"], HOW_DECIDED, DECIDED),
    }


@question(SweepJob)
def sweep(
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
    direction: Direction = "up",
    transient: Transient = 500,
    samples: Count = 200,
    tolerance: Positive = 1e-2,
    start: ArrayLike | xr.Dataset | None = None,
    peak_periods: Count = 8,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Compute responses along a parameter, each started from the end state of the one before.

    Parameters
    ----------
    structure : Structure
    eta : array_like, optional
        Frequency ratios Omega/omega; the box's amplitude is 1/eta^2 m, so that xi of (3) is x in m.
    frequency, amplitude : array_like, optional
        The physical form instead: rad/s and m, one amplitude or one for each frequency.
    box_acceleration : array_like, optional
        Constant acceleration of the box, added to its own, m/s2: gravity. One number or one
        for each frequency, as forces.
    force1, force2 : array_like, optional
        Amplitudes F of harmonic forces F sin(phase) on the masses, N. With forces the amplitude may
        be 0: xi then counts in units of the largest static displacement by what pushes.
    over : str, optional
        Parameter that takes ``values``, such as ``"e"``, ``"D"``, ``"k2"``, ``"amplitude"``; by
        default what is given as a list.
    values : array_like, optional
        Its values.
    direction : {"up", "down", "both", "given"}
        Order in which the values are computed; the result keeps the order in which they were
        given. ``"both"`` computes them upwards and downwards and adds a dimension ``direction``.
    transient : int
        Periods dropped at each value.
    samples : int
        Periods kept after them, a stroboscopic sample each.
    tolerance : float
        Part of the motion's size within which a state counts as repeated.
    start : array_like or xarray.Dataset, optional
        State that the first value starts from, at phase 0: x1, x2 in m, v1, v2 in m/s; at rest
        by default. Or one state for each value, or a sweep over the same values in one direction,
        whose responses are run on: then no value depends on another, whatever the ``direction``.
    peak_periods : int
        Amplitudes and accelerations are looked for over the periods after which the response
        repeats, at most so many; over half as many where it does not repeat.
    **running
        ``jobs``, ``cluster``, ``progress``, ``store`` and others, see
        :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over the parameter, and ``sample`` and ``direction``: ``xi_rel``, stroboscopic samples of
        the gap over a eta^2 (21); ``xi_rel_max``; ``impacts_per_period``; ``multiplicity`` in
        excitation periods, 0 where the response does not repeat, and ``multiplicity_decided``, how
        it was decided: repeated, irregular or undecided; ``permanent_contact``;
        ``end_state``, the non-dimensional state at the last sample, at phase 0, from which the next
        value starts; largest distances of both masses from the
        box's middle, ``x1_max`` and ``x2_max`` in m, ``xi1_max`` and ``xi2_max`` over a eta^2; and
        ``a1_max``, ``a2_max``, the largest absolute accelerations in m/s2, which an accelerometer
        on a mass reads between impacts.

    Raises
    ------
    InputError
        Where a required argument is missing, arguments contradict each other, or a number is
        out of its range.

    Notes
    -----
    The paper's section 3.1 and Figures 6, 10 and 11. Samples, impacts, the largest gap, amplitudes
    and accelerations come from the FMU's closed form and are exact to rounding.

    A response has *repeated* where states ``multiplicity`` periods apart agree within the
    tolerance, and their deviation has died or dies. It is *undecided* where it nearly repeats: it
    converges too slowly to tell, next to a period doubling for instance, or it is a torus or a
    chaotic band narrower than the tolerance; ``multiplicity`` is then the best guess, and a longer
    ``transient`` decides. The tolerance does not hide a period doubling: one of any width above
    1e-9 counts once the response has converged. Lengths are compared with the largest displacement
    or velocity over the frequency, and the gap with the largest gap.

    Impacts of a response that has repeated are counted over its own period, those of others over
    the samples.

    Each value starts from the state at the last sample of the one before, rounded to 44 bits, 13
    digits: what has converged to one response then comes to the very same numbers, whatever
    rounding it was reached with. So parts of a sweep that are computed elsewhere, begun a few
    values early from rest, join it, and all cores work on one sweep.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.response.sweep import sweep
    >>> found = sweep(Structure.nondimensional(), eta=[1.046, 1.047], transient=100, samples=40)
    >>> found.xi_rel_max.values.round(2)
    array([21.21, 21.56])
    >>> found = sweep(Structure(), over="e", values=[0.3, 0.7], eta=0.4, transient=50)
    >>> found.impacts_per_period.values
    array([ 9., 30.])
    """
    return as_given(f"_{direction}")
