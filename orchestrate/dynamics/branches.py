"""Branches of orbits over a parameter: the job and function ``orchestrate.branch``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ..constants import TURN
from ..errors import InputError
from ..fmu import OSCILLATOR, EventInstance
from ..lazy import Unpack, xr
from ..model import Structure
from ..model.arguments import Count, Number, checked_integer, checked_number, checked_pair
from ..model.ranges import OF_LENGTH, PUSHES
from ..response.questions import (
    OF_EXCITATION,
    Question,
    checked_excitation_numbers,
    require_delaminated,
)
from ..response.signatures import as_given, question
from ..running.job import FAMILY, Fmus, Table
from ..running.options import Running
from ..running.provenance import describe_dataset
from .bifurcation_kinds import KINDS
from .branch_switching import first_point_of_leaving_branch
from .continuation import SOLVER_ERRORS, ArclengthStepper
from .families import Setting, require_known_parameters
from .orbit_records import branch_dataset, branch_table, located_variables, orbit_row
from .orbit_search import solve_orbit
from .orbit_tracer import OrbitPoint, OrbitTracer
from .orbits import (
    NODE,
    FirstGuess,
    call_text_from_start,
    excitation_arguments,
    guess_from_result,
    orbit,
)
from .tracer import BranchSegment

NODES = ("node_kind", *NODE)
KEPT = (  # variables of orbits that those at bifurcations have, too
    *("state", "xi", "xi_rel", "xi_rel_max", "multipliers", "residual"),
    *NODES,
)
BIFURCATION = "bifurcation"
OF_OMEGA = {"m1", "k1", "omega", "f1"}  # what changes eta at one frequency
OF_SETTING = ("over", "limits", *PUSHES)  # with an excitation


class BranchJob(Question):
    """Job of :func:`orchestrate.branch`: a branch of orbits continued over one parameter."""

    family: ClassVar[tuple[str, ...]] = FAMILY
    setting: Setting  # the parameter that varies and its limits
    start: FirstGuess  # nodes of the orbit that it begins with
    value: float  # of the parameter there
    replaced: ClassVar[tuple[str, ...]] = (*OF_EXCITATION, *OF_SETTING)
    item_columns: ClassVar[tuple[str, ...]] = ()  # orbits and bifurcations

    def format_call(self) -> str:
        (over,), (limits,) = self.setting.over, self.setting.limits
        switch = {"switch": KINDS[self.switch]} if self.switch >= 0 else {}
        keywords = {**switch, "over": over, "limits": limits}
        more = {"longest": self.longest, "most": self.most}
        return call_text_from_start(self, np.array([self.value]), **keywords, **more)

    def work(self, fmus: Fmus, items: Sequence[int], previous: Table | None) -> Table:
        guess, values = self.start.as_guess(self.period), np.array([self.value])
        try:
            start = OrbitPoint(*solve_orbit(self.setting, guess, values))
            if self.switch >= 0:
                start = first_point_of_leaving_branch(self.switch, start)
        except SOLVER_ERRORS as reason:
            expected = "expected an orbit of this structure"
            raise InputError(f"start: no orbit found from there ({reason}); {expected}") from None
        forth, back = self.trace(start), BranchSegment([start], end="start")
        if self.switch < 0:
            back = self.trace(start.reversed())
        first = len(back.points) - 1.0
        points = [*reversed(back.points[1:]), *forth.points]
        bifurcations = [
            *(replace(b, position=first - b.position) for b in reversed(back.bifurcations)),
            *(replace(b, position=first + b.position) for b in forth.bifurcations),
        ]
        solved = [*points, *(each.point for each in bifurcations)]
        with EventInstance(fmus[OSCILLATOR]) as instance:
            rows = [orbit_row(instance, p.family, p.root.unknowns, p.root.residual) for p in solved]
        ends = np.array([back.end, forth.end])
        return {**branch_table(rows, BIFURCATION, bifurcations), "ends": ends}

    def trace(self, start: OrbitPoint) -> BranchSegment[OrbitPoint]:
        """Follow the branch from an orbit on, in the direction of its tangent."""
        stepper = ArclengthStepper.at_start(start.family, start.root, self.longest)
        return OrbitTracer(stepper, self.most).trace(start)

    def dataset(self, table: Table) -> xr.Dataset:
        setting, (name,) = self.setting, self.setting.over
        periods = table["zero"].shape[1]
        count = f"{periods} period{'s' * (periods != 1)}"
        title = f"Branch of orbits of {count} along {name}: {self.structure.label()}"
        kinds = "kind of bifurcation", KINDS
        at = located_variables(setting, table, BIFURCATION, kinds, {name: "value"}, KEPT)
        return branch_dataset(setting, table, at, title=title, over=name)


@question(BranchJob)
def branch(
    structure: Structure,
    *,
    start: xr.Dataset | None = None,
    over: str = "eta",
    limits: ArrayLike,
    switch: int | None = None,
    eta: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
    amplitude: ArrayLike | None = None,
    period: int = 1,
    box_acceleration: float | None = None,
    force1: float | None = None,
    force2: float | None = None,
    longest: Number = 0.03,
    most: Count = 1000,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Follow the branch of periodic orbits through one of them, along a parameter.

    Parameters
    ----------
    structure : Structure
    start : xarray.Dataset, optional
        An orbit of :func:`orchestrate.orbit`, a point of a branch, or with ``switch`` a branch. By
        default the orbit that :func:`orchestrate.orbit` finds at the excitation given, or at the
        lower limit.
    over : str
        The parameter: ``"eta"``, ``"frequency"``, ``"amplitude"``, ``"box_acceleration"``,
        ``"force1"``, ``"force2"`` or any of a structure, such as ``"e"``, ``"D"``, ``"mu"``.
    limits : array_like of 2 floats
        Between which it is followed, both included.
    switch : int, optional
        Number of a bifurcation of ``start``: the branch that leaves there is followed, at a period
        doubling that of the double period, at a grazing that with one impact more or less.
    eta, frequency, amplitude : float, optional
        The excitation, where it does not vary; by default that of ``start``.
    period : int
        Excitation periods of the orbit, without ``start``.
    box_acceleration, force1, force2 : float, optional
        As in :func:`orchestrate.orbit`; by default that of ``start``, else 0.
    longest : float
        Longest step along the branch: about the limits' span, and phases in rad, are measured in 1.
    most : int
        Most points in one direction.
    **running
        ``store``, ``fmu`` and others, see :class:`orchestrate.running.options.Running`.

    Returns
    -------
    xarray.Dataset
        Along ``point``: the parameter, and all variables of :func:`orchestrate.orbit`. Along
        ``bifurcation``: ``bifurcation_kind`` and ``bifurcation_value``, the orbit there, and its
        multipliers. ``first_end`` and ``last_end`` among the attributes say why it ends.

    Raises
    ------
    InputError
        Where arguments are missing or contradict each other, or no orbit is found to begin with.

    Notes
    -----
    Pseudo-arclength continuation of the equations of
    :mod:`orchestrate.dynamics.periodic_orbit`. Bifurcations are located by Brent's method to
    rounding, but the loss and the begin of permanent contact to about 1e-7 only. A branch ends
    where the sequence of impacts does: where an impact or a flight grazes, or where permanent
    contact is lost or begins. Impacts of a chattering that come and go by (17) are followed.

    Examples
    --------
    >>> from orchestrate.model import Structure
    >>> from orchestrate.dynamics.branches import branch
    >>> found = branch(Structure.nondimensional(), eta=2.5, limits=(2.4, 2.8))
    >>> found.bifurcation_value.values.round(8)
    array([2.64796105, 2.7855415 ])
    """
    require_known_parameters((over,))
    require_delaminated(structure)
    if start is not None:
        require_orbit_dataset(start, allow_several=switch is not None)
        along = start.attrs.get("over", over)
        if switch is not None and along != over:
            raise InputError(
                f"over = {over!r}: the branch of start is along {along!r}; expected the same with "
                f"switch = {switch!r}"
            )
    low_high = checked_limits(over, limits)
    pushes = pushes_at_start(start, box_acceleration=box_acceleration, force1=force1, force2=force2)
    excitation = complete_excitation(
        start, (over,), excitation_arguments(eta, frequency, amplitude), low_high, structure, pushes
    )
    if start is None:
        search = structure, over, low_high, excitation, period, running
        start, value = find_first_orbit_and_value(*search)
    elif switch is not None:
        index = checked_bifurcation_index(start, "switch", switch)
        value = float(start["bifurcation_value"].values[index])
    elif over in pushes:
        value = pushes[over]
    else:
        value = float(start[over]) if over in start.coords else structure.get(over)
    require_inside_limits(over, value, low_high)
    nodes, kind = start_guess_and_kind(start, "switch", switch)
    setting = varied_setting(structure, excitation, (over,), (low_high,))
    fields = {"setting": setting, "start": nodes, "period": start.sizes["sample"], "switch": kind}
    return as_given(f"_{over}", value=value, **fields)


def varied_setting(
    structure: Structure,
    excitation: tuple[tuple[str, float], ...],
    over: tuple[str, ...],
    limits: tuple[tuple[float, float], ...],
) -> Setting:
    """Return the setting with parameters that vary; raise where its limits are no possible ones."""
    kept = {name: number for name, number in excitation if name not in over}
    fixed = tuple((name, number) for name, number in kept.items() if number or name not in PUSHES)
    setting = Setting(structure, fixed, over, limits)
    for corner in zip(*limits, strict=True):
        setting.closed_form(np.array(corner))
    return setting


def require_orbit_dataset(start: Any, allow_several: bool) -> None:
    if not hasattr(start, "sizes"):
        raise InputError(
            f"start = {start!r}: expected a dataset of orbit or branch; a number of the parameter "
            "is given by its name, as eta=1.5"
        )
    if "node_kind" not in start:
        raise InputError(f"start: {describe_dataset(start)}; expected a dataset of orbit or branch")
    if start["node_kind"].ndim != 1 and not allow_several:
        raise InputError(
            "start: several orbits; expected one (in Python branch.isel(point=0)), or switch="
        )


def pushes_at_start(start: xr.Dataset | None, **arguments: float | None) -> dict[str, float]:
    """Return the loads other than the box's motion: the arguments, else of the start, or 0."""
    known = {} if start is None else {**start.attrs, **start.coords}
    pushes = {}
    for name, argument in arguments.items():
        stored = float(np.ravel(known.get(name, 0.0))[0])
        pushes[name] = stored if argument is None else checked_number(name, argument)
    return pushes


def checked_limits(over: str, limits: ArrayLike) -> tuple[float, float]:
    expected = "two numbers, the lower one first"
    pair = checked_pair("limits", limits, expected)
    checked_excitation_numbers(over, pair)
    if not pair[0] < pair[1]:
        raise InputError(f"limits = {limits!r}: expected {expected}")
    if over == "amplitude" and pair[0] == 0.0:
        raise InputError(f"limits = {limits!r}: expected amplitudes > 0, the unit of the motion")
    return pair


def complete_excitation(
    start: xr.Dataset | None,
    varied: tuple[str, ...],
    arguments: tuple[tuple[str, float], ...],
    limits: tuple[float, float],
    structure: Structure,
    pushes: Mapping[str, float],
) -> tuple[tuple[str, float], ...]:
    """Return the excitation as (name, number) pairs, of ``start`` where there are no arguments."""
    is_pushed = any(pushes.values()) or not pushes.keys().isdisjoint(varied)
    if start is not None and not arguments:
        by_frequency = not {"frequency", "amplitude"}.isdisjoint(varied)
        form = ("frequency", "amplitude") if by_frequency else ("eta",)
        has_level = is_pushed or structure.has_scale
        has_level = has_level or not {*OF_LENGTH, "amplitude"}.isdisjoint(varied)
        eta, amplitude = (float(start[name].values.flat[0]) for name in ("eta", "amplitude"))
        if has_level and not math.isclose(amplitude * eta**2, 1.0, rel_tol=1e-12):
            if "eta" in varied:
                raise InputError(
                    f"over = 'eta': the start's amplitude is {amplitude!r} m, not 1/eta^2; "
                    "expected over='frequency' where the amplitude matters"
                )
            form = ("frequency", "amplitude")
        started_by_frequency = "frequency" in str(start.attrs.get("excitation", ""))
        if "eta" in form and not OF_OMEGA.isdisjoint(varied) and started_by_frequency:
            form = ("frequency", "amplitude")
        arguments = tuple((name, float(start[name].values.flat[0])) for name in form)
    elif varied[0] in OF_EXCITATION and varied[0] not in dict(arguments):
        arguments = (*arguments, (varied[0], limits[0]))
    return (*arguments, *pushes.items())


def find_first_orbit_and_value(
    structure: Structure,
    over: str,
    limits: tuple[float, float],
    arguments: tuple[tuple[str, float], ...],
    period: int,
    running: Mapping[str, Any],
) -> tuple[xr.Dataset, float]:
    """Compute an orbit within the limits to start from; return it, and the parameter there."""
    excitation: dict[str, Any] = dict(arguments)
    if over in excitation:
        value = excitation[over]
    else:
        own = structure.get(over)
        value = own if limits[0] <= own <= limits[1] else limits[0]
        structure = structure.replace(**{over: value})
    require_inside_limits(over, value, limits)
    return compute_start_orbit(structure, excitation, period, running), value


def compute_start_orbit(
    structure: Structure, excitation: Mapping[str, Any], period: int, running: Mapping[str, Any]
) -> xr.Dataset:
    kept = {name: running[name] for name in running.keys() & {"fmu", "build_folder", "progress"}}
    options: dict[str, Any] = {**excitation, **kept}
    return orbit(structure, period=period, **options)


def require_inside_limits(over: str, value: float, limits: tuple[float, float]) -> None:
    if not limits[0] <= value <= limits[1]:
        unit = f" rad/s, {value / TURN:.6g} Hz," if over == "frequency" else ""
        raise InputError(
            f"limits = {limits!r}: {over} = {value!r}{unit} at the start; expected it inside"
        )


def checked_bifurcation_index(start: xr.Dataset, argument: str, index: int) -> int:
    count = start.sizes.get(BIFURCATION, 0)
    if not count:
        raise InputError(f"{argument} = {index!r}: start has no bifurcations; expected a branch")
    return checked_integer(argument, index, 0, count - 1)


def start_guess_and_kind(
    start: xr.Dataset, argument: str, index: int | None
) -> tuple[FirstGuess, int]:
    """Return the nodes of the start, or of one of its bifurcations, and their kind (-1: none)."""
    if index is None:
        return guess_from_result(start), -1
    at = start.isel({BIFURCATION: checked_bifurcation_index(start, argument, index)})
    nodes = {name: at[f"{BIFURCATION}_{name}"].values for name in NODES}
    return guess_from_result(nodes), int(at["bifurcation_kind"])
