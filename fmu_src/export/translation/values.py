"""Types of the kernel's values, and expressions in C that have one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from types import FunctionType
from typing import TypeAlias

from ..errors import CannotExport

MEMORY, REAL, WHOLE, LONG, TRUTH, NOTHING = "memory", "real", "whole", "long", "truth", "nothing"
Type: TypeAlias = "str | tuple[Type, ...]"  # one of these; of a tuple, the types of its parts
C_TYPES = {
    MEMORY: "double *RESTRICT",
    REAL: "double",
    WHOLE: "int",
    LONG: "long long",
    TRUTH: "int",
    NOTHING: "void",
}
NUMBERS = (TRUTH, WHOLE, LONG, REAL)  # each is converted to those after it
# how closely C's operators bind
ATOM, UNARY, PRODUCT, SUM, RELATION, EQUALITY, BITS, AND, OR, CHOICE = range(16, 6, -1)


@dataclass(frozen=True)
class Value:
    """An expression in C."""

    text: str
    type: Type
    rank: int = ATOM  # how closely its outermost operator binds
    real: str = ""  # the same number as a real one, where it is one before it is made whole

    def text_within(self, rank: int) -> str:
        """Return its text as an operand of an operator that binds so closely."""
        return self.text if self.rank >= rank else f"({self.text})"

    def item(self, place: int) -> Value:
        assert isinstance(self.type, tuple)
        return Value(f"{self.text_within(ATOM)}.i{place}", self.type[place])

    def items(self) -> list[Value]:
        return [self.item(place) for place in range(len(self.type))]

    def converted_to(self, kind: Type) -> Value:
        """Return the value as another type; only what C converts with a loss is written out."""
        if self.real and kind == REAL:
            return Value(self.real, REAL)
        if self.type == LONG and kind == REAL:
            return Value(f"(double){self.text_within(UNARY)}", REAL, UNARY)
        return self


@dataclass
class Unit:
    """One function with the types of its arguments."""

    function: FunctionType
    kinds: tuple[Type, ...]  # of its arguments
    name: str  # in C
    result: Type = NOTHING
    text: str = ""  # its definition in C
    is_inline: bool = False  # wherever it is called
    # names of the functions that it calls, but for those behind a test that is rarely true
    often: set[str] = field(default_factory=set)


def common_type(kinds: Sequence[Type]) -> Type:
    """Return the type that can hold values of all types; raise ``CannotExport`` without one."""
    if all(kind == kinds[0] for kind in kinds):
        return kinds[0]
    numbers = [kind for kind in kinds if isinstance(kind, str) and kind in NUMBERS]
    if len(numbers) == len(kinds):
        return max(numbers, key=NUMBERS.index)
    raise CannotExport(f"values of the types {', '.join(map(str, kinds))}; expected one type")
