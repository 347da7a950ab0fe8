"""At which structures and excitations a question is asked: at one, or along one parameter.

An excitation is told as ``eta``: frequency ``eta omega`` and amplitude ``1/eta^2`` m, so that x is
the xi of (3) in metres; or as ``frequency`` in rad/s with ``amplitude`` in m.
"""

from __future__ import annotations

import math
from abc import ABC
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..access import REST
from ..errors import InputError
from ..running.job import Job, brief
from ..structures import PARAMETERS, Excitation, Structure
from ..structures.ranges import EXCITATION, NUMBERS, one_of
from .labels import Variable, parameter, variable

Numbers = float | tuple[float, ...]
ASKED = {"eta": NUMBERS["eta"], **{name: EXCITATION[name] for name in ("frequency", "amplitude")}}
FORMS = "expected eta=, or frequency= with amplitude="
MOST = 1_000_000  # periods, samples, values: more is a slip of the pen


class Point(NamedTuple):
    """A structure under an excitation."""

    structure: Structure
    excitation: Excitation

    @property
    def length(self) -> float:
        """The unit of xi, a eta^2 in m (3)."""
        return self.excitation.length(self.structure)

    @property
    def speed(self) -> float:
        """The unit of xi', omega a eta^2 in m/s."""
        return self.structure.omega * self.length

    @property
    def scale(self) -> NDArray[np.float64]:
        """Units of the four co-ordinates of a state."""
        length = self.length
        speed = self.structure.omega * length
        return np.array([length, length, speed, speed])


@dataclass(frozen=True)
class Series:
    """Structures and excitations along one parameter, in the order in which the values were given.

    Attributes
    ----------
    name : str
        Of the parameter, and of the dimension of all results.
    values : tuple of float
    points : tuple of Point
    etas : tuple of float
        Frequency ratio of each.
    """

    name: str
    values: tuple[float, ...]
    points: tuple[Point, ...]
    etas: tuple[float, ...]

    def coordinates(self) -> dict[str, Variable]:
        """The parameter, and the excitation along it."""
        excitations = [point.excitation for point in self.points]
        along = {
            "eta": self.etas,
            "frequency": [excitation.frequency for excitation in excitations],
            "amplitude": [excitation.amplitude for excitation in excitations],
        }
        found = {name: parameter(name, self.name, values) for name, values in along.items()}
        found[self.name] = parameter(self.name, self.name, self.values)
        found["period"] = variable(
            self.name,
            2.0 * np.pi / np.array(self.etas),
            "1",
            "excitation period T = 2 pi/eta in units of tau (22)",
        )
        return found

    def scales(self) -> NDArray[np.float64]:
        """Units of the four co-ordinates of each point's state, shape (n, 4)."""
        return np.array([point.scale for point in self.points])


@lru_cache(maxsize=16)
def series(
    structure: Structure,
    eta: Numbers | None,
    frequency: Numbers | None,
    amplitude: Numbers | None,
    over: str | None = None,
    values: Numbers | None = None,
) -> Series:
    """What a question along one parameter is asked at.

    Parameters
    ----------
    structure : Structure
    eta, frequency, amplitude : float or tuple of float, optional
        The excitation, in one of the two forms.
    over : str, optional
        Parameter of the structure or the excitation that takes ``values``; else it is that of
        ``eta``, ``frequency`` and ``amplitude`` that is given as a list.
    values : tuple of float, optional

    Raises
    ------
    InputError
        Where these are no question of one form along one parameter, or a value is out of its range.
    """
    given = {"eta": eta, "frequency": frequency, "amplitude": amplitude}
    excitation = {name: value for name, value in given.items() if value is not None}
    varied = with_values(over, values, excitation)
    check_form(excitation.keys() | (varied.keys() & ASKED.keys()))
    for name in list(excitation):
        value = excitation[name]
        if isinstance(value, tuple):
            varied[name] = value
            del excitation[name]
    name = over or next((name for name in ASKED if name in varied), None) or next(iter(excitation))
    varied = varied or {name: (excitation[name],)}
    check_lengths(name, over, varied)
    rows = [dict(zip(varied, row, strict=True)) for row in zip(*varied.values(), strict=True)]
    points = [point(structure, {**excitation, **row}) for row in rows]
    etas = varied.get("eta") or tuple(p.excitation.eta(p.structure) for p in points)
    if "eta" in excitation:
        etas = (excitation["eta"],) * len(points)
    return Series(name, varied[name], tuple(points), etas)


def with_values(
    over: str | None, values: Numbers | None, excitation: Mapping[str, Numbers]
) -> dict[str, Any]:
    """The values of the parameter named by ``over``, if any."""
    if over is None:
        if values is not None:
            raise InputError(
                "values: expected with over=, the name of the parameter that takes them"
            )
        return {}
    known = (*ASKED, *PARAMETERS)
    if over not in known:
        raise InputError(f"over = {over!r}: no parameter; {one_of(over, known)}")
    if values is None:
        raise InputError(f"over = {over!r}: expected values= with it")
    if over in excitation:
        raise InputError(f"over = {over!r}: is given as {over}= too; expected values= alone")
    return {over: values if isinstance(values, tuple) else (values,)}


def check_form(names: Any) -> None:
    """Whether an excitation is told in one of the two forms, whole."""
    if set(names) not in ({"eta"}, {"frequency", "amplitude"}):
        found = " and ".join(f"{name}=" for name in ASKED if name in names) or "nothing"
        raise InputError(f"excitation: {found} given; {FORMS}")


def check_lengths(name: str, over: str | None, varied: Mapping[str, tuple[float, ...]]) -> None:
    """Whether there is one parameter, or a frequency with an amplitude for each."""
    others = [other for other in varied if other != name]
    if over and others:
        raise InputError(f"{others[0]}: is a list beside over = {over!r}; expected one number")
    for other in others:
        if len(varied[other]) != len(varied[name]):
            raise InputError(
                f"{other}: {len(varied[other])} values for {len(varied[name])} of {name}; "
                f"expected one number or one for each {name}"
            )


def point(structure: Structure, given: Mapping[str, Any]) -> Point:
    """A structure under an excitation, from parameters of either by name."""
    changes = {name: value for name, value in given.items() if name not in ASKED}
    changed = structure.replace(**changes) if changes else structure
    if "eta" in given:
        excitation = Excitation.nondimensional(given["eta"], changed)
    else:
        excitation = Excitation(frequency=given["frequency"], amplitude=given["amplitude"])
    return Point(changed, excitation)


def one_point(
    structure: Structure,
    eta: ArrayLike | None,
    frequency: ArrayLike | None,
    amplitude: ArrayLike | None,
) -> Point:
    """What a question at a single excitation is asked at.

    Raises
    ------
    InputError
        Where a list is given, too.
    """
    given = {"eta": eta, "frequency": frequency, "amplitude": amplitude}
    told = {name: numbers(name, value) for name, value in given.items() if value is not None}
    check_form(told)
    for name, value in told.items():
        if isinstance(value, tuple):
            raise InputError(f"{name}: {len(value)} values; expected one number")
    return point(checked_structure(structure), told)


# -- what was given, checked ----------------------------------------------------------------------


def checked_structure(structure: object) -> Structure:
    """The structure, if it is one."""
    if not isinstance(structure, Structure):
        raise InputError(f"structure = {structure!r}: expected a Structure")
    return structure


def numbers(name: str, given: ArrayLike | None) -> Numbers | None:
    """A number or a list of numbers, each in the parameter's range.

    Parameters
    ----------
    name : str
        Of the parameter; ranges of a structure's are checked by the structure.
    given : array_like, optional

    Raises
    ------
    InputError
        Where these are no finite numbers, none at all, a table, or out of range.
    """
    if given is None:
        return None
    try:
        array = np.asarray(given)
        if array.dtype.kind not in "iuf":
            raise ValueError
        array = array.astype(float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} = {given!r}: expected a number or a list of numbers") from None
    if array.ndim > 1 or not 1 <= array.size <= MOST:
        shape = "x".join(map(str, array.shape))
        raise InputError(f"{name}: {shape} values; expected a number or a list of 1 to {MOST}")
    found = tuple(array.ravel().tolist())
    check = ASKED[name].check if name in ASKED else float
    found = tuple(check(value) for value in found)
    bad = [value for value in found if not math.isfinite(value) or (name in ASKED and value <= 0.0)]
    if bad:
        raise InputError(f"{name} = {bad[0]!r}: expected finite numbers" + " > 0" * (name in ASKED))
    return found if array.ndim else found[0]


def whole(name: str, given: Any, least: int, most: int = MOST) -> int:
    """A whole number in a range.

    Raises
    ------
    InputError
        Where it is none.
    """
    good = isinstance(given, (int, np.integer)) and not isinstance(given, bool)
    if not good or not least <= given <= most:
        raise InputError(f"{name} = {given!r}: expected a whole number from {least} to {most}")
    return int(given)


def positive(name: str, given: Any) -> float:
    """A finite number above zero.

    Raises
    ------
    InputError
        Where it is none.
    """
    number = numbers(name, given)
    if not isinstance(number, float) or number <= 0.0:
        raise InputError(f"{name} = {given!r}: expected a number > 0")
    return number


def states(name: str, given: ArrayLike | None, structure: Structure) -> NDArray[np.float64]:
    """States x1, x2 in m, v1, v2 in m/s of a structure, shape (n, 4); rest by default.

    Raises
    ------
    InputError
        Where these are no states the structure can be in.
    """
    expected = "expected x1, x2 in m, v1, v2 in m/s with x2 >= x1"
    try:
        found = np.atleast_2d(np.asarray(REST if given is None else given, dtype=float))
    except (TypeError, ValueError):
        told = "a dataset" if hasattr(given, "data_vars") else repr(given)
        raise InputError(f"{name} = {told}: {expected}") from None
    if found.ndim != 2 or found.shape[1] != 4 or not len(found):
        raise InputError(f"{name}: shape {found.shape}; {expected}")
    wrong = ~np.isfinite(found).all(axis=1) | (found[:, 1] < found[:, 0])
    if structure.bonded:
        expected = "expected x2 = x1 and v2 = v1 of a bonded structure"
        wrong |= (found[:, 0] != found[:, 1]) | (found[:, 2] != found[:, 3])
    if wrong.any():
        state = tuple(found[wrong.argmax()].tolist())
        raise InputError(f"{name} = {state!r}: {expected}")
    return found


def state(name: str, given: ArrayLike | None, structure: Structure) -> tuple[float, ...]:
    """One state."""
    found = states(name, given, structure)
    if len(found) != 1:
        raise InputError(f"{name}: {len(found)} states; expected one")
    return tuple(found[0].tolist())


# -- jobs -----------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Question(Job, ABC):
    """A job that answers a function of the public API.

    Attributes
    ----------
    structure : Structure
    """

    structure: Structure
    asked: ClassVar[str] = ""  # name of the function

    def call(self) -> str:
        """The call that asks it."""
        told: dict[str, Any] = {}
        for name, value in self.parameters().items():
            inside = isinstance(value, dict) and "sha256" not in value and name != "structure"
            told.update(value if inside else {name: value})
        if not told.get("phase"):
            told.pop("phase", None)
        parts = [f"Structure{brief(told.pop('structure'))}"]
        parts += [f"{name}={brief(told[name])}" for name in told if told[name] not in (None, "")]
        return f"{self.asked}({', '.join(parts)})"


@dataclass(frozen=True, kw_only=True)
class SeriesQuestion(Question, ABC):
    """A question along one parameter.

    Attributes
    ----------
    eta, frequency, amplitude : float or tuple of float, optional
        The excitation.
    over : str, optional
        Parameter that takes ``values``.
    values : tuple of float, optional
    """

    eta: Numbers | None = None
    frequency: Numbers | None = None
    amplitude: Numbers | None = None
    over: str | None = None
    values: Numbers | None = None

    def __post_init__(self) -> None:
        _ = self.series  # what is wrong is said before any work

    @property
    def series(self) -> Series:
        """Structures and excitations along the parameter."""
        return series(
            self.structure, self.eta, self.frequency, self.amplitude, self.over, self.values
        )

    def count(self) -> int:
        """Number of values."""
        return len(self.series.values)


def asked_along(
    structure: Structure,
    eta: ArrayLike | None,
    frequency: ArrayLike | None,
    amplitude: ArrayLike | None,
    over: str | None = None,
    values: ArrayLike | None = None,
) -> dict[str, Any]:
    """The fields of a :class:`SeriesQuestion` from what a user gave."""
    given = {"eta": eta, "frequency": frequency, "amplitude": amplitude}
    told = {name: numbers(name, value) for name, value in given.items()}
    found = numbers(over if over in ASKED else "values", values)
    return {"structure": checked_structure(structure), **told, "over": over, "values": found}
