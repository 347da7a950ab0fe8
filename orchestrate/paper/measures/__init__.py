"""The measures of the paper's claims, by section, and the loop from the table to verdicts."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from ..claims import NO, PARTLY, Claim, judge, replace_symbols_by_words
from ..datasets import Datasets
from . import equations, influence, limits, peaks, setup, windows

Measure = Callable[..., Any]  # from the datasets and the claim to a ``Measured``
MODULES = (setup, equations, limits, windows, influence, peaks)


def find_measure(name: str) -> Measure:
    """Return the measure of a name; raise KeyError where there is none."""
    return {key: value for module in MODULES for key, value in vars(module).items()}[name]


def check_claims(claims: Iterable[Claim], data: Datasets) -> list[dict[str, str]]:
    """Measure and judge each claim; return a row of texts for each."""
    rows = []
    for claim in claims:
        measured = find_measure(claim.measure)(data, claim, **claim.parse_arguments())
        verdict = judge(measured.parts, data.size.has_full_transients or not claim.full)
        row = {n: getattr(claim, n) for n in ("section", "text", "printed", "how", "tolerance")}
        row |= {"found": replace_symbols_by_words(measured.text), "verdict": verdict}
        rows.append({**row, "why": claim.why * (verdict in (NO, PARTLY))})
    return rows
