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
COUNT: dict[str, Any] = {"variability": "discrete", "type": INTEGER, "minimum": 0}
Entry = Callable[[Any, float], int]  # memory and time (s) -> code, 0 for success


@dataclass(frozen=True)
class Variable:
    """One variable of an FMU; causality, variability and initial are FMI 2.0 attributes."""

    name: str
    description: str
    causality: str
    unit: str = ""  # "1" is dimensionless, "" what has none
    variability: str = "continuous"
    initial: str = ""
    type: str = REAL
    start: float = 0.0  # of all that is not calculated
    minimum: float | None = None  # included, as the maximum
    maximum: float | None = None
    nominal: float = 0.0  # order of magnitude; 0: that of the start value, or 1
    display_unit: str = ""  # in which tools show it, where that is not `unit`
    dependencies: tuple[str, ...] = ()  # inputs that the output follows at once, without a step
    initial_dependencies: tuple[str, ...] = ()  # of the calculated initial value
    # how many of the variables behind it are its time derivatives: a polynomial in time together,
    # which begins where one of them is set
    input_derivatives: int = 0
    series: str = ""  # the array that it is an element of, where FMI 3.0 has only the array
    slot: int = -1  # in table and memory, and FMI's value reference, see `with_slot_numbers`

    @property
    def calculated(self) -> bool:
        return self.causality in ("output", "local")

    @property
    def fixed(self) -> bool:
        return self.variability == "fixed"

    def format_value(self, value: float) -> str:
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
        return f"{self.name} = {self.format_value(value)}{unit}: expected {self.range_text()}"

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


def positive_parameter(name: str, unit: str, start: float, description: str) -> Variable:
    return parameter(name, unit, start, description, minimum=TINY, maximum=LARGE)


def non_negative_parameter(
    name: str, unit: str, start: float, description: str, **more: Any
) -> Variable:
    return parameter(name, unit, start, description, minimum=0.0, maximum=LARGE, **more)


def start_value_parameter(
    name: str, unit: str, description: str, limit: float = DRIVE_LIMIT, **more: Any
) -> Variable:
    return parameter(name, unit, 0.0, description, minimum=-limit, maximum=limit, **more)


def evaluation_limit_parameter(function: str) -> Variable:
    """Return the parameter that bounds a communication step by evaluations of a function."""
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


def input_variable(name: str, unit: str, start: float, description: str, **more: Any) -> Variable:
    given = {"minimum": -HUGE, "maximum": HUGE, **more}
    return Variable(name, description, "input", unit, start=start, **given)


def cubic_input(
    name: str, unit: str, description: str, limit: float = HUGE, derivatives: Sequence[str] = ()
) -> tuple[Variable, ...]:
    """Return an input and its three time derivatives: together a polynomial in time."""
    names = derivatives or [f"{name}_{order}" for order in (1, 2, 3)]
    more: dict[str, Any] = {"minimum": -limit, "maximum": limit}
    text = f"{description}: value when it was set; runs on as the cubic with "
    text += f"{names[0]}, {names[1]} and {names[2]}"
    variables = [input_variable(name, unit, 0.0, text, input_derivatives=3, **more)]
    base, per_second, power = unit.partition("/s")
    first = int(power or 1) if per_second else 0
    for i, (other, word) in enumerate(zip(names, ("First", "Second", "Third")), 1):
        own = f"{base}/s{first + i if first + i > 1 else ''}"
        text = f"{word} time derivative of {name} when one of the four was set"
        variables.append(input_variable(other, own, 0.0, text, **more))
    return tuple(variables)


def output_variable(
    name: str, unit: str, description: str, known: Iterable[str] = (), **more: Any
) -> Variable:
    given = {"initial": "calculated", "initial_dependencies": tuple(known), **more}
    return Variable(name, description, "output", unit, **given)


def with_slot_numbers(variables: Sequence[Variable], memory: ModuleType) -> tuple[Variable, ...]:
    """Return the variables with their places as slots, which the memory has by their names."""
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
    """An array of FMI 3.0 over variables that stand in the table one after the other."""

    name: str
    description: str
    first: str  # name of the first variable
    size: int


@dataclass(frozen=True)
class Clock:
    """A triggered output clock of FMI 3.0."""

    name: str
    description: str
    counter: str  # the variable that grows with each tick


@dataclass(frozen=True)
class Terminal:
    """Variables that are connected together with those of another model."""

    name: str
    description: str
    members: Mapping[str, str]  # variables by the names that both models know


@dataclass(frozen=True)
class SlotRange:
    """What numbers slots of a saved memory may have; any, NaN too, where no range is given."""

    first: int
    size: int = 1
    lowest: float = inf
    highest: float = -inf

    def allows(self, value: float) -> bool:
        return self.lowest > self.highest or self.lowest <= value <= self.highest


@dataclass(frozen=True, eq=False)  # each is one thing: known by itself, not by its contents
class Model:
    """Everything that the exporters need to know of a model; entry points return 0 for success."""

    name: str
    description: str
    version: str
    author: str
    license: str
    variables: tuple[Variable, ...]  # in the order of their slots, from 0 without gaps
    memory_size: int  # floats of an instance
    written_only: tuple[int, int]  # first slot and count: a step never reads them, if it fails too
    limited: int  # code of `advance` where `evaluation_limit` is reached: discarded, no error
    time_slot: int  # of the communication point reached
    stop_slot: int  # of the flag that ends a step at its first event
    set_slot: int  # of the first of the flags that tell of inputs set, see `set_flag_by_slot`
    initialize: Entry
    advance: Entry
    differentiate: Entry  # writes the outputs' rates of change, the inputs as they are
    restore: Entry  # recomputes what the parameters decide in a memory that came from outside
    # of slots behind the variables: what indexes, counts or bounds a loop, or need not be finite
    ranges: tuple[SlotRange, ...]
    rates: Mapping[int, int]  # slots of rates by slots of outputs; those behind each follow alike
    messages: Mapping[int, str]  # what a code says, as one line, see `format_message`
    stop_time: float  # of the default experiment, s
    step_size: float
    arrays: tuple[Array, ...] = ()
    clock: Clock | None = None
    terminals: tuple[Terminal, ...] = ()
    series_count: str = ""  # the parameter of how many elements of the series a step fills
    excitation: tuple[str, ...] = ()  # inputs that are parameters in the plain form
    refresh: Entry | None = None  # where outputs follow an input at once: for inputs as set now
    coast: Entry | None = None  # tried first: only outputs change; else it has changed nothing

    def rate_slot(self, variable: Variable) -> int:
        """Return the slot of a continuous output's rate of change, else -1."""
        if variable.causality != "output" or variable.variability != "continuous":
            return -1
        first = max(slot for slot in self.rates if slot <= variable.slot)
        return self.rates[first] + variable.slot - first

    @property
    def set_flag_by_slot(self) -> dict[int, int]:
        """Slots of the flags to raise where an input with derivatives, or one of these, is set."""
        values = [v for v in self.variables if v.input_derivatives]
        return {
            slot: self.set_slot + place
            for place, value in enumerate(values)
            for slot in range(value.slot, value.slot + 1 + value.input_derivatives)
        }

    @property
    def entry_points(self) -> dict[str, Entry]:
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


def hidden_slot_problem(model: Model, memory: Sequence[float]) -> str:
    """Say which slot behind the variables cannot have its value; empty if all can."""
    ranges = {slot: row for row in model.ranges for slot in range(row.first, row.first + row.size)}
    for slot in range(len(model.variables), model.memory_size):
        value = float(memory[slot])
        if not (ranges[slot].allows(value) if slot in ranges else isfinite(value)):
            return f"{value!r} in slot {slot}"
    return ""


def messages_with_slot_numbers(messages: Mapping[int, str], memory: ModuleType) -> dict[int, str]:
    """Return messages with slots in place of their names: ``{E}`` is ``{6}``."""

    def slot_number(match: re.Match[str]) -> str:
        return f"{{{getattr(memory, match.group(1))}"

    return {code: re.sub(r"\{([A-Z]\w*)", slot_number, text) for code, text in messages.items()}


def format_message(model: Model, memory: Sequence[float], code: int) -> str:
    """Return what a return code of the kernel means, as one line.

    In a message ``{12}`` stands for the value in slot 12, ``{12:0}`` for the whole number next to
    it, ``{12:flight|contact}`` for one of the words, chosen by it. The native FMU fills in the same
    texts.
    """

    def format_slot(match: re.Match[str]) -> str:
        slot, how = int(match.group(1)), match.group(2)
        value = float(memory[slot])
        if how == ":0":
            return f"{value:.0f}"
        if how:
            return str(how[1:].split("|")[int(value)])
        known = slot < len(model.variables)
        return model.variables[slot].format_value(value) if known else repr(value)

    return re.sub(r"\{(\d+)(:[^}]*)?\}", format_slot, model.messages[code])
