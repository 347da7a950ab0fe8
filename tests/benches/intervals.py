"""Whether 95 % intervals of ``fit`` contain the truth, on records of two masses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from orchestrate import fit
from orchestrate.diagnosis.settings import SETTINGS

from .recipe import SPLIT, draw_levels

NAMES = ("f1", "f2", "zeta1", "zeta2")


def judged_fit(seed: int, kind: str, number: int) -> dict[str, Any]:
    """Draw a beam that is delaminated, fit two masses to its record, and compare with the truth."""
    (case,) = draw_levels(np.random.default_rng([seed, SPLIT.index(kind), number]), kind)
    answer = fit(case.record, case.guess, jobs=1, progress=False)
    truth, found = case.truth, answer.reindex(parameter=list(NAMES))
    true = {name: getattr(truth.halves, name) for name in NAMES}
    numbers = {"value": found.value.values.tolist(), "error": found.standard_error.values.tolist()}
    opened = {"sensors": truth.setup.sensors, "opened": truth.opened, "mm": 1e3 * truth.seen_gap}
    return {**numbers, **opened, "true": true, "misfit": float(answer.misfit)}


def table_rows(lines: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield how many intervals are stated and contain the truth, and how far off values are."""
    yield f"{'':8}{'fitted':>10}{'valued':>10}{'interval':>10}{'holds':>10}{'median off':>12}"
    for row, name in enumerate(NAMES):
        off = [line["value"][row] / line["true"][name] - 1.0 for line in lines]
        error = [line["error"][row] / line["true"][name] for line in lines]
        stated = [(a, b) for a, b in zip(off, error, strict=True) if math.isfinite(b)]
        holds = sum(abs(a) <= 1.96 * b for a, b in stated)
        usual = float(np.median([abs(one) for one in off if math.isfinite(one)] or [math.nan]))
        numbers = f"{len(off):10}{int(np.isfinite(off).sum()):10}{len(stated):10}{holds:10}"
        yield f"{name:8}{numbers}{usual:12.2%}"
    most = SETTINGS.delaminated
    above = [line for line in lines if line["misfit"] > most and np.isfinite(line["error"]).any()]
    yield f"intervals from a misfit above {most:g}: {len(above)}"
