"""Claims of the paper as objects: text, printed value, check function and finding."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from ..readable import plain
from .results import Edges, Limit, Results

YES, PARTLY, NO, UNDECIDED = "yes", "partly", "no", "undecided"
WORDS = {
    YES: "borne out",
    PARTLY: "in part",
    NO: "not borne out",
    UNDECIDED: "not decided at this resolution",
}
LIMIT = (
    "half a unit of the last printed digit; the sweep's limit is the middle of two frequencies, a "
    "response counts as periodic within 1 %; the exact limit to eight digits"
)
NUMBER = "half a unit of the last printed digit"
BOTH, SWEPT, EXACT, NEITHER = (
    "both",
    "the paper's protocol, not the exact limit",
    "the exact limit, not the paper's protocol",
    "neither",
)


@dataclass(frozen=True)
class Finding:
    """Result of checking a claim: a text with numbers, a verdict, and a reason."""

    value: str
    verdict: str  # of `WORDS`
    why: str = ""  # A sentence with numbers where the verdict is not plain
    agrees: str = ""  # of a limit: with which of the two that were found the paper's number agrees


Check = Callable[[Results], Finding]


@dataclass(frozen=True)
class Claim:
    """A claim of the paper with the function that checks it against results."""

    section: str
    text: str  # what the paper says
    printed: str  # its value, as printed
    how: str  # how it is found
    tolerance: str
    check: Check  # from results.Results to a Finding
    # whether it takes the full resolution to decide: the paper's 500 periods, or many starts
    full: bool = False

    def row(self, results: Results) -> dict[str, str]:
        """Check the claim; return it with its finding as a dict of texts."""
        finding = self.check(results)
        if self.full and not results.full:
            finding = Finding(finding.value, UNDECIDED)
        names = ("section", "text", "printed", "how", "tolerance")
        return {
            **{name: getattr(self, name) for name in names},
            "found": plain(finding.value),
            "verdict": finding.verdict,
            "why": plain(finding.why),
            "agrees": finding.agrees,
        }


CLAIMS: list[Claim] = []  # in the order in which their checks stand


def register_claim(
    section: str, text: str, printed: str, how: str, tolerance: str = "-", full: bool = False
) -> Callable[[Check], Check]:
    """Decorate a check function: add its claim to ``CLAIMS``; arguments as of :class:`Claim`."""

    def decorate(check: Check) -> Check:
        """Add the claim with this check function to ``CLAIMS``; return the function."""
        CLAIMS.append(Claim(section, text, printed, how, tolerance, check, full))
        return check

    return decorate


def half_unit(printed: str) -> float:
    """Return half a unit of a printed number's last digit, the tolerance of rounding."""
    return 0.5 * 10.0 ** -len(printed.partition(".")[2])


def rounds_to(value: float, printed: str) -> bool:
    """Return whether a value rounds to a printed number."""
    return abs(value - float(printed)) <= half_unit(printed) + 1e-9


def check_limit(
    edges: Edges, limit: Limit, printed: str, why: str = "", slack: float | None = None
) -> Finding:
    """Compare a printed limit with the sweep's and the exact one; return the finding."""
    low, high = edges
    near = (half_unit(printed) if slack is None else slack) + 1e-9
    swept = abs(0.5 * (low + high) - float(printed)) <= near
    exact = abs(limit.value - float(printed)) <= near
    agrees = {(True, True): BOTH, (True, False): SWEPT, (False, True): EXACT}.get(
        (swept, exact), NEITHER
    )
    value = (
        f"sweep: between {low:.3f} and {high:.3f}; exact: {limit.value:.{limit.digits}f} "
        f"({limit.kind} of {limit.orbit}); the paper's number agrees with {agrees}"
    )
    return Finding(value, {BOTH: YES, NEITHER: NO}.get(agrees, PARTLY), why, agrees)


def check_number(value: float, printed: str, digits: int, why: str = "") -> Finding:
    """Compare a computed value with a printed number by rounding; return the finding."""
    return Finding(f"{value:.{digits}f}", YES if rounds_to(value, printed) else NO, why)


def check_parts(parts: Iterable[bool], value: str, why: str = "") -> Finding:
    """Return a finding from several true or false parts: yes, in part, or no."""
    parts = list(parts)
    return Finding(value, YES if all(parts) else PARTLY if any(parts) else NO, why)
