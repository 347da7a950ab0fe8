"""The variable table and all else that slave, XML, documentation and tests know of a model.

Standard library only, Python 3.9: this file travels inside the FMU.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from types import ModuleType
from typing import Any, Callable

REAL, INTEGER, BOOLEAN = "Real", "Integer", "Boolean"
HUGE = 1e100  # squares and energies of what an importer may set stay finite
# of positive parameters: ratios of frequencies are at most LARGE**2, and a fourth derivative,
# LARGE**8 * HUGE, is a number; what needs more is checked where a run or a step begins
TINY, LARGE = 1e-24, 1e24
DRIVE_LIMIT = 1e30  # of a drive's start values and inputs: their energies stay finite
Entry = Callable[[Any, float], int]  # memory and time (s) -> code, 0 for success


@dataclass(frozen=True)
class Variable:
    """One variable of an FMU.

    Attributes
    ----------
    name, description, unit : str
        As in ``modelDescription.xml``; unit ``"1"`` is dimensionless, ``""`` for what has none.
    causality, variability, initial : str
        FMI 2.0 attributes.
    type : str
        REAL, INTEGER or BOOLEAN.
    start : float
        Start value, for all that is not calculated.
    minimum, maximum : float or None
        Range, both included.
    nominal : float
        Order of magnitude; 0: that of the start value, or 1.
    display_unit : str
        Unit in which tools show it, where that is not ``unit``.
    dependencies : tuple of str
        The inputs that the output follows at once, without a step.
    initial_dependencies : tuple of str
        The variables known at the start that the calculated initial value depends on.
    input_derivatives : int
        How many of the variables that follow in the table are its time derivatives: together they
        are a polynomial in time, which begins where one of them is set.
    series : str
        Name of the array it is an element of, where FMI 3.0 has only the array.
    slot : int
        Place in the table, in the kernel's memory, and the FMI value reference; see
        :func:`numbered`.
    """

    name: str
    description: str
    causality: str
    unit: str = ""
    variability: str = "continuous"
    initial: str = ""
    type: str = REAL
    start: float = 0.0
    minimum: float | None = None
    maximum: float | None = None
    nominal: float = 0.0
    display_unit: str = ""
    dependencies: tuple[str, ...] = ()
    initial_dependencies: tuple[str, ...] = ()
    input_derivatives: int = 0
    series: str = ""
    slot: int = -1

    @property
    def calculated(self) -> bool:
        return self.causality in ("output", "local")

    @property
    def fixed(self) -> bool:
        return self.variability == "fixed"

    def text(self, value: float) -> str:
        """Return a value as people write it: Integers without a fraction, Booleans as words."""
        if self.type == BOOLEAN and value in (0.0, 1.0):
            return "true" if value else "false"
        if self.type == INTEGER and isfinite(value) and value == int(value):
            return str(int(value))
        return repr(float(value))

    def problem(self, value: float) -> str:
        """Say why ``value`` is not allowed, as one line; return an empty string if it is."""
        if self.type == BOOLEAN:
            return ""
        low = self.minimum is None or value >= self.minimum
        high = self.maximum is None or value <= self.maximum
        if isfinite(value) and low and high:
            return ""
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        return f"{self.name} = {self.text(value)}{unit}: expected {self.range_text()}"

    def range_text(self) -> str:
        if self.type == BOOLEAN:
            return "true or false"
        if self.minimum is None and self.maximum is None:
            return "every finite number"
        lower = "" if self.minimum is None else f"{self.minimum!r} <= "
        upper = "" if self.maximum is None else f" <= {self.maximum!r}"
        return f"{lower}{self.name}{upper}"


def parameter(name: str, unit: str, start: float, description: str, **more: Any) -> Variable:
    given = {"variability": "fixed", "initial": "exact", **more}
    return Variable(name, description, "parameter", unit, start=start, **given)


def positive(name: str, unit: str, start: float, description: str) -> Variable:
    return parameter(name, unit, start, description, minimum=TINY, maximum=LARGE)


def not_negative(name: str, unit: str, start: float, description: str, **more: Any) -> Variable:
    return parameter(name, unit, start, description, minimum=0.0, maximum=LARGE, **more)


def start_value(
    name: str, unit: str, description: str, limit: float = DRIVE_LIMIT, **more: Any
) -> Variable:
    return parameter(name, unit, 0.0, description, minimum=-limit, maximum=limit, **more)


def evaluation_limit(function: str) -> Variable:
    """Return the parameter that bounds the longest communication step, by evaluations of a
    function.
    """
    return parameter(
        "evaluation_limit",
        "",
        10_000_000,
        f"Evaluations of the {function} at which a communication step is discarded: the instance "
        "stays where it was",
        type=INTEGER,
        variability="tunable",
        minimum=1,
        maximum=10_000_000,
    )


def drive(name: str, unit: str, start: float, description: str, **more: Any) -> Variable:
    given = {"minimum": -HUGE, "maximum": HUGE, **more}
    return Variable(name, description, "input", unit, start=start, **given)


def output(
    name: str, unit: str, description: str, known: Iterable[str] = (), **more: Any
) -> Variable:
    given = {"initial": "calculated", "initial_dependencies": tuple(known), **more}
    return Variable(name, description, "output", unit, **given)


def numbered(variables: Sequence[Variable], memory: ModuleType) -> tuple[Variable, ...]:
    """Return the variables in their order, each with its place as its slot.

    Parameters
    ----------
    variables : sequence of Variable
    memory : module
        Of the kernel: has the same slots under the variables' names in capitals.

    Returns
    -------
    tuple of Variable
    """
    for place, variable in enumerate(variables):
        name, _, element = variable.name.partition("[")
        slot = getattr(memory, name.upper()) + (int(element[:-1]) - 1 if element else 0)
        if slot != place:
            raise ValueError(
                f"{variable.name} is variable {place} of the table, but slot {slot} of the memory"
            )
    return tuple(replace(variable, slot=place) for place, variable in enumerate(variables))


@dataclass(frozen=True)
class Array:
    """An array of FMI 3.0 over variables that stand in the table one after the other.

    Attributes
    ----------
    name, description : str
    first : str
        Name of the first variable.
    size : int
    """

    name: str
    description: str
    first: str
    size: int


@dataclass(frozen=True)
class Clock:
    """A triggered output clock of FMI 3.0.

    Attributes
    ----------
    name, description : str
    counter : str
        The variable that grows with each tick.
    """

    name: str
    description: str
    counter: str


@dataclass(frozen=True)
class Terminal:
    """Variables that are connected together with those of another model.

    Attributes
    ----------
    name, description : str
    members : mapping of str to str
        Variables by their names within the terminal: those of the same name belong together.
    """

    name: str
    description: str
    members: Mapping[str, str]


@dataclass(frozen=True)
class SlotRange:
    """What numbers slots of a saved memory may have; any, NaN too, where no range is given."""

    first: int
    size: int = 1
    lowest: float = inf
    highest: float = -inf

    def has(self, value: float) -> bool:
        return self.lowest > self.highest or self.lowest <= value <= self.highest


@dataclass(frozen=True, eq=False)  # each is one thing: known by itself, not by its contents
class Model:
    """Everything that the exporters need to know of a model.

    Attributes
    ----------
    name, description, version, author, license : str
    variables : tuple of Variable
        In the order of their slots, from 0 without gaps, see :func:`numbered`.
    memory_size : int
        Number of floats of an instance's memory.
    written_only : tuple of int
        First slot and number of slots that a step writes and never reads: a step that fails need
        not put them back.
    limited : int
        The code of ``advance`` where the parameter ``evaluation_limit`` was reached: the step is
        discarded, no error.
    time_slot, stop_slot, set_slot : int
        Slots of the communication point reached, of the flag that ends a step at its first event,
        and of the first of the flags that tell of inputs set, see :attr:`set_flags`.
    initialize, advance : callable
        The kernel's entry points, ``(memory, time) -> code``; 0 is success.
    differentiate : callable
        Another one: rates of change of the outputs at the point reached, the inputs as they are,
        into ``rates``.
    restore : callable
        Another one, with the start time: recomputes what the parameters decide in a memory
        that came from outside.
    ranges : tuple of SlotRange
        Of the memory behind the variables: numbers that index, count or bound a loop, and those
        that need not be finite. All others are finite.
    rates : mapping of int to int
        Slots of rates by the slots of outputs: those of the outputs behind each follow as these do.
    refresh : callable or None
        A third one, of a model with outputs that follow an input at once: the outputs for the
        inputs as set now.
    coast : callable or None
        A fourth one, tried first: a step on which only outputs change. Where it does not return 0
        it has changed nothing, and ``advance`` does the step.
    messages : dict of int to str
        What a code of the entry points says, as one line, see :func:`explain`.
    stop_time, step_size : float
        Default experiment, s.
    arrays : tuple of Array
    clock : Clock or None
    terminals : tuple of Terminal
    series_count : str
        The parameter that says how many elements of the series a step fills.
    excitation : tuple of str
        Inputs that describe an excitation of the model's own: parameters in the plain form.
    """

    name: str
    description: str
    version: str
    author: str
    license: str
    variables: tuple[Variable, ...]
    memory_size: int
    written_only: tuple[int, int]
    limited: int
    time_slot: int
    stop_slot: int
    set_slot: int
    initialize: Entry
    advance: Entry
    differentiate: Entry
    restore: Entry
    ranges: tuple[SlotRange, ...]
    rates: Mapping[int, int]
    messages: Mapping[int, str]
    stop_time: float
    step_size: float
    arrays: tuple[Array, ...] = ()
    clock: Clock | None = None
    terminals: tuple[Terminal, ...] = ()
    series_count: str = ""
    excitation: tuple[str, ...] = ()
    refresh: Entry | None = None
    coast: Entry | None = None

    def rate_slot(self, variable: Variable) -> int:
        """Return the slot of a variable's rate of change; -1 if it is no continuous output and has
        none.
        """
        if variable.causality != "output" or variable.variability != "continuous":
            return -1
        first = max(slot for slot in self.rates if slot <= variable.slot)
        return self.rates[first] + variable.slot - first

    @property
    def set_flags(self) -> dict[int, int]:
        """Slots of the flags to be raised when an input with derivatives, or one of these, is set,
        to whatever value; by the input's slot.
        """
        values = [v for v in self.variables if v.input_derivatives]
        return {
            slot: self.set_slot + place
            for place, value in enumerate(values)
            for slot in range(value.slot, value.slot + 1 + value.input_derivatives)
        }

    @property
    def entries(self) -> dict[str, Entry]:
        """The kernel's entry points by name, in the order in which compiled forms give them."""
        given = {
            "initialize": self.initialize,
            "advance": self.advance,
            "differentiate": self.differentiate,
            "restore": self.restore,
            "refresh": self.refresh,
            "coast": self.coast,
        }
        return {name: function for name, function in given.items() if function is not None}


def hidden_problem(model: Model, memory: Sequence[float]) -> str:
    """Say which slot behind the variables cannot have its value; return an empty string if all
    can.
    """
    ranges = {slot: row for row in model.ranges for slot in range(row.first, row.first + row.size)}
    for slot in range(len(model.variables), model.memory_size):
        value = float(memory[slot])
        if not (ranges[slot].has(value) if slot in ranges else isfinite(value)):
            return f"{value!r} in slot {slot}"
    return ""


def with_slots(messages: Mapping[int, str], memory: ModuleType) -> dict[int, str]:
    """Return messages with the slots of a kernel's memory in place of their names: ``{E}`` is
    ``{6}``.
    """

    def slot(match: re.Match[str]) -> str:
        return f"{{{getattr(memory, match.group(1))}"

    return {code: re.sub(r"\{([A-Z]\w*)", slot, text) for code, text in messages.items()}


def explain(model: Model, memory: Sequence[float], code: int) -> str:
    """Return what a return code of the kernel means, as one line.

    In a message ``{12}`` stands for the value in slot 12, ``{12:0}`` for the whole number next to
    it, ``{12:flight|contact}`` for one of the words, chosen by it. The native FMU fills in the same
    texts.
    """

    def fill(match: re.Match[str]) -> str:
        slot, how = int(match.group(1)), match.group(2)
        value = float(memory[slot])
        if how == ":0":
            return f"{value:.0f}"
        if how:
            return str(how[1:].split("|")[int(value)])
        known = slot < len(model.variables)
        return model.variables[slot].text(value) if known else repr(value)

    return re.sub(r"\{(\d+)(:[^}]*)?\}", fill, model.messages[code])
