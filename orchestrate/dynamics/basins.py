"""Basins of attraction on a plane of starts: the job and function ``orchestrate.basin``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..constants import TURN
from ..errors import NOT_NUMBERS, InputError
from ..fmu import (
    OSCILLATOR,
    STATE,
    EventInstance,
    Instance,
    make_fmu_finder,
    sample_stroboscopically,
    start_motion,
)
from ..lazy import Unpack, xr
from ..model import Excitation, Structure
from ..model.arguments import checked_integer
from ..model.outcomes import ABSENT
from ..model.ranges import PUSHES
from ..response import questions
from ..response.labels import make_dataset, si_state_coordinate, variable
from ..response.questions import Point, State, checked_state
from ..response.signatures import as_given, question
from ..running.job import FAMILY, Fmus, Table
from ..running.options import Running
from ..running.provenance import describe_dataset
from .attractors import (
    ATTRACTOR,
    COLUMNS,
    attractor_columns,
    attractor_variables,
    attractors,
    settled_table,
)
from .decision import MotionDecider
from .global_continuation import match_attractors, open_instance_pair
from .settling import RUN_LENGTHS, AttractorSettings, ReachedMotion, SettlingSettings

Floats = NDArray[np.float64]
AXES = {  # coordinates of a plane of starts: units, long name
    "x1": ("m", "displacement of mass 1 at the start"),
    "x2": ("m", "displacement of mass 2 at the start"),
    "v1": ("m/s", "velocity of mass 1 at the start"),
    "v2": ("m/s", "velocity of mass 2 at the start"),
    "x_rel": ("m", "gap x2 - x1 + clearance at the start"),
    "v_rel": ("m/s", "velocity of the gap at the start"),
    "phase": ("rad", "phase of the box at the start"),
}
COUNT = 80  # values along its sides
GAPS = {"x_rel": ("x1", "x2"), "v_rel": ("v1", "v2")}


class PlaneAxis(NamedTuple):
    """Axis of a plane of starts: a coordinate's name and its equidistant values."""

    name: str  # of `AXES`
    low: float
    high: float
    number: int

    def values(self) -> Floats:
        return np.linspace(self.low, self.high, self.number)


def starts_of_plane(
    point: Point, x: PlaneAxis, y: PlaneAxis, at: Sequence[float]
) -> tuple[Floats, Floats]:
    """Return the starts of a plane row by row: states, shape (y.number * x.number, 4), and phases.

    ``at`` is the state (m, m/s) that the coordinates are taken from which are not varied.
    """
    ys, xs = (values.ravel() for values in np.meshgrid(y.values(), x.values(), indexing="ij"))
    on_axes, (structure, excitation) = {x.name: xs, y.name: ys}, point
    if not any(at):
        at = (*structure.at_rest, 0.0, 0.0)
    columns = dict(zip(STATE, np.array(at)[:, None] + np.zeros(xs.size), strict=True))
    if structure.wall:
        columns |= {"x2": np.zeros(xs.size), "v2": np.zeros(xs.size)}
    columns |= {name: values for name, values in on_axes.items() if name in STATE}
    offsets = {"x_rel": structure.gap_offset, "v_rel": 0.0}  # of the gap from x2 - x1
    for name in on_axes.keys() & GAPS.keys():
        (first, second), gap = GAPS[name], on_axes[name] - offsets[name]
        if first in on_axes:
            columns[second] = columns[first] + gap
        elif second in on_axes or structure.wall:
            columns[first] = columns[second] - gap
        else:  # the mean of both masses is kept
            middle = 0.5 * (columns[first] + columns[second])
            columns[first], columns[second] = middle - 0.5 * gap, middle + 0.5 * gap
    phases = on_axes.get("phase", np.full(xs.size, excitation.phase))
    return np.column_stack([columns[name] for name in STATE]), phases


class BasinJob(questions.Question):
    """Job of :func:`orchestrate.basin`: all starts on a plane, run until they settle."""

    excitation: Excitation  # its phase is that of all starts where `phase` is not a coordinate
    x: PlaneAxis
    y: PlaneAxis
    known: tuple[tuple[float, ...], ...]  # states on attractors that are known, at phase 0
    settings: SettlingSettings
    replaced: ClassVar[tuple[str, ...]] = (*questions.OF_EXCITATION, *PUSHES, "phase", *RUN_LENGTHS)
    family: ClassVar[tuple[str, ...]] = FAMILY
    chunk_size: ClassVar[int] = 240
    last_item_uses_all: ClassVar[bool] = True
    item: ClassVar[str] = "start"

    def __post_init__(self) -> None:
        super().__post_init__()
        questions.require_delaminated(self.structure)
        states, _ = self.starts()
        if self.structure.wall and states[:, 1::2].any():
            raise InputError(
                "x and y: mass 2 is a wall; expected of x1 and x_rel, v1 and v_rel one"
            )
        if questions.is_outside_gap(states, self.structure).all():
            raise InputError(
                "x and y: the masses overlap at every start; expected some with x2 >= x1"
            )

    def starts(self) -> tuple[Floats, Floats]:
        point = Point(self.structure, self.excitation)
        return starts_of_plane(point, self.x, self.y, self.at)

    def count(self) -> int:
        return self.x.number * self.y.number + 1

    def items(self) -> Sequence[tuple[State, float] | None]:
        states, phases = self.starts()
        return [*zip(map(tuple, states.tolist()), phases.tolist(), strict=True), None]

    def work(self, fmus: Fmus, items: Sequence[Any], previous: Table | None) -> Table:
        """Run starts until they settle (overlapping masses: absent), or group them at the end."""
        point = Point(self.structure, self.excitation.replace(phase=0.0))  # a start has its own
        with open_instance_pair(fmus[OSCILLATOR]) as instances:
            if previous is not None:
                return self.group_starts_into_attractors(instances, point, previous)
            decider = MotionDecider(*instances, point, self.settings)
            reached: list[ReachedMotion | None] = [None] * len(items)
            states = np.array([state for state, _ in items])
            possible = np.flatnonzero(~questions.is_outside_gap(states, self.structure)).tolist()
            starts = [run_to_phase_zero(decider.plain, point, *items[i]) for i in possible]
            for i, each in zip(possible, decider.decide_all(starts), strict=True):
                reached[i] = each
            return settled_table(reached)

    def group_starts_into_attractors(
        self, instances: tuple[Instance, EventInstance | None], point: Point, table: Table
    ) -> Table:
        """Return the attractors, with columns (1, attractors), and the label of each start."""
        there = table["decided"] != ABSENT
        starts = {name: rows[there] for name, rows in table.items()}
        matched = match_attractors(instances, [point], [starts], self.settings, self.known)
        columns = attractor_columns(*matched)
        labels = np.full((1, len(there)), -1, dtype=np.int16)
        labels[0, there] = columns["labels"][0]
        return {**columns, "labels": labels}

    def dataset(self, table: Table) -> xr.Dataset:
        text = "attractor that the start leads to; -1: the masses would overlap"
        sides = (self.y, self.x)
        labels = table["labels"][0].reshape([side.number for side in sides])
        variables = {
            "attractor_of": variable(tuple(side.name for side in sides), labels, "1", text),
            **attractor_variables({name: table[name][0] for name in COLUMNS}, (), "plane"),
        }
        count = len(table["share"][0])
        coordinates = {
            **{side.name: variable(side.name, side.values(), *AXES[side.name]) for side in sides},
            "attractor": variable("attractor", np.arange(count), "1", ATTRACTOR),
            **si_state_coordinate(),
            "eta": variable((), self.excitation.eta(self.structure), "1", "eta (2)"),
        }
        title = f"Basins of attraction: {self.structure.label()}"
        return make_dataset(variables, coordinates, title)


def run_to_phase_zero(instance: Instance, point: Point, state: State, phase: float) -> State:
    left = -phase % TURN
    if left == 0.0:
        return state
    structure, excitation = point
    start_motion(instance, structure, excitation.replace(phase=phase), state)
    instance.step(0.0, left / excitation.frequency)
    return tuple(instance.get(*STATE))


def checked_axis(name: str, argument: Any) -> PlaneAxis:
    expected = f"expected (name, low, high, count) with a name of {', '.join(AXES)}"
    try:
        axis, low, high, count = argument
        low, high = float(low), float(high)
    except NOT_NUMBERS:
        raise InputError(f"{name} = {argument!r}: {expected}") from None
    if axis not in AXES:
        raise InputError(f"{name} = {argument!r}: no coordinate {axis!r}; {expected}")
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise InputError(f"{name} = {argument!r}: expected finite low < high")
    return PlaneAxis(axis, low, high, checked_integer(f"{name}: count", count, 2, 100_000))


@question(BasinJob)
def basin(
    structure: Structure,
    *,
    eta: float | None = None,
    frequency: float | None = None,
    amplitude: float | None = None,
    box_acceleration: float = 0.0,
    force1: float = 0.0,
    force2: float = 0.0,
    x: tuple[str, float, float, int] | None = None,
    y: tuple[str, float, float, int] | None = None,
    at: ArrayLike | xr.Dataset | None = None,
    phase: float = 0.0,
    transient: int = 400,
    settle: float = 300.0,
    samples: int = 48,
    settings: AttractorSettings | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find basins of attraction: the attractor that each start of a plane leads to.

    Parameters
    ----------
    structure : Structure
    eta, frequency, amplitude, box_acceleration, force1, force2
        As in :func:`orchestrate.simulate`.
    x : (str, float, float, int), optional
        A side of the plane: coordinate, its first and last value, and how many. Coordinates are
        ``x1``, ``x2`` in m, ``v1``, ``v2`` in m/s, ``x_rel`` in m, ``v_rel`` in m/s and ``phase``
        in rad. By default 80 values of the gap in which all attractors lie that 24 random starts
        lead to (:func:`orchestrate.attractors`, ``seed=0``), as far as the motions' largest gap.
    y : (str, float, float, int), optional
        The other side. By default 80 values of the gap's velocity in which they lie.
    at : array_like or xarray.Dataset, optional
        x1, x2 in m, v1, v2 in m/s: what the coordinates that are not varied are; of a result of
        :func:`orchestrate.attractors` the mean of its states. Where a gap or its velocity is varied
        alone, the mean of both masses stays that of ``at``. By default rest; where neither side is
        given either, the mean of the attractors' states at phase 0.
    phase
        As in :func:`orchestrate.simulate`.
    transient, settle, samples, settings
        As in :func:`orchestrate.attractors`.
    **running
        ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        ``attractor_of`` over y and x: the number of the attractor; -1 where x2 < x1, which counts
        in no share. Over ``attractor``, numbered by the motions as in
        :func:`orchestrate.attractors`: ``share`` of the plane, 0 where an attractor is known to
        which no start of it leads; ``multiplicity``, ``impacts_per_period``, ``xi_rel_max``,
        ``multiplier``, ``decided_by``, and ``state`` at phase 0 as there.

    Raises
    ------
    InputError
        Where an argument is missing, contradicts another one, or is out of its range.

    Notes
    -----
    A start at another phase is run on to phase 0 first. What a response settles to is decided as
    by :func:`orchestrate.attractors`.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.basins import basin
    >>> plane = {"x": ("x_rel", 0.0, 1.3, 6), "y": ("v_rel", -1.3, 1.3, 6)}
    >>> found = basin(Structure.nondimensional(), eta=1.315, **plane)
    >>> found.attractor_of.dims, found.multiplicity.values.tolist()
    (('v_rel', 'x_rel'), [1.0, 2.0])
    """
    pushes = {"box_acceleration": box_acceleration, "force1": force1, "force2": force2}
    point = questions.checked_point(structure, eta, frequency, amplitude, **pushes)
    lengths = {"transient": transient, "settle": settle, "samples": samples}
    run = SettlingSettings.from_settings(settings, **lengths)
    known: KnownAttractors | None = None
    if x is None or y is None:
        known = find_attractors_from_few_starts(point, run, running)
        if x is None and y is None and at is None:
            at = known.mean
    if hasattr(at, "data_vars"):
        at = mean_attractor_state(at, point.excitation.frequency)  # type: ignore[arg-type]
    sides = (
        known.x if x is None and known else checked_axis("x", x),
        known.y if y is None and known else checked_axis("y", y),
    )
    if sides[0].name == sides[1].name:
        raise InputError(f"x and y: {sides[0].name} twice; expected two coordinates")
    excitation, at = point.excitation.replace(phase=phase), checked_state("at", at, structure)
    fields = {"x": sides[0], "y": sides[1], "at": at, "known": known.states if known else ()}
    return as_given(excitation=excitation, settings=run, **fields)


def mean_attractor_state(result: xr.Dataset, frequency: float) -> Floats:
    """Return the mean of the states of a result of ``attractors``, which is at ``frequency``."""
    over = [name for name in result.get("state", xr.DataArray()).dims if name != "coordinate"]
    several = any(result.sizes[name] > 1 for name in over if name != "attractor")
    if "attractor" not in over or several:
        text = "expected a result of attractors at one frequency"
        raise InputError(f"at: {describe_dataset(result)}; {text}")
    frequency_there = float(np.ravel(result.frequency)[0])
    if not math.isclose(frequency_there, frequency, rel_tol=1e-6):
        text = f"expected those at frequency = {frequency:.6g} rad/s"
        raise InputError(f"at: attractors at {frequency_there:.6g} rad/s; {text}")
    return np.nanmean(result.state.values.reshape(-1, len(STATE)), axis=0)


class KnownAttractors(NamedTuple):
    """Attractors found beforehand, and the plane of starts that is laid out by them."""

    states: tuple[State, ...]  # a state on each at phase 0
    mean: Floats  # of all their states at phase 0
    x: PlaneAxis  # of the gap, twice as wide as the attractors
    y: PlaneAxis  # of its rate


def find_attractors_from_few_starts(
    point: Point, settings: SettlingSettings, running: Mapping[str, Any]
) -> KnownAttractors:
    structure, excitation = point
    box = ("frequency", "amplitude", *PUSHES)
    search: Any = {name: getattr(excitation, name) for name in box} | {"settings": settings}
    search |= {name: getattr(settings, name) for name in RUN_LENGTHS}
    search |= {name: running[name] for name in running.keys() & {"fmu", "build_folder"}}
    known = attractors(structure, starts=24, **search, jobs=1, progress=False).isel(frequency=0)
    states, samples = tuple(map(tuple, known.state.values.tolist())), []
    with Instance(make_fmu_finder(running)(OSCILLATOR).path) as instance:
        for state, n in zip(states, known.multiplicity.values, strict=True):
            start_motion(instance, *point, state)
            periods = int(n) or settings.irregular_samples
            sampled, _ = sample_stroboscopically(instance, excitation.period, 0, periods)
            samples.append(sampled.copy())
    every = np.concatenate(samples)
    gap = float(known.xi_rel_max.max()) * point.displacement_unit or point.displacement_unit
    rate = max(float(np.abs(every[:, 3] - every[:, 2]).max()), excitation.frequency * gap)
    x, y = (float(f"{2.0 * largest:.1e}") for largest in (gap, rate))
    axes = PlaneAxis("x_rel", 0.0, x, COUNT), PlaneAxis("v_rel", -y, y, COUNT)
    return KnownAttractors(states, every.mean(axis=0), *axes)
