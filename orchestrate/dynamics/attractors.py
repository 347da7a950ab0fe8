"""Find coexisting attractors from random starts: the job and ``orchestrate.attractors``."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..fmu import OSCILLATOR, REST, EventInstance, Instance, sample_evenly, start_motion
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Numbers, Positive, checked_numbers, whole
from ..model.outcomes import ABSENT, WORDS
from ..response.labels import Variable, flags, make_dataset, si_state_coordinate, variable
from ..response.questions import SeriesQuestion, Values, require_delaminated
from ..response.signatures import as_given, question
from ..running.job import FAMILY, Fmus, Table
from ..running.options import Running
from .clusters import FEATURES
from .decision import MotionDecider
from .global_continuation import match_attractors, open_instance_pair
from .settled_motion import Floats, SettledMotion
from .settling import (
    RUN_LENGTHS,
    AttractorSettings,
    ReachedMotion,
    SettledResponse,
    SettlingSettings,
    run_until_settled,
)

ATTRACTOR = "attractor: periodic first, then by periods, impacts per period, largest gap"
OF_ATTRACTORS = {
    "multiplicity": "excitation periods after which it repeats; 0: irregular",
    "impacts_per_period": "impacts per excitation period",
    "xi_rel_max": "largest gap over a eta^2",
}
MULTIPLIER = "largest absolute value of the orbit's Floquet multipliers"
DECIDED_BY = (
    "how it was decided: by a stable orbit of Newton's method; by states that repeat; irregular; "
    "undecided: states repeat nearly, near an unstable orbit or before impacts that have to come, "
    "or other starts still leave such an irregular motion"
)
LARGEST = 1e24  # m, of a box of starts
SETTLED_TO = (
    "what responses have settled to; mean and deviation are those of the samples of the gap"
)
COLUMNS = (*OF_ATTRACTORS, "multiplier", "how", "share", "state")


def checked_half_widths(name: str, value: ArrayLike | None) -> Numbers | None:
    """Return the user's half width(s) of the box of starts, m, or None; raise unless positive."""
    scale = checked_numbers(name, value)
    for width in scale if isinstance(scale, tuple) else (scale,):
        if width is not None and width <= 0.0:
            raise InputError(f"{name} = {width!r}: expected numbers > 0, m")
    return scale


class AttractorsJob(SeriesQuestion):
    """Job of :func:`orchestrate.attractors`: random starts at each value of a parameter."""

    settings: SettlingSettings
    replaced: ClassVar[tuple[str, ...]] = RUN_LENGTHS
    family: ClassVar[tuple[str, ...]] = FAMILY
    chunk_size: ClassVar[int] = 240
    last_item_uses_all: ClassVar[bool] = True
    item: ClassVar[str] = "start"

    def __post_init__(self) -> None:
        super().__post_init__()
        for point in self.series.points:
            require_delaminated(point.structure)
        if isinstance(self.scale, tuple) and len(self.scale) != len(self.series.values):
            raise InputError(
                f"scale: {len(self.scale)} values for {len(self.series.values)} of "
                f"{self.series.name}; expected one number or one for each"
            )

    def count(self) -> int:
        return self.starts * super().count() + 1

    def items(self) -> Sequence[tuple[int, int] | None]:
        return [*itertools.product(range(len(self.series.points)), range(self.starts)), None]

    def progress_note(self, first: int) -> str:
        return "attractors at neighbours" if first == self.count() - 1 else ""

    def work(self, fmus: Fmus, items: Sequence[Any], previous: Table | None) -> Table:
        """Run starts until they settle, a row each; at the last item group them to attractors."""
        with open_instance_pair(fmus[OSCILLATOR]) as instances:
            if previous is not None:
                return self.group_starts_into_attractors(instances, previous)
            reached = list[ReachedMotion]()
            for index, group in itertools.groupby(items, lambda item: item[0]):
                decider = MotionDecider(*instances, self.series.points[index], self.settings)
                starts = self.draw_starts(decider, index)
                reached += decider.decide_all(starts[[number for _, number in group]])
            return settled_table(reached)

    def draw_starts(self, decider: MotionDecider, value_index: int) -> Floats:
        """Draw the random starts at one value: from a box around rest, half of them without
        ``scale`` from one around the response from rest.
        """
        (structure, excitation), seed = decider.point, (self.seed, value_index)
        if self.scale is not None:
            scale = self.scale[value_index] if isinstance(self.scale, tuple) else self.scale
            return draw_starts_around_rest(self.starts, scale, seed, structure)
        (settled,) = run_until_settled(decider.plain, decider.point, REST, self.settings)
        assert isinstance(settled, SettledResponse), "no motion is known"
        largest_gap = settled.response.x_rel_max or decider.point.displacement_unit
        states = draw_starts_around_rest(self.starts, self.width * largest_gap, seed, structure)
        state, frequency = settled.response.end, excitation.frequency
        start_motion(decider.plain, structure, excitation, state)
        samples = sample_evenly(decider.plain, 0.0, 8 * excitation.period, 512)
        # of the largest displacement, and of the largest gap, of the response from rest
        around, gap = 0.7 * float(np.abs(samples[:, :2]).max()), 3.0 * largest_gap
        draws = np.random.default_rng([*seed, 1]).uniform(-1.0, 1.0, (self.starts, 4))
        x1, v1 = state[0] + around * draws[:, 0], state[2] + frequency * around * draws[:, 2]
        gaps, gap_rates = gap * np.abs(draws[:, 1]), frequency * gap * draws[:, 3]
        states[1::2] = starts_from_gap(structure, x1, gaps, v1, gap_rates)[1::2]
        return states

    def group_starts_into_attractors(
        self, instances: tuple[Instance, EventInstance | None], table: Table
    ) -> Table:
        """Return the attractors, with columns (1, values, attractors), of the settled starts."""
        # sorted, so that neighbours are adjacent
        points, order = self.series.points, np.argsort(self.series.values, kind="stable")
        starts = {n: np.split(rows, len(points)) for n, rows in table.items()}
        settled = [{name: rows[i] for name, rows in starts.items()} for i in order]
        ordered = [points[i] for i in order]
        columns = attractor_columns(*match_attractors(instances, ordered, settled, self.settings))
        return {name: rows[np.newaxis, np.argsort(order)] for name, rows in columns.items()}

    def dataset(self, table: Table) -> xr.Dataset:
        along, values = self.series.name, np.array(self.series.values)
        rows = table["features"].reshape(len(values), self.starts, len(FEATURES))
        exists = table["how"][0] != ABSENT
        first = np.where(exists, values[:, np.newaxis], np.inf).min(axis=0)
        last = np.where(exists, values[:, np.newaxis], -np.inf).max(axis=0)
        unit = self.series.coordinates()[along][2]["units"]
        range_of = f"{along} at which the attractor has been found"
        text = "attractor that the start leads to"
        variables = {
            "number": variable(along, exists.sum(axis=1), "1", "attractors found"),
            **attractor_variables({name: table[name][0] for name in COLUMNS}, (along,), "starts"),
            "first_found": variable("attractor", first, unit, f"smallest {range_of}"),
            "last_found": variable("attractor", last, unit, f"largest {range_of}"),
            "attractor_of": variable((along, "start"), table["labels"][0], "1", text),
            "features": variable((along, "start", "feature"), rows, "1", SETTLED_TO),
        }
        coordinates = {
            **self.series.coordinates(),
            **si_state_coordinate(),
            "attractor": variable("attractor", np.arange(exists.shape[1]), "1", ATTRACTOR),
            "start": variable("start", np.arange(self.starts), "1", "number of the start"),
            "feature": variable("feature", np.array(FEATURES), "1", "feature"),
        }
        title = f"Coexisting attractors along {along}: {self.structure.label()}"
        return make_dataset(variables, coordinates, title)


def settled_table(reached: Sequence[ReachedMotion | None]) -> Table:
    """Return each start's features, a state at phase 0, how and when; None: the masses overlap."""
    absent = np.full(len(FEATURES), np.nan), np.full(4, np.nan), ABSENT, 0
    rows = [
        (each.motion.features, each.state, each.motion.decided, each.periods) if each else absent
        for each in reached
    ]
    features, ends, decided, periods = zip(*rows, strict=True)
    columns = {"features": np.array(features, dtype=float), "end": np.array(ends, dtype=float)}
    return {**columns, "decided": np.array(decided, dtype=np.int8), "periods": np.array(periods)}


def attractor_columns(
    motions: Sequence[Sequence[SettledMotion]],
    numbers: Sequence[Sequence[int]],
    labels: Sequence[NDArray[np.intp]],
) -> Table:
    """Return matched attractors as arrays (values, attractors), NaN where one is absent."""
    shape = len(motions), 1 + max(map(max, numbers))
    columns: Table = {name: np.full(shape, np.nan) for name in (*OF_ATTRACTORS, "multiplier")}
    columns |= {"how": np.full(shape, ABSENT, dtype=np.int8), "share": np.zeros(shape)}
    columns["state"] = np.full((*shape, 4), np.nan)
    for i, (numbers_here, labels_here) in enumerate(zip(numbers, labels, strict=True)):
        for number, motion in zip(numbers_here, motions[i], strict=True):
            row = dict(zip(OF_ATTRACTORS, motion.features[:3], strict=True))
            row |= {"multiplier": motion.multiplier, "how": motion.decided}
            if len(labels_here):
                row["share"] = np.mean(labels_here == number)
            for name, value in {**row, "state": motion.state_of_least_x1}.items():
                columns[name][i, number] = value
    return {**columns, "labels": np.array(labels)}


def attractor_variables(
    columns: Mapping[str, Any], along: tuple[str, ...], share_of: str
) -> dict[str, Variable]:
    dims = (*along, "attractor")
    text = "a state at phase 0, of a periodic one the least x1: x1, x2 in m, v1, v2 in m/s"
    return {
        "share": variable(dims, columns["share"], "1", f"share of the {share_of}"),
        **{name: variable(dims, columns[name], "1", OF_ATTRACTORS[name]) for name in OF_ATTRACTORS},
        "multiplier": variable(dims, columns["multiplier"], "1", MULTIPLIER),
        "decided_by": flags(dims, columns["how"], DECIDED_BY, WORDS),
        "state": variable((*dims, "coordinate"), columns["state"], "1", text),
    }


def draw_starts_around_rest(
    count: int, scale: float, seed: tuple[int, int], structure: Structure
) -> Floats:
    """Draw ``count`` states, shape (count, 4), uniformly from a box around rest, gap >= 0."""
    if not scale <= LARGEST:
        expected = f"expected at most {LARGEST:g} m, by scale or width"
        raise InputError(f"starts in +-{scale:g} m: {expected}")
    draws = np.random.default_rng(list(seed)).uniform(-scale, scale, (count, 4))
    omega, x1, gap = structure.omega, draws[:, 0] + structure.at_rest[0], np.abs(draws[:, 1])
    v1, gap_rate = draws[:, 2] * omega, draws[:, 3] * omega
    return starts_from_gap(structure, x1, gap, v1, gap_rate)


def starts_from_gap(
    structure: Structure, x1: Floats, gap: Floats, v1: Floats, gap_rate: Floats
) -> Floats:
    """Return start states by mass 1 and the gap: inside the stroke, and with mass 2 at a wall."""
    if structure.stroke:
        gap = np.mod(gap, structure.stroke)
    if structure.wall:
        x1, gap_rate = structure.gap_offset - gap, -v1
    x2 = x1 + gap - structure.gap_offset
    return np.column_stack([x1, 0.0 * x2 if structure.wall else x2, v1, v1 + gap_rate])


@question(AttractorsJob)
def attractors(
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
    starts: Annotated[int | None, whole(1)] = None,
    seed: Annotated[int, whole(0, 2**32 - 1)] = 0,
    scale: Annotated[ArrayLike | None, checked_half_widths] = None,
    width: Positive = 3.0,
    transient: int = 400,
    settle: float = 300.0,
    samples: int = 48,
    settings: AttractorSettings | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find coexisting attractors from random starts, and the share of starts that each attracts.

    Parameters
    ----------
    structure : Structure
    eta, frequency, amplitude, box_acceleration, force1, force2, over, values
        As in :func:`orchestrate.sweep`.
    starts : int, optional
        Random starts at each value: by default 60, and 600 if there is only one value.
    seed : int
        Of their random numbers: the same seed, the same starts.
    scale : array_like, optional
        Half width of the box of starts, m: one, or one for each value. Displacement of mass 1 in
        +-scale, gap in [0, scale], velocity of mass 1 and of the gap in +-omega scale. By default
        there are two boxes, for every other start each: this one with ``width`` times the largest
        gap G of the response from rest; and one around that response, displacement and velocity
        (over Omega) of mass 1 within 0.7 of its largest displacement, gap in [0, 3 G] and gap
        rate in +-3 G Omega.
    width : float
        Half width of that box over the largest gap from rest, where there is no ``scale``.
    transient : int
        Periods dropped at least.
    settle : float
        Periods dropped at least, over eta: a slow decay takes time, not periods. By default a decay
        e^{-D tau} with D = 0.005 lasts for a factor of ten thousand.
    samples : int
        Periods kept: more where attractors repeat after more than half as many.
    settings : AttractorSettings, optional
        Thresholds of the rule that decides: those of
        :class:`orchestrate.dynamics.settling.AttractorSettings` by default.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Over the parameter: ``number``; over ``attractor``, where one number is the same attractor
        at all values, given at the lowest one that has it: periodic before irregular ones, then by
        ``multiplicity``, ``impacts_per_period`` and ``xi_rel_max``, which are NaN where it does not
        exist; ``share`` of the random starts, 0 if only carrying has found it; ``multiplier``,
        the largest absolute Floquet multiplier; ``decided_by``, as CF flags: ``orbit`` (a stable
        orbit of Newton's method), ``repeated`` (states repeat, Newton's method finds no orbit),
        ``irregular`` or ``undecided`` (states nearly repeat, near an unstable orbit, or before
        impacts that have to come at this level; or irregular motion that other starts leave only
        after half of ``longest``), ``absent``; ``state`` at phase 0 (x1, x2 in m, v1,
        v2 in m/s), of a periodic one that with the smallest x1; ``first_found``, ``last_found``,
        between which values it is there. Over ``start``: ``attractor_of`` and the ``features`` of
        what a start has settled to.

    Raises
    ------
    InputError
        Where an argument is missing, contradicts another one, or is out of its range.

    Notes
    -----
    The non-unique solutions of the paper's sections 3.2 and 4.1. A response is run on until its
    state repeats within ``converged``. Its impacts over just these periods are what Newton's method
    begins with (:func:`orchestrate.orbit`); the response is on the orbit found if that is a
    possible motion, if the FMU repeats it with the same impacts, if its multipliers lie inside the
    unit circle, and if the response comes nearer to it as they say. So multiplicity and impacts are
    those of the orbit, and two attractors are two orbits. What has not repeated after ``longest``
    periods is irregular, a torus or chaos; how many of these there are depends on
    ``alike_irregular``. An FMU of FMI 2.0 reports no impacts: there states that repeat decide.

    Global continuation (Datseris, Rossi and Wagemakers, Chaos 33, 073151, 2023): every attractor
    is carried to both neighbouring values, its state as a further start, or its orbit by Newton's
    method where the state leads elsewhere. Attractors of neighbours are one where each leads to the
    other, or where the orbit is followed.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.attractors import attractors
    >>> found = attractors(Structure.nondimensional(), eta=1.315, starts=40, seed=1)
    >>> found.multiplicity.values[0], found.share.values[0]
    (array([1., 2.]), array([0.825, 0.175]))
    """
    if starts is None:
        along = {"eta": eta, "frequency": frequency, "amplitude": amplitude, "values": values}
        series = (checked_numbers(*each) for each in along.items())
        several = any(isinstance(each, tuple) and len(each) > 1 for each in series)
        starts = 60 if several else 600
    lengths = {"transient": transient, "settle": settle, "samples": samples}
    return as_given(starts=starts, settings=SettlingSettings.from_settings(settings, **lengths))
