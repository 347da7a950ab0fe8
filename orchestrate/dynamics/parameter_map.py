"""Responses over a grid of two parameters: the job and function ``orchestrate.map``.

Points are independent of each other; where attractors coexist a map shows the one that the start
leads to.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import fields
from functools import lru_cache
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..fmu import OSCILLATOR, EventInstance, Instance
from ..lazy import xr
from ..model import PARAMETERS, Structure
from ..model.arguments import Count, Numbers, Positive, Transient, whole
from ..model.outcomes import UNDECIDED
from ..model.spelling import expected_one_of
from ..response import questions
from ..response.labels import column_variables, flags, make_dataset, parameter_variable
from ..response.multiplicity import DECIDED
from ..response.respond import DecidedResponse, decisions_from, responses_from
from ..response.response_loop import LoopSettings, response_loop
from ..response.signatures import as_given, question
from ..response.sweep import HOW_DECIDED
from ..running.job import FAMILY, Chunk, Fmus, Table, to_json_data
from ..running.options import RunOptions
from .impacts_after_transient import simulate_nondimensional_impacts
from .lyapunov import SAYS, WORDS, classify_exponents, exponent_floors, largest_exponent
from .settling import transient_periods

FIELDS = {
    "impacts_per_period": "impacts per excitation period",
    "multiplicity": "excitation periods after which the response repeats; 0: irregular",
    "multiplicity_decided": HOW_DECIDED,
    "xi_rel_max": "largest gap over a eta^2",
    "impulse_max": "largest impulse over m1 omega a eta^2",
}
EXPONENT = {
    "exponent": "largest Lyapunov exponent, per unit of tau",
    "standard_error": "standard error of the exponent",
}


class MapJob(questions.Question):
    """Job of :func:`orchestrate.map`: responses over two parameters, each from the same start."""

    # parameters of the excitation and the structure; two of them are lists
    given: tuple[tuple[str, Numbers], ...]
    replaced: ClassVar[tuple[str, ...]] = (*questions.QUANTITIES, "over", "values")
    family: ClassVar[tuple[str, ...]] = FAMILY
    chunk_size: ClassVar[int] = 120

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self.points  # what is wrong is said before any work

    @property
    def points(self) -> tuple[questions.Point, ...]:
        """Return structure and excitation of all grid points, the second parameter fastest."""
        return map_points(self.structure, self.given)

    @property
    def axes(self) -> dict[str, tuple[float, ...]]:
        """Return the map's two axes, those parameters whose value is a list, and their values."""
        return {name: value for name, value in self.given if isinstance(value, tuple)}

    def parameters(self) -> dict[str, Any]:
        others = super().parameters()
        del others["given"]
        return {**{name: to_json_data(value) for name, value in self.given}, **others}

    def items(self) -> Sequence[questions.Point]:
        return self.points

    def chunks(self) -> list[Chunk]:
        """Split the points into 16 parts at least, so that slow ones are stored soon as well."""
        count = self.count()
        size = min(self.chunk_size, -(-count // 16))
        starts = enumerate(range(0, count, size))
        return [Chunk(i, first, min(first + size, count), None) for i, first in starts]

    def work(self, fmus: Fmus, items: Sequence[questions.Point], previous: Table | None) -> Table:
        """Run points until they are decided, and on for impulses and exponents."""
        rows = []
        with Instance(fmus[OSCILLATOR]) as plain, EventInstance(fmus[OSCILLATOR]) as eventful:
            decided = self.run_until_decided(plain, items)
            for item, (response, decision, rate) in zip(items, decided, strict=True):
                run_on, structure = (eventful, item, response.end), item.structure
                impacts = simulate_nondimensional_impacts(*run_on, self.samples // 2)
                largest = impacts.impulse(structure, item.velocity_unit).max(initial=0.0)
                gap, impulse = response.x_rel_max / item.displacement_unit, largest / structure.m1
                rows.append([rate, *decision, gap, impulse])
                if self.exponent:
                    later = simulate_nondimensional_impacts(*run_on, self.periods)
                    rows[-1] += largest_exponent(later, self.periods, item)
        return {"rows": np.array(rows, dtype=float)}

    def run_until_decided(
        self, instance: Instance, items: Sequence[questions.Point]
    ) -> list[DecidedResponse]:
        """Run points on until their multiplicity is decided; return responses, impacts a period."""
        loop, ends = response_loop(instance), np.tile(self.start, (len(items), 1))
        etas = [item.excitation.eta(item.structure) for item in items]
        dropped = np.array([transient_periods(self.transient, self.settle, eta) for eta in etas])
        done, decided = np.zeros(len(items), dtype=int), {}
        left = np.arange(len(items))
        while len(left):
            points = [items[i] for i in left.tolist()]
            rule: Any = {"samples": self.samples, "tolerance": self.tolerance, "decides": True}
            settings = LoopSettings(transient=dropped[left].tolist(), **rule)
            results = loop.simulate(points, ends[left], settings)
            done[left] += dropped[left] + self.samples
            responses = responses_from(results, points, self.tolerance)
            for i, row in zip(left.tolist(), decisions_from(results, responses), strict=True):
                decided[i] = row
            ends[left] = results.ends
            undecided = np.array([decided[i][1].decided == UNDECIDED for i in left.tolist()])
            left = left[undecided & (done[left] < self.longest)]
            dropped = np.minimum(done, self.longest - done)
        return [decided[i] for i in range(len(items))]

    def dataset(self, table: Table) -> xr.Dataset:
        names, axes = tuple(self.axes), self.axes
        texts = {**FIELDS, **(EXPONENT if self.exponent else {})}
        shape = (-1, *(len(values) for values in axes.values()))
        variables = column_variables(names, texts, table["rows"].T.reshape(shape))
        decided = variables["multiplicity_decided"][1]
        variables["multiplicity_decided"] = flags(names, decided, HOW_DECIDED, DECIDED)
        if self.exponent:
            etas = (point.excitation.eta(point.structure) for point in self.points)
            exponent, error = table["rows"].T[-len(EXPONENT) :]
            verdicts = classify_exponents(exponent, error, exponent_floors(etas, self.periods))
            variables["verdict"] = flags(names, verdicts.reshape(shape[1:]), SAYS, WORDS)
        coordinates = {
            name: parameter_variable(name, name, values) for name, values in axes.items()
        }
        title = f"Map over {' and '.join(names)}: {self.structure.label()}"
        return make_dataset(variables, coordinates, title)


@lru_cache(maxsize=4)
def map_points(
    structure: Structure, arguments: tuple[tuple[str, Numbers], ...]
) -> tuple[questions.Point, ...]:
    """Return all combinations of the two arguments that are lists, the second one fastest."""
    values = dict(arguments)
    questions.require_complete_excitation(values.keys())
    lists = {name: value for name, value in arguments if isinstance(value, tuple)}
    if len(lists) != 2:
        names = ", ".join(lists) or "none"
        raise InputError(f"lists of values: {names}; expected two of the parameters as lists")
    for name, column in lists.items():
        if len(set(column)) < len(column):
            raise InputError(f"{name}: a value twice; expected each once")
    rows = (dict(zip(lists, row, strict=True)) for row in itertools.product(*lists.values()))
    return tuple(questions.make_point(structure, {**values, **row}) for row in rows)


@question(MapJob)
def map(
    structure: Structure,
    *,
    eta: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    amplitude: ArrayLike | None = None,
    level: ArrayLike | None = None,
    box_acceleration: ArrayLike = 0.0,
    force1: ArrayLike = 0.0,
    force2: ArrayLike = 0.0,
    transient: Transient = 300,
    settle: Positive = 300.0,
    samples: Annotated[int, whole(4)] = 60,
    tolerance: Positive = 1e-2,
    longest: Annotated[int, whole(0)] = 20_000,
    start: ArrayLike | None = None,
    exponent: bool = False,
    periods: Count = 500,
    over: str | None = None,
    values: ArrayLike | None = None,
    **others: Any,
) -> xr.Dataset:
    """Compute responses over a grid of two parameters, each from the same start state.

    Parameters
    ----------
    structure : Structure
    eta, frequency, amplitude
        As in :func:`orchestrate.sweep`.
    level : array_like, optional
        In place of the amplitude: peak acceleration a Omega^2 of the box, m/s2.
    box_acceleration, force1, force2
        As in :func:`orchestrate.sweep`, numbers or lists.
    transient, settle
        As in :func:`orchestrate.attractors`.
    samples : int
        Periods kept.
    tolerance
        As in :func:`orchestrate.sweep`.
    longest : int
        Periods up to which a response is run on whose multiplicity is undecided, see
        :func:`orchestrate.sweep`.
    start : array_like of 4 floats, optional
        State at phase 0 that every point starts from: x1, x2 in m, v1, v2 in m/s; at rest by
        default.
    exponent : bool
        Whether to compute the largest Lyapunov exponents too.
    periods : int
        Further periods, over which an exponent is measured.
    over, values
        A parameter of the structure and its values, as in :func:`orchestrate.sweep`; the same as
        a list by its name.
    **others
        Parameters of the structure by name, such as ``e=``, ``D=``, ``k2=``, as numbers or lists;
        and ``jobs``, ``store`` and others, see :class:`orchestrate.running.options.Running`. Of
        all parameters, two must be lists.

    Returns
    -------
    xarray.Dataset
        Over both parameters, the excitation's first: ``impacts_per_period``; ``multiplicity``, 0
        where irregular, and ``multiplicity_decided``, how it was decided; ``xi_rel_max``;
        ``impulse_max``, the largest impulse over m1 omega a eta^2 in half the periods kept; and
        where asked for ``exponent`` per unit of tau, with its ``standard_error``, NaN where there
        are too few impacts, and its ``verdict`` as of :func:`orchestrate.lyapunov`.

    Raises
    ------
    InputError
        Where an argument is missing, contradicts another one, or is out of its range.

    Notes
    -----
    An impulse follows from its closing velocity by (15). Where attractors coexist a map shows the
    one that the start leads to, see :func:`orchestrate.attractors`.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.parameter_map import map
    >>> found = map(Structure.nondimensional(), eta=[0.4, 1.047], e=[0.3, 0.7])
    >>> found.impacts_per_period.values.tolist()
    [[9.0, 30.0], [2.0, 2.0]]
    """
    running = {name: value for name, value in others.items() if name not in PARAMETERS}
    options = [field.name for field in fields(RunOptions)]
    for name in running:
        if name not in options:
            raise InputError(
                f"{name}: no parameter; {expected_one_of(name, (*PARAMETERS, *options))}"
            )
    if (over is None) != (values is None) or over in others:
        raise InputError("over and values: expected both or none, and over= not by its name too")
    others = others if over is None else {**others, over: values}
    box = {"eta": eta, "frequency": frequency, "amplitude": amplitude, "level": level}
    pushes = {"box_acceleration": box_acceleration, "force1": force1, "force2": force2}
    pushed = {name: value for name, value in pushes.items() if not np.array_equal(value, 0.0)}
    every: dict[str, Any] = {**box, **pushed, **others}
    numbers = {
        n: questions.checked_excitation_numbers(n, value)
        for n, value in every.items()
        if n not in running
    }
    given = tuple((name, value) for name, value in numbers.items() if value is not None)
    start = questions.checked_state("start", start, questions.checked_structure(structure))
    return as_given(given=given, start=start, running=running)
