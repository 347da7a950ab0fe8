"""Verdicts and stated intervals of ``detect`` on random beams of the virtual benches."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterator

import pytest
import xarray as xr

import orchestrate
from orchestrate.errors import VibroimpactError
from tests.benches.recipe import Case, Setup, Truth
from tests.benches.verdicts import DELAMINATED, FAILED, NO_OPENING, REFUSED, verdict_problem
from tests.draws import draw_beam

from .findings import expect_none

FAILURES = (ArithmeticError, ValueError, LookupError, RuntimeError)  # numpy's LinAlgError is one
FITTED = ("f1", "f2", "zeta1", "zeta2", "e")  # of which the stated errors are judged
WITHIN = 1.96  # standard errors: half of an interval of 95 %


def diagnose(case: Case, counts: Counter[str]) -> str:
    """Ask about a beam, count the verdict and the intervals; return what is wrong ("")."""
    truth, answer, smallest, message = case.truth, None, 0.0, ""
    try:
        answer = orchestrate.detect(case.record, case.guess, jobs=1, progress=False)
        verdict, smallest = str(answer.verdict.item()), float(answer.smallest_opening)
    except VibroimpactError as error:
        verdict, message = REFUSED, str(error)
    except FAILURES as error:
        verdict, message = FAILED, f"{type(error).__name__}: {error}"
    counts[f"{truth.kind}, {verdict}"] += 1
    if answer is not None and verdict == DELAMINATED and truth.is_delaminated:
        for name, deviation in deviations(answer, truth):
            counts += {f"{name} stated": 1, f"{name} in its interval": abs(deviation) <= WITHIN}
    return verdict_problem(verdict, truth, message, smallest)


def deviations(answer: xr.Dataset, truth: Truth) -> Iterator[tuple[str, float]]:
    """Yield the error of each parameter over its stated one; finite elements have none of them."""
    names = [str(name) for name in answer.hypothesis.values if str(name).startswith(DELAMINATED)]
    best = min(names, key=lambda name: float(answer.misfit.sel(hypothesis=name)))
    for name in FITTED if math.isnan(truth.size) else ():
        own = answer.sel(hypothesis=best, parameter=name)
        true = truth.restitution if name == "e" else getattr(truth, name)
        deviation = (float(own.value) - true) / (float(own.standard_error) or math.nan)
        if math.isfinite(deviation):
            yield name, deviation


@pytest.mark.slow
@pytest.mark.budget(1)  # beams
def test_verdicts_on_random_beams(exported, seed, budget):
    """Beams that are none of the detector's models, with noise of 0.1 to 10 %, guesses 10 % off."""
    counts, findings = Counter[str](), []
    for number in range(budget):
        case = draw_beam(seed, number)
        if wrong := diagnose(case, counts):
            findings.append(f"beam {number}, {case.truth}: {wrong}")
    expect_none(findings, counts)


def test_what_is_wrong():
    """Sound or shut and called delaminated; open and overlooked, if it could be seen; no answer."""
    numbers = {"f1": 45.0, "f2": 45.0, "zeta1": 0.01, "zeta2": 0.01}
    beam = {**numbers, "setup": Setup(4.0, 0.02, 1, "up")}
    sound = Truth(kind="sound", is_delaminated=False, opened=False, touched=False, **beam)
    split = dataclasses.replace(
        sound, is_delaminated=True, opened=True, touched=True, seen_gap=1e-3
    )
    shut = dataclasses.replace(split, opened=False, seen_gap=-1e-6)
    noise = dataclasses.replace(split, setup=dataclasses.replace(split.setup, excitation="random"))
    assert "is sound" in verdict_problem(DELAMINATED, sound)
    assert "did not open" in verdict_problem(DELAMINATED, shut)
    assert "opened by 1 mm" in verdict_problem(NO_OPENING, split)
    assert "where 0.3 mm would have been seen" in verdict_problem(NO_OPENING, split, "", 3e-4)
    assert "refused: why" in verdict_problem(REFUSED, split, "why")
    assert "failed: why" in verdict_problem(FAILED, noise, "why")
    small, apart = (dataclasses.replace(split, **{name: 0.0}) for name in ("seen_gap", "touched"))
    right = [(DELAMINATED, split), *((NO_OPENING, one) for one in (small, apart, shut, sound))]
    right += [("not described", sound), ("undecided", split), (REFUSED, noise)]
    assert not verdict_problem(NO_OPENING, split, "", 2e-3)
    assert [pair for pair in right if verdict_problem(*pair)] == []
