"""One kind of question: arguments that are checked, points at which they are asked, a job.

An excitation is given as ``eta``: frequency ``eta omega`` and amplitude ``1/eta^2`` m, so that x is
the xi of (3) in metres; or as ``frequency`` in rad/s with ``amplitude`` in m, or with ``level``,
the peak acceleration in m/s2, where that varies.
"""

from __future__ import annotations

from abc import ABC
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from operator import attrgetter
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import NOT_NUMBERS, InputError
from ..fmu import REST, gaps_of_states
from ..lazy import xr
from ..model import PARAMETERS, Excitation, Structure
from ..model.arguments import Numbers, check_and_convert_fields, checked_numbers, checked_unmasked
from ..model.ranges import COMPLETE, EXCITATION, LEVEL, PUSHES, RATIO_QUANTITIES
from ..model.spelling import expected_one_of
from ..running.job import Job, format_brief, refuse_unsupported_structure
from .labels import Variable, parameter_variable, variable

State = tuple[float, ...]
EXCITATION_PARAMETERS = {
    "eta": RATIO_QUANTITIES["eta"],
    **{name: EXCITATION[name] for name in ("frequency", "amplitude")},
    "level": LEVEL,
}
QUANTITIES = {**EXCITATION_PARAMETERS, **{name: EXCITATION[name] for name in PUSHES}}
KEPT_POINTS = 2**14  # of a series, from one use to the next
OF_EXCITATION = ("eta", "frequency", "amplitude")
ABOVE_ZERO = EXCITATION_PARAMETERS.keys() - {"amplitude"}  # with a force the box may be at rest
FORMS = "expected eta=, or frequency= with amplitude="


class Point(NamedTuple):
    """One operating point: a structure under an excitation, with the units of its motion."""

    structure: Structure
    excitation: Excitation

    @property
    def displacement_unit(self) -> float:
        """Return the unit of displacement xi, a eta^2 in m (3)."""
        return self.excitation.length(self.structure)

    @property
    def velocity_unit(self) -> float:
        """Return the unit of velocity xi', omega a eta^2 in m/s."""
        return self.structure.omega * self.displacement_unit

    @property
    def state_units(self) -> NDArray[np.float64]:
        """Return the units of a state's four coordinates: m, m, m/s, m/s."""
        return np.repeat([self.displacement_unit, self.velocity_unit], 2)

    def faces_from_states(self, states: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return SI states in the paper's units, by the faces: their difference is the gap."""
        offset = self.structure.gap_offset
        if offset != 0.0:
            states = np.array(states, dtype=float)
            states[..., 1] = states[..., 0] + gaps_of_states(states, offset)
        faces: NDArray[np.float64] = states / self.state_units
        return faces

    def states_from_faces(self, faces: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return SI states of those in the paper's units by the faces."""
        states: NDArray[np.float64] = faces * self.state_units
        if self.structure.wall:
            states[..., 1::2] = 0.0  # but for rounding
        elif self.structure.gap_offset != 0.0:
            states[..., 1] -= self.structure.gap_offset
        return states


class Points(Sequence[Point]):
    """Operating points by number, made where they are indexed: a million would not fit in memory.

    ``make`` returns the point of a number; ``numbers`` are those of the points, in order.
    """

    def __init__(self, make: Callable[[int], Point], numbers: NDArray[np.intp]) -> None:
        self.make, self.numbers = make, numbers

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, key: Any) -> Any:
        chosen = self.numbers[key].tolist()
        return list(map(self.make, chosen)) if isinstance(chosen, list) else self.make(chosen)

    def select(self, indices: NDArray[np.intp]) -> Points:
        return Points(self.make, self.numbers[indices])


@dataclass(frozen=True)
class Series:
    """Operating points along one parameter, in the order of the values given."""

    name: str  # of the parameter, and of the dimension of all results
    values: tuple[float, ...]
    points: Points
    # of each: frequency ratio, rad/s, m
    etas: NDArray[np.float64]
    frequencies: NDArray[np.float64]
    amplitudes: NDArray[np.float64]

    def coordinates(self) -> dict[str, Variable]:
        along: dict[str, ArrayLike] = {
            "eta": self.etas,
            "frequency": self.frequencies,
            "amplitude": self.amplitudes,
            self.name: self.values,
        }
        coordinates = {n: parameter_variable(n, self.name, along[n]) for n in along}
        text = "excitation period 2 pi/frequency"
        coordinates["period"] = variable(self.name, 2.0 * np.pi / self.frequencies, "s", text)
        return coordinates

    @cached_property
    def displacement_and_velocity_units(self) -> NDArray[np.float64]:
        """Return the units of displacements and velocities at each point, shape (n, 2)."""
        return point_rows(self.points, lambda point: point.state_units[[0, -1]], 2)

    @property
    def state_units(self) -> NDArray[np.float64]:
        """Return the units of the states' coordinates at each point, shape (n, 4)."""
        return self.displacement_and_velocity_units.repeat(2, axis=1)


@lru_cache(maxsize=16)
def make_series(
    structure: Structure,
    eta: Numbers | None,
    frequency: Numbers | None,
    amplitude: Numbers | None,
    over: str | None = None,
    values: Numbers | None = None,
    pushes: tuple[tuple[str, Numbers], ...] = (),
) -> Series:
    """Return the operating points along the one argument that is a list, or ``over``; checked."""
    excitation_values: dict[str, Any] = {"eta": eta, "frequency": frequency, "amplitude": amplitude}
    excitation_values |= dict(pushes)
    excitation = {name: value for name, value in excitation_values.items() if value is not None}
    varied = checked_over_values(over, values, excitation)
    require_complete_excitation(excitation.keys() | varied.keys())
    varied |= {name: value for name, value in excitation.items() if isinstance(value, tuple)}
    excitation = {name: value for name, value in excitation.items() if name not in varied}
    listed = (name for name in QUANTITIES if name in varied)
    name = over or next(listed, None) or next(iter(excitation))
    varied = varied or {name: (excitation[name],)}
    require_equal_lengths(name, over, varied)

    @lru_cache(maxsize=KEPT_POINTS)
    def make_numbered_point(number: int) -> Point:
        row = {varying: numbers[number] for varying, numbers in varied.items()}
        return make_point(structure, {**excitation, **row})

    points = Points(make_numbered_point, np.arange(len(varied[name])))
    eta_values = varied.get("eta") or excitation.get("eta")
    if eta_values is None:
        etas = point_rows(points, lambda point: (point.excitation.eta(point.structure),), 1)[:, 0]
    else:
        etas = np.full(len(points), eta_values)
    of_box = attrgetter("excitation.frequency", "excitation.amplitude")
    return Series(name, varied[name], points, etas, *point_rows(points, of_box, 2).T)


def point_rows(
    points: Points, row: Callable[[Point], ArrayLike], width: int
) -> NDArray[np.float64]:
    """Return ``row`` of each point as an array, shape (n, width)."""
    return np.fromiter(map(row, points), np.dtype((float, (width,))), len(points))


def checked_over_values(
    over: str | None, values: Numbers | None, excitation: Mapping[str, Numbers]
) -> dict[str, Any]:
    """Return the parameter ``over`` with its values as a tuple; {} without one."""
    if over is None:
        if values is not None:
            text = "expected with over=, the name of the parameter that takes them"
            raise InputError(f"values: {text}")
        return {}
    known = (*QUANTITIES, *PARAMETERS)
    if over not in known:
        raise InputError(f"over = {over!r}: no parameter; {expected_one_of(over, known)}")
    if values is None:
        raise InputError(f"over = {over!r}: expected values= with it")
    if over in excitation:
        raise InputError(f"over = {over!r}: is given as {over}= too; expected only values=")
    return {over: values if isinstance(values, tuple) else (values,)}


def require_complete_excitation(names: Any) -> None:
    """Raise unless these arguments are one of the forms in which an excitation is given."""
    if EXCITATION_PARAMETERS.keys() & set(names) not in COMPLETE:
        present = " and ".join(f"{name}=" for name in EXCITATION_PARAMETERS if name in names)
        raise InputError(f"excitation: {present or 'nothing'} given; {FORMS}")


def require_equal_lengths(
    name: str, over: str | None, varied: Mapping[str, tuple[float, ...]]
) -> None:
    others = [other for other in varied if other != name]
    if over and others:
        raise InputError(f"{others[0]}: is a list beside over = {over!r}; expected one number")
    for other in others:
        if len(varied[other]) != len(varied[name]):
            counts = f"{len(varied[other])} values for {len(varied[name])} of {name}"
            raise InputError(f"{other}: {counts}; expected one number or one for each {name}")


def make_point(structure: Structure, arguments: Mapping[str, Any]) -> Point:
    """Return the operating point of numbers by name: of the excitation, others of the structure."""
    changes = {name: value for name, value in arguments.items() if name not in QUANTITIES}
    pushes = {name: arguments[name] for name in PUSHES if name in arguments}
    changed = structure.replace(**changes) if changes else structure
    if "eta" in arguments:
        excitation = Excitation.nondimensional(arguments["eta"], changed, **pushes)
    else:
        frequency, amplitude = arguments["frequency"], arguments.get("amplitude", 0.0)
        if "level" in arguments:
            amplitude = arguments["level"] / frequency**2
        excitation = Excitation(frequency=frequency, amplitude=amplitude, **pushes)
    if excitation.force2:
        changed.require_mass_2("force2")
    if not (excitation.amplitude or any(excitation.pushes)):
        raise InputError("amplitude = 0.0: expected finite numbers > 0, or a force")
    return Point(changed, excitation)


def checked_point(
    structure: Structure,
    eta: ArrayLike | None,
    frequency: ArrayLike | None,
    amplitude: ArrayLike | None,
    **pushes: ArrayLike | None,
) -> Point:
    """Return the one operating point of a user's arguments; raise unless they are complete."""
    arguments = {"eta": eta, "frequency": frequency, "amplitude": amplitude, **pushes}
    stated = {name: value for name, value in arguments.items() if value is not None}
    values = {name: checked_excitation_numbers(name, value) for name, value in stated.items()}
    require_complete_excitation(values)
    for name, value in values.items():
        if isinstance(value, tuple):
            raise InputError(f"{name}: {len(value)} values; expected one number")
    return make_point(checked_structure(structure), values)


# -- what was given, checked ----------------------------------------------------------------------


def checked_structure(structure: object) -> Structure:
    if not isinstance(structure, Structure):
        raise InputError(f"structure = {structure!r}: expected a Structure")
    return structure


def require_bonded_twin(structure: Structure) -> None:
    """Raise ``InputError`` for a mass against a wall: nothing can be bonded to it."""
    if structure.wall:
        text = "nothing can be bonded to it; expected sweep (it has a1_max) or simulate"
        raise InputError(f"wall = True: mass 2 is a wall, {text}")


def require_delaminated(structure: object, function: str = "") -> None:
    """Raise unless delaminated; for a named function, also for a wall or stroke it has not."""
    if checked_structure(structure).bonded:
        raise InputError("bonded = True: expected a delaminated structure (bonded = false)")
    if function:
        refuse_unsupported_structure(function, structure)


def checked_excitation_numbers(name: str, value: ArrayLike | None) -> Numbers | None:
    quantity = QUANTITIES.get(name)
    if quantity is None:
        return checked_numbers(name, value)
    return checked_numbers(name, value, quantity.check, " > 0" if name in ABOVE_ZERO else "")


# the type of `eta`, `frequency`, `amplitude` as one number or a list; units as in `Quantity`
Values = Annotated[ArrayLike | None, checked_excitation_numbers]


def is_outside_gap(states: NDArray[np.float64], structure: Structure) -> NDArray[np.bool_]:
    """Return, for each state, whether the masses overlap or the gap is beyond the stroke."""
    gap, rounding = gaps_of_states(states, structure.gap_offset), 1.0 + 1e-14
    beyond = gap > structure.stroke * rounding if structure.stroke else False
    return np.asarray((gap < 0.0) | beyond)


def checked_states(name: str, value: ArrayLike | None, structure: Structure) -> NDArray[np.float64]:
    """Return start states (n, 4), from unloaded springs, rest by default; raise on overlap."""
    expected = "expected x1, x2 in m, v1, v2 in m/s with x2 >= x1"
    if structure.gap_offset:
        expected += f" - clearance, clearance = {structure.clearance!r} m"
    if structure.stroke:
        expected += f", and a gap of at most stroke = {structure.stroke!r} m"
    start = checked_unmasked(name, REST if value is None else value)
    try:
        rows = np.atleast_2d(np.asarray(start, dtype=float))
    except NOT_NUMBERS:
        text = "a dataset" if hasattr(value, "data_vars") else repr(value)
        raise InputError(f"{name} = {text}: {expected}") from None
    if rows.ndim != 2 or rows.shape[1] != 4 or not len(rows):
        raise InputError(f"{name}: shape {rows.shape}; {expected}")
    with np.errstate(invalid="ignore"):
        overlapping = is_outside_gap(rows, structure) & rows.any(axis=1)
    wrong = ~np.isfinite(rows).all(axis=1) | overlapping
    if structure.bonded:
        expected = "expected x2 = x1 and v2 = v1 of a bonded structure"
        wrong |= (rows[:, 0] != rows[:, 1]) | (rows[:, 2] != rows[:, 3])
    if structure.wall:
        expected = f"expected x2 = 0 and v2 = 0 of a wall, and {expected.removeprefix('expected ')}"
        wrong |= rows[:, 1::2].any(axis=1)
    if wrong.any():
        state = tuple(rows[wrong.argmax()].tolist())
        raise InputError(f"{name} = {state!r}: {expected}")
    return rows


def checked_state(name: str, value: ArrayLike | None, structure: Structure) -> tuple[float, ...]:
    rows = checked_states(name, value, structure)
    if len(rows) != 1:
        raise InputError(f"{name}: {len(rows)} states; expected one")
    return tuple(rows[0].tolist())


def checked_start_states(
    start: ArrayLike | xr.Dataset | None, structure: Structure, series: Series
) -> State:
    """Return the user's start states end to end: one for all, one per value, or of a sweep."""
    if hasattr(start, "end_state"):
        swept: xr.Dataset = start  # type: ignore[assignment]
        dims = swept.end_state.dims
        known: ArrayLike = swept[series.name].values if series.name in dims else []
        if dims != (series.name, "coordinate") or not np.isin(series.values, known).all():
            text = f"expected a sweep in one direction over the same values of {series.name}"
            raise InputError(f"start: a dataset over {', '.join(map(str, dims))}; {text}")
        ends = swept.end_state.sel({series.name: list(series.values)}, method="nearest")
        return tuple((ends.values * series.state_units).ravel().tolist())
    rows = checked_states("start", start, structure)
    if len(rows) not in (1, len(series.values)):
        values = f"{len(series.values)} values of {series.name}"
        raise InputError(f"start: {len(rows)} states; expected one, or one for each of {values}")
    return tuple(rows.ravel().tolist())


# -- jobs -----------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Question(Job, ABC):
    """Job of a public function about a structure: its fields are the function's arguments.

    They are taken from the function's signature, see :mod:`.signatures`. A class declares what a
    field is that the function makes of its arguments.
    """

    structure: Structure
    result: ClassVar[str] = ""  # first word of the result's name, where that is another
    replaced: ClassVar[tuple[str, ...]] = ()  # arguments of which fields are made, no fields

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return an argument of the function."""

    def __post_init__(self) -> None:
        checked_structure(self.structure)
        check_and_convert_fields(self)

    def answering_job(self) -> Question:
        """Return the job that answers the question: another one where its arguments make it so."""
        return self

    def format_call(self) -> str:
        """Return Python source of the call with these arguments."""
        arguments: dict[str, Any] = {}
        for name, value in self.parameters().items():
            inside = isinstance(value, dict) and "sha256" not in value and name != "structure"
            arguments.update(value if inside else {name: value})
        for name in ("phase", *PUSHES):
            if not arguments.get(name):
                arguments.pop(name, None)
        texts = [f"Structure{format_brief(arguments.pop('structure'))}"]
        pairs = [(name, value) for name, value in arguments.items() if value not in (None, "")]
        texts += [f"{name}={format_brief(value)}" for name, value in pairs]
        return f"{self.asked}({', '.join(texts)})"


@dataclass(frozen=True, kw_only=True)
class OneMotionQuestion(Question, ABC):
    """Base of questions about one motion, under one excitation."""

    excitation: Excitation
    replaced: ClassVar[tuple[str, ...]] = (*OF_EXCITATION, *PUSHES)
    item_columns: ClassVar[tuple[str, ...]] = ()  # times, crossings

    def items(self) -> Sequence[Point]:
        return [Point(self.structure, self.excitation)]


@dataclass(frozen=True, kw_only=True)
class SeriesQuestion(Question, ABC):
    """Base of questions about responses along one parameter."""

    over: str | None = None  # parameter that takes `values`
    values: Numbers | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        name = self.over if self.over in QUANTITIES else "values"
        object.__setattr__(self, "values", checked_excitation_numbers(str(name), self.values))
        known = self.over in self.family or hasattr(self, str(self.over))
        if not known and self.over in (*PUSHES, "stroke"):
            raise InputError(f"over = {self.over!r}: {self.asked} does not know it yet")
        _ = self.series  # what is wrong is said before any work

    @property
    def series(self) -> Series:
        arguments = self.eta, self.frequency, self.amplitude, self.over, self.values
        return make_series(self.structure, *arguments, self.pushes)

    @property
    def pushes(self) -> tuple[tuple[str, Numbers], ...]:
        """Return the loads other than the box's harmonic motion, as (name, values), if not 0."""
        loads = ((name, getattr(self, name, 0.0)) for name in PUSHES if name != self.over)
        return tuple((name, value) for name, value in loads if value != 0.0)

    def count(self) -> int:
        return len(self.series.values)

    def items(self) -> Sequence[Any]:
        return self.series.points


class StartedSeriesQuestion(SeriesQuestion, ABC):
    """Base of those whose responses start from given states, see :func:`checked_start_states`."""

    def __post_init__(self) -> None:
        super().__post_init__()
        states = checked_start_states(self.start, self.structure, self.series)
        object.__setattr__(self, "start", states)
