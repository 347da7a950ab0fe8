"""Rates of verdicts on random beams: a table by kind, within a given processor time."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

import orchestrate

from .recipe import Conditions, Truth, draw

DELAMINATED, NO_OPENING, UNDECIDED = "delaminated", "no opening seen", "undecided"
REFUSED, FAILED, WRONG = "refused", "failed", "wrong"
VISIBLE = 2e-5  # m: a gap that opens less may be overlooked
PLACES = (0.3, 1.0)  # of the sensors on a beam of finite elements
ANYWHERE = Conditions(participation=(0.3, 1.6))  # of two masses
GROUPS: Mapping[str, tuple[str, Conditions]] = {  # name in the table -> kind, conditions
    **{kind: (kind, ANYWHERE) for kind in ("sound", "hardening", "friction", "sagging")},
    "torsion": ("torsion", replace(ANYWHERE, sensors=2)),
    "clamp": ("clamp", ANYWHERE),
    "FE sound": ("intact elements", Conditions(sensor=PLACES)),
    "delaminated": ("delaminated", ANYWHERE),
    "gap": ("gap", ANYWHERE),
    "pressed, shut": ("preloaded", replace(ANYWHERE, preload=(1.2, 1.6))),
    "pressed, opens": ("preloaded", replace(ANYWHERE, planned=True)),
    "FE 0.3 to 0.5": ("elements", Conditions(size=(0.3, 0.5), anywhere=True, sensor=PLACES)),
    "FE 0.5 to 0.7": ("elements", Conditions(size=(0.5, 0.7), anywhere=True, sensor=PLACES)),
    "torsion clamp": ("rattling torsion", replace(ANYWHERE, sensors=2)),
    "FE clamp": ("rattling elements", Conditions(sensor=PLACES)),
}


def table_rows(names: list[str], seed: int, count: int, budget: float) -> Iterator[str]:
    """Yield a line per beam, then the table; stop when the processor time (s) is spent."""
    counts = {name: Counter[str]() for name in names}
    for number in range(count):
        for name in names:
            if time.process_time() > budget:
                break
            kind, conditions = GROUPS[name]
            rng = np.random.default_rng([seed, list(GROUPS).index(name), number])
            case = draw(rng, kind, conditions)
            begin = time.process_time()
            answer = orchestrate.detect(case.record, case.guess, jobs=1, progress=False)
            verdict, smallest = str(answer.verdict.item()), float(answer.smallest_opening)
            wrong = verdict_problem(verdict, case.truth, "", smallest)
            counts[name][WRONG if wrong else verdict] += 1
            numbers = f"ratio {answer.ratio:.2f}, misfits {answer.misfit.values.round(2).tolist()}"
            spent = f"{time.process_time() - begin:.0f} s"
            yield f"{name} {number}: {verdict}; {numbers}; {spent} {wrong or case.truth}"
    columns = (DELAMINATED, NO_OPENING, UNDECIDED, "not described", WRONG)
    yield f"{'':16}" + "".join(f"{column[:16]:>17}" for column in columns)
    for name, row in counts.items():
        yield f"{name:16}" + "".join(f"{row[column]:17d}" for column in columns)


def verdict_problem(verdict: str, truth: Truth, message: str = "", smallest: float = 0.0) -> str:
    """Return what is wrong with a verdict; empty where nothing is.

    Random excitation may be refused: the detector goes by orders. An opening may be overlooked that
    is away from the sensors, or smaller there than what the detector says it would have seen.
    """
    if verdict == FAILED or (verdict == REFUSED and truth.setup.excitation != "random"):
        return f"{verdict}: {message}"
    if verdict == DELAMINATED and not truth.is_delaminated:
        return "called delaminated, and is sound"
    if verdict == DELAMINATED and not truth.opened:
        return "called delaminated, and did not open"
    visible = truth.opened and truth.touched and truth.seen_gap > max(VISIBLE, smallest)
    if verdict == NO_OPENING and visible:
        text = f"no opening seen, and it opened by {1e3 * truth.seen_gap:.3g} mm"
        return f"{text}, where {1e3 * smallest:.3g} mm would have been seen"
    return ""
