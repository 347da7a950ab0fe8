"""A claim of the paper as a record: what it says, how it is checked, what is found."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from .results import Edges, Results

YES, PARTLY, NO = "yes", "partly", "no"
WORDS = {YES: "borne out", PARTLY: "in part", NO: "not borne out"}


@dataclass(frozen=True)
class Finding:
    """What was found for a claim.

    Attributes
    ----------
    value : str
    verdict : str
        Of ``WORDS``.
    why : str
        A sentence with numbers where the verdict is not plain.
    """

    value: str
    verdict: str
    why: str = ""


Check = Callable[[Results], Finding]


@dataclass(frozen=True)
class Claim:
    """One claim.

    Attributes
    ----------
    section : str
    text : str
        What the paper says.
    printed : str
        Its value, as printed.
    how : str
        How it is found.
    tolerance : str
    check : callable
        From :class:`.results.Results` to a :class:`Finding`.
    """

    section: str
    text: str
    printed: str
    how: str
    tolerance: str
    check: Check

    def row(self, results: Results) -> dict[str, str]:
        """The claim with its finding, as plain text."""
        finding = self.check(results)
        names = ("section", "text", "printed", "how", "tolerance")
        return {
            **{name: getattr(self, name) for name in names},
            "found": finding.value,
            "verdict": finding.verdict,
            "why": finding.why,
        }


def half_unit(printed: str) -> float:
    """Half a unit of the last digit of a printed number: what rounds to it lies that near."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


def rounds_to(value: float, printed: str) -> bool:
    """Whether a value rounds to a printed number."""
    return abs(value - float(printed)) <= half_unit(printed) + 1e-9


def limit_at(edges: Edges, printed: str, why: str = "") -> Finding:
    """The finding for a limit between two frequencies: do they touch what rounds to the printed?"""
    (low, high), slack = edges, half_unit(printed) + 1e-9
    found = low <= float(printed) + slack and high >= float(printed) - slack
    return Finding(f"between {low:.3f} and {high:.3f}", YES if found else NO, why)


def number_at(value: float, printed: str, digits: int, why: str = "") -> Finding:
    """The finding for a number."""
    return Finding(f"{value:.{digits}f}", YES if rounds_to(value, printed) else NO, why)


def holds(parts: Iterable[bool], value: str, why: str = "") -> Finding:
    """The finding for a statement with several parts that each hold or do not."""
    parts = list(parts)
    return Finding(value, YES if all(parts) else PARTLY if any(parts) else NO, why)
