"""Bifurcations followed over two parameters: the job and function ``orchestrate.border``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..errors import NOT_NUMBERS, InputError
from ..flags import flag_word
from ..fmu import OSCILLATOR, EventInstance
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Number, checked_texts
from ..response.labels import variable
from ..response.questions import EXCITATION_PARAMETERS, OF_EXCITATION, Question, require_delaminated
from ..response.signatures import as_given, question
from ..running.job import FAMILY, Fmus, Table
from ..running.options import Running
from . import branches
from .bifurcation_curve import BifurcationCurve, BifurcationTracer
from .bifurcation_kinds import KINDS, Kind
from .codimension_two import (
    POINT_KINDS,
    CodimensionTwoPoint,
    locate_codimension_two_points,
)
from .continuation import SOLVER_ERRORS, ArclengthStepper, Root, newton_correct, unit_vector
from .families import Family, Setting, require_known_parameters
from .orbit_records import branch_dataset, branch_table, located_variables, orbit_row
from .orbit_tracer import OrbitPoint
from .orbits import FirstGuess, call_text_from_start, excitation_arguments

POINT = "codimension_two"
RESIDUAL = "what is left of both conditions, of the multipliers' polynomial over its largest part"
KEPT = ("state", "xi", "multipliers", *branches.NODES)  # of orbits: variables of those points too


class BorderJob(Question):
    """Job of :func:`orchestrate.border`: one bifurcation followed over two parameters."""

    family: ClassVar[tuple[str, ...]] = FAMILY
    setting: Setting  # the two parameters and their limits
    start: FirstGuess  # nodes of the orbit at the bifurcation
    period: int
    kind: int
    values: tuple[float, float]  # of the parameters there
    replaced: ClassVar[tuple[str, ...]] = (*OF_EXCITATION, *branches.OF_SETTING, "bifurcation")
    item_columns: ClassVar[tuple[str, ...]] = ()  # points of the curve

    def format_call(self) -> str:
        keywords = {"over": self.setting.over, "limits": self.setting.limits}
        more = {"longest": self.longest, "most": self.most}
        values, kind = np.array(self.values), KINDS[self.kind]
        return call_text_from_start(self, values, bifurcation=kind, **keywords, **more)

    def work(self, fmus: Fmus, items: Sequence[int], previous: Table | None) -> Table:
        curve, start = solve_start_on_curve(self)
        steppers = (
            ArclengthStepper.at_start(curve, root, self.longest)
            for root in (start.reversed(), start)
        )
        back, forth = (
            BifurcationTracer(stepper, self.most).trace(stepper.root) for stepper in steppers
        )
        roots = [*reversed(back.points[1:]), *forth.points]
        points = locate_codimension_two_points(curve, roots, (back.end, forth.end))
        with EventInstance(fmus[OSCILLATOR]) as instance:
            solved: list[Root | CodimensionTwoPoint] = [*roots, *points]
            rows = [orbit_row(instance, curve.family, s.unknowns, s.residual) for s in solved]
        angles = [root.unknowns[-1] if self.kind == Kind.TORUS else np.nan for root in roots]
        more = {"angle": np.array(angles), "ends": np.array([back.end, forth.end])}
        return {**branch_table(rows, POINT, points), **more}

    def dataset(self, table: Table) -> xr.Dataset:
        setting, kind = self.setting, KINDS[self.kind]
        title = f"{kind} over {' and '.join(setting.over)}: {self.structure.label()}"
        text = "angle of the multipliers on the unit circle"
        data = {"angle": variable("point", table["angle"], "rad", text)}
        kinds, names = ("what happens as well", POINT_KINDS), {name: name for name in setting.over}
        data |= located_variables(setting, table, POINT, kinds, names, KEPT)
        if (residual := table.get(f"{POINT}_residual")) is not None:
            data[f"{POINT}_residual"] = variable(POINT, residual, "1", RESIDUAL)
        attributes = {"title": title, "kind": kind, "over": list(setting.over)}
        return branch_dataset(setting, table, data, **attributes)


def solve_start_on_curve(job: BorderJob) -> tuple[BifurcationCurve, Root]:
    """Solve for the job's orbit and bifurcation at its start; return the curve and the root."""
    # both at once: at a fold the orbit at a fixed parameter is no simple root
    (sequence, nodes), values = job.start.as_guess(job.period), np.array(job.values)
    family = Family.from_nodes(job.setting, sequence, nodes)
    orbit = np.append(nodes.ravel(), values)
    try:
        point = OrbitPoint(family, Root(orbit, np.zeros_like(orbit), np.inf, 0))
        curve = BifurcationCurve.from_orbit(family, point, job.kind)
        guess = np.append(orbit, curve.extra)
        curve.update_bordering_vectors(guess)
        second = unit_vector(len(guess), family.node_unknowns + 1)
        return curve, newton_correct(curve, guess, second)
    except SOLVER_ERRORS as reason:
        expected = "expected a branch of this structure"
        raise InputError(f"start: no bifurcation found there ({reason}); {expected}") from None


@question(BorderJob)
def border(
    structure: Structure,
    *,
    start: xr.Dataset,
    bifurcation: int,
    over: Sequence[str] = ("eta", "e"),
    limits: ArrayLike,
    eta: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    amplitude: ArrayLike | None = None,
    box_acceleration: float | None = None,
    force1: float | None = None,
    force2: float | None = None,
    longest: Number = 0.03,
    most: Count = 500,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Follow a bifurcation of a branch over two parameters.

    Parameters
    ----------
    structure : Structure
    start : xarray.Dataset
        A result of :func:`orchestrate.branch`.
    bifurcation : int
        Number of one of its bifurcations: a fold, period doubling, Neimark-Sacker bifurcation,
        grazing or earlier release. Of a structure that a preload holds together the earlier release
        is the level at which it first opens, see :func:`orchestrate.contact_threshold`.
    over : sequence of 2 str
        The parameters; the first one is that of the branch.
    limits : array_like, shape (2, 2)
        Between which each is followed.
    eta, frequency, amplitude, box_acceleration, force1, force2, longest, most
        As in :func:`orchestrate.branch`.
    **running
        ``store``, ``fmu`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Along ``point``: both parameters, the orbit there as :func:`orchestrate.orbit` has it, and
        the ``angle`` of the multipliers at a Neimark-Sacker bifurcation. Over ``codimension_two``,
        the points where a second bifurcation happens as well: ``codimension_two_kind``, both
        parameters, the orbit's state, nodes and multipliers, and ``codimension_two_residual``.
        Attributes: ``kind``, and ``first_end`` and ``last_end``, why the curve ends.

    Raises
    ------
    InputError
        Where arguments contradict each other, or there is no such bifurcation.

    Notes
    -----
    Points of codimension two are cusps, fold-flips, resonances 1:1 to 1:4, folds and period
    doublings with a pair of multipliers on the unit circle, and those at which a bifurcation
    reaches a grazing (Thota and Dankowicz, 2006). See :mod:`orchestrate.dynamics.codimension_two`
    for the conditions. Degenerate period doublings and Neimark-Sacker bifurcations, where only the
    sign of a normal form changes, are not looked for.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.branches import branch
    >>> from orchestrate.dynamics.borders import border
    >>> beam = Structure.nondimensional()
    >>> window = branch(beam, eta=2.6, limits=(2.5, 2.7))
    >>> limits = [(2.5, 2.7), (0.69, 0.71)]
    >>> curve = border(beam, start=window, bifurcation=0, limits=limits, longest=0.5)
    >>> curve.attrs["kind"], curve.e.values[[0, -1]]
    ('Neimark-Sacker', array([0.69, 0.71]))
    """
    require_delaminated(structure)
    branches.require_orbit_dataset(start, allow_several=True)
    branches.checked_bifurcation_index(start, "bifurcation", bifurcation)
    names = checked_texts("over", over)
    require_known_parameters(names)
    if len(set(names)) != 2 or len(names) != 2 or names[0] != start.attrs.get("over"):
        raise InputError(
            f"over = {names!r}: expected two different names, the first one that of start, "
            f"{start.attrs.get('over')!r}"
        )
    given: Any = limits
    try:
        pairs = tuple(branches.checked_limits(*each) for each in zip(names, given, strict=True))
    except NOT_NUMBERS:
        expected = "expected a lower and an upper one for each parameter"
        raise InputError(f"limits = {limits!r}: {expected}") from None
    nodes, kind = branches.start_guess_and_kind(start, "bifurcation", bifurcation)
    value = float(start["bifurcation_value"].values[bifurcation])
    excitation = excitation_arguments(eta, frequency, amplitude)
    pushes = branches.pushes_at_start(
        start, box_acceleration=box_acceleration, force1=force1, force2=force2
    )
    first = start.isel(point=0)
    excitation = branches.complete_excitation(first, names, excitation, pairs[0], structure, pushes)
    second = start_value_of_second_parameter(structure, names[1], excitation)
    for name, number, pair in zip(names, (value, second), pairs, strict=True):
        branches.require_inside_limits(name, number, pair)
    setting = branches.varied_setting(structure, excitation, names, pairs)
    fields = {"setting": setting, "start": nodes, "period": start.sizes["sample"], "kind": kind}
    return as_given(f"_{'_'.join(names)}", values=(value, second), **fields)


def passes_bifurcation(curve: xr.Dataset, question: Mapping[str, Any], near: float = 1e-3) -> bool:
    """Return whether a border passes the bifurcation that another question starts from."""
    start, (across, along) = question["start"], question["over"]
    bifurcation = start.isel(bifurcation=question["bifurcation"])
    level = Structure.from_attributes(start.attrs).parameters().get(along, np.nan)
    x = curve[across].values - float(bifurcation.bifurcation_value)
    y = curve[along].values - level
    at = np.flatnonzero((y[:-1] * y[1:] <= 0.0) & (y[:-1] != y[1:]))
    passes = x[at] - y[at] * (x[at + 1] - x[at]) / (y[at + 1] - y[at])
    kind = flag_word(bifurcation.bifurcation_kind)
    reach = near * np.ptp(question["limits"][0])
    return bool(curve.attrs["kind"] == kind and (np.abs(passes) < reach).any())


def start_value_of_second_parameter(
    structure: Structure, name: str, excitation: tuple[tuple[str, float], ...]
) -> float:
    if name in EXCITATION_PARAMETERS and name not in dict(excitation):
        box = (pair for pair in excitation if pair[0] in EXCITATION_PARAMETERS)
        forms = "; ".join(f"{stated} = {value!r}" for stated, value in box)
        expected = "only eta" if name == "eta" else "frequency and amplitude in place of eta"
        raise InputError(f"over = {name!r} with {forms}: expected {expected}")
    return dict(excitation)[name] if name in dict(excitation) else structure.get(name)
