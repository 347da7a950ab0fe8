"""Rates of verdicts on random beams, in a table by groups.

Judged is :meth:`.decision_rule.Beam.verdict` on the records of a :func:`.detect.beam_job`: what
``detect`` answers, without the fits, which size its answer and do not act on it.
"""

from __future__ import annotations

import math
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from orchestrate.diagnosis.decision_rule import DELAMINATED, NOT_DESCRIBED, UNDECIDED
from orchestrate.diagnosis.decision_rule import NOT_SEEN as NO_OPENING
from orchestrate.diagnosis.detect import beam_job
from orchestrate.diagnosis.hypotheses import FREE
from orchestrate.diagnosis.settings import SETTINGS
from orchestrate.errors import InputError
from orchestrate.lazy import xr
from orchestrate.model import Structure

from .recipe import KINDS, SPLIT, Conditions, Truth, draw_levels, draw_log_uniform
from .strikers import STRIKERS

REFUSED, FAILED, WRONG = "refused", "failed", "wrong"
VISIBLE = 2e-5  # m: a gap that opens less may be overlooked
OPENS = 1e-4  # m: a gap at the sensor that should be called
RATES = (1250.0, 10_000.0)  # samples a second
TIMES = (1.0, 2.0)  # of the level that a beam is drawn for
MASSES, ELEMENTS, LESS = "two masses", "finite elements", "opens less"
STRUCK, SOUND = "stops, cracks, parts", "sound"
PLANNED, TWIN = "planned", "planned, bonded"
RIGHT = {  # else what is not wrong
    **dict.fromkeys((MASSES, ELEMENTS, PLANNED), DELAMINATED),
    **dict.fromkeys((SOUND, TWIN), NO_OPENING),
}
ANYWHERE = Conditions(off=0.03, sensors=2, participation=(0.3, 1.6))  # guesses within 3 %
ON_BEAMS = Conditions(off=0.03, sensors=2, size=(0.3, 0.9), anywhere=True, sensor=(0.3, 1.0))
CONDITIONS = {"long elements": replace(ON_BEAMS, size=(0.5, 0.9))}
MAKERS = {**KINDS, **STRIKERS, "long elements": KINDS["elements"]}
TWICE = (*SPLIT, "elements", "long elements")  # drawn twice as often as the others
HARMLESS = ("sound", "hardening", "sagging", "friction", "torsion", "intact elements")
HARMLESS += ("fixture", "bearing", "washer")


def cases(kinds: Sequence[str], count: int) -> Iterator[tuple[str, int]]:
    """Yield kind and number of each beam, all kinds by turns."""
    for turn in range(count):
        for kind in kinds:
            numbers = (2 * turn, 2 * turn + 1) if kind in TWICE else (turn,)
            yield from ((kind, number) for number in numbers)


def judged_beam(seed: int, kind: str, number: int) -> dict[str, Any]:
    """Draw a beam, measure it at two levels, and judge the records as a user may have them."""
    begin, rng = time.process_time(), np.random.default_rng([seed, [*MAKERS].index(kind), number])
    conditions = CONDITIONS.get(kind, ON_BEAMS if "elements" in kind else ANYWHERE)
    rate = draw_log_uniform(rng, *RATES)
    low, high = draw_levels(rng, kind, conditions, rate, MAKERS, TIMES)
    first, second = (case.record.drop_vars("acceleration2") for case in (low, high))
    answers = {
        "one sensor, L": judged([first], low.guess, low.truth),
        "L and 2 L, no guess": judged([first, second], None, high.truth),
        "one sensor, 2 L": judged([second], high.guess, high.truth),
        "two sensors, L": judged([low.record], low.guess, low.truth),
    }
    gaps = [1e3 * case.truth.seen_gap for case in (low, high)]
    numbers = {"rate": rate, "noise": low.truth.setup.noise, "level": low.truth.setup.level}
    return {**numbers, "mm": gaps, "s": time.process_time() - begin, "answers": answers}


def judged(records: list[xr.Dataset], guess: Structure | None, truth: Truth) -> dict[str, str]:
    """Return the verdict on records of one beam, its reason, and what is wrong with it."""
    verdict, reason, smallest = verdict_on(records, guess)
    problem = verdict_problem(verdict, truth, reason, smallest)
    return {"group": group_of(truth), "verdict": verdict, "reason": reason, "problem": problem}


def verdict_on(records: list[xr.Dataset], guess: Structure | None) -> tuple[str, str, float]:
    """Return the verdict on a beam, why, and the smallest opening that would be seen, m."""
    try:
        beam = beam_job(records, guess, FREE, None, SETTINGS).beam()
    except InputError as error:
        return REFUSED, str(error), 0.0
    return beam.verdict(), beam.reason(), beam.records[-1].smallest


def group_of(truth: Truth) -> str:
    """Return the row of the table for a beam at one level."""
    if not truth.is_delaminated:
        return SOUND if truth.kind in HARMLESS else STRUCK
    if not (truth.touched and truth.seen_gap >= OPENS):
        return LESS
    return MASSES if math.isnan(truth.size) else ELEMENTS


def table_rows(lines: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the table of judged beams: counts of verdicts, and the share that is right."""
    counts: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    for line in lines:
        for asked, answer in line["answers"].items():
            problem = {WRONG: bool(answer["problem"])}
            counts[answer["group"], asked].update({answer["verdict"]: 1, **problem})
    columns = (DELAMINATED, NO_OPENING, UNDECIDED, NOT_DESCRIBED, REFUSED, WRONG)
    yield f"{'':42}" + "".join(f"{column:>17}" for column in (*columns, "n", "% right"))
    for group in (MASSES, ELEMENTS, LESS, STRUCK, SOUND, PLANNED, TWIN):
        for asked in dict.fromkeys(asked for own, asked in counts if own == group):
            row = counts[group, asked]
            total = row.total() - row[WRONG]
            right = row[RIGHT[group]] if group in RIGHT else total - row[WRONG]
            numbers = [*(row[column] for column in columns), total, round(100.0 * right / total, 1)]
            yield f"{group:21}{asked:21}" + "".join(f"{number:17}" for number in numbers)


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
