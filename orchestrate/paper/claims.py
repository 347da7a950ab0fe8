"""The paper's claims: a table, measures of its rows, and one rule from a measure to a verdict."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any, NamedTuple

YES, PARTLY, NO, UNDECIDED = "yes", "partly", "no", "undecided"
WORDS = {
    YES: "borne out",
    PARTLY: "in part",
    NO: "not borne out",
    UNDECIDED: "not decided at this resolution",
}


class Measured(NamedTuple):
    """What was measured: a text with the numbers, and which parts of the claim hold."""

    text: str
    parts: Sequence[bool]


@dataclass(frozen=True)
class Claim:
    """A row of the table ``claims.csv``."""

    # what the paper says where, and its value
    section: str
    text: str
    printed: str
    measure: str  # name of a function of measures, from the datasets and the claim
    arguments: str  # keywords of the measure
    # how it is measured, for people
    how: str
    tolerance: str
    full: str  # not empty: it takes the paper's 500 periods, or many starts, to decide
    why: str  # what a reader has to know where it differs

    def parse_arguments(self) -> dict[str, Any]:
        """Return the measure's further arguments, numbers as floats."""
        pairs = (word.split("=") for word in self.arguments.split())
        return {name: float(x) if x[0].isdigit() and "T" not in x else x for name, x in pairs}

    @property
    def rounding_tolerance(self) -> float:
        """Half a unit of the printed number's last digit, the tolerance of rounding."""
        return 0.5 * 10.0 ** -len(self.printed.partition(".")[2]) + 1e-9

    def is_rounded_to_printed(self, value: float) -> bool:
        return abs(value - float(self.printed)) <= self.rounding_tolerance


def read_claims() -> list[Claim]:
    text = resources.files("orchestrate.paper").joinpath("claims.csv").read_text("utf-8")
    return [Claim(**row) for row in csv.DictReader(text.splitlines())]


def judge(parts: Iterable[bool], decides: bool = True) -> str:
    """Return the verdict of a claim from the parts of it that hold.

    - Undecided: nothing was measured, or it takes the full resolution.
    - Borne out: all parts hold.
    - In part: some do.
    - Not borne out: none does.
    """
    parts = [bool(part) for part in parts]
    if not parts or not decides:
        return UNDECIDED
    return YES if all(parts) else PARTLY if any(parts) else NO


SIGNS = {"+-": "±", "<=": "≤", ">=": "≥"}
WORDS_OF_VALUES = {"nan": "not found", "True": "yes", "False": "no", "inf": "without bound"}


def replace_symbols_by_words(text: str) -> str:
    """Return a sentence with nan, True, inf and +- replaced by words and signs."""
    values = rf"\b({'|'.join(WORDS_OF_VALUES)})\b"
    text = re.sub(values, lambda match: WORDS_OF_VALUES[match[0]], text)
    for sign, better in SIGNS.items():
        text = text.replace(sign, better)
    return text
