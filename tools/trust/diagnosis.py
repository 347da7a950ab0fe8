"""Campaign on diagnoses: verdicts and signs on random beams of the virtual benches."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import orchestrate
from orchestrate.errors import VibroimpactError
from tools.benches.recipe import Case, Conditions, Truth, draw

from . import signs
from .campaign import BatchOutcome, Campaign
from .diagnosis_rows import (
    COLUMNS,
    DELAMINATED,
    FAILED,
    FITTED,
    NO_OPENING,
    REFUSED,
    USUAL,
    WIDE,
)

FAILURES = (ArithmeticError, ValueError, LookupError, RuntimeError)  # numpy's LinAlgError is one
KINDS = (  # one after the other: the two that the targets are about are drawn more often
    *("sound", "delaminated", "hardening", "delaminated", "friction", "gap"),
    *("sound", "preloaded", "clamp", "delaminated", "intact elements", "elements", "sagging"),
)
PART_USUAL = 0.6
VISIBLE = 2e-5  # m: a gap that opens less may be overlooked


class DiagnosisCampaign(Campaign):
    """Campaign: verdicts on random beams, judged by the truth."""

    name = "diagnosis"
    title = "Is this beam delaminated?"
    asks = (
        "`detect` is asked about records of beams that are none of its models: two masses with "
        "compliant contact (a spring with a dashpot, Hunt and Crossley, Hertz), with a gap, "
        "pressed together, with friction; bonded beams that are linear, harden or soften, sag, "
        "have dry friction, or rattle in their clamp; cantilevers of finite elements, delaminated "
        "from their free end or not. Swept 20 to 90 Hz in 40 s or otherwise, one or two sensors "
        "with gains off by 3 %, delays, noise of 0.1 to 10 %; masses and frequencies of the guess "
        "off by up to 10 %. A finding is a sound beam, or one that did not open, that is called "
        "delaminated; or no opening seen in a beam whose faces struck each other and parted, at "
        "the sensor or elsewhere, by more than 0.02 mm and more than the detector says that it "
        "would have seen at the sensor; or no verdict at all. Random excitation is refused: the "
        "detector goes by orders."
    )
    unit = "beams"
    target = 500
    batch = 1  # a run may be stopped after any beam
    measures = "error of f1 or f2, in percent, where a beam is rightly called delaminated"
    package = True

    def run(self, fmu: Path, seed: int, count: int) -> BatchOutcome:
        """Draw beams, shake them, and diagnose their records; return the outcome."""
        rows, notes, counts = [], [], Counter[str]()
        for number in range(count):
            case = draw_case(seed, number)
            row = judge_case(case)
            rows.append([row[name] for name in COLUMNS])
            counts[f"{row['kind']}, {row['verdict']}:"] += 1
            if row["wrong"]:
                notes.append(
                    f"seed {seed}, beam {number}: {describe_beam(case.truth)}: {row['wrong']}"
                )
        places = [COLUMNS.index(name) for name in ("f1 error", "f2 error")]
        errors = [abs(row[at]) for row in rows for at in places if row[at] is not None]
        worst = 100.0 * max(errors, default=0.0)
        return BatchOutcome(count, len(notes), worst, dict(counts), tuple(notes), tuple(rows))

    def report(self, rows: Sequence[Sequence[Any]]) -> list[str]:
        """Return the tables for the ledger's page."""
        from . import diagnosis_tables

        return diagnosis_tables.table_lines(rows)

    def draw(self, rows: Sequence[Sequence[Any]], folder: Path) -> list[Path]:
        """Draw the ROC curves for the ledger's page; return their paths."""
        from . import diagnosis_tables

        return [diagnosis_tables.draw(rows, folder / diagnosis_tables.PICTURE)]


def draw_case(seed: int, number: int) -> Case:
    """Draw a beam of a batch; its kind follows from its number and seed."""
    rng = np.random.default_rng([seed, number])
    kind = KINDS[(seed + number) % len(KINDS)]
    noise = USUAL if rng.random() < PART_USUAL else WIDE
    return draw(rng, kind, Conditions(noise=noise, excitation="any"))


def judge_case(case: Case) -> dict[str, Any]:
    """Return a row of results on a case: truth, signs, and the detector's verdict."""
    truth, setup = case.truth, case.truth.setup
    begin = time.process_time()
    verdict, parameters, message = run_detector(case)
    seconds = time.process_time() - begin
    right = verdict == DELAMINATED
    errors = frequency_errors(parameters, truth) if right else {}
    deviations = normalized_deviations(parameters, truth) if right else {}
    return {
        "kind": truth.kind,
        "delaminated": int(truth.is_delaminated),
        "opened": int(truth.opened),
        "touched": int(truth.touched),
        "gap": round_or_none(truth.largest_gap),
        "noise": round_or_none(setup.noise),
        "level": round_or_none(setup.level),
        "sensors": setup.sensors,
        "excitation": setup.excitation,
        "size": round_or_none(truth.size),
        "clearance": round_or_none(truth.clearance),
        "change": round_or_none(truth.change),
        "order ratio": round_or_none(signs.order_ratio(case.record)),
        "kurtosis": round_or_none(signs.kurtosis_above(case.record)),
        "verdict": verdict,
        "ratio": round_or_none(parameters.get("ratio", math.nan)),
        **{f"{name} error": errors.get(name) for name in ("f1", "f2")},
        **{f"{name} deviation": deviations.get(name) for name in FITTED},
        "seconds": round_or_none(seconds),
        "wrong": verdict_problem(verdict, truth, message, parameters.get("smallest", 0.0)),
    }


class DetectorAnswer(NamedTuple):
    """The detector's answer: verdict and numbers."""

    verdict: str  # or that it refused, or failed
    # the ratio of its misfits, the smallest opening that it says it would have seen; of `FITTED`
    # the values, and their standard errors
    numbers: Mapping[str, float]
    message: str = ""  # where it refused or failed


def run_detector(case: Case) -> DetectorAnswer:
    """Run :func:`orchestrate.detect` on a case; return its verdict and numbers."""
    try:
        answer = orchestrate.detect(case.record, case.guess, jobs=1, progress=False)
    except VibroimpactError as error:
        return DetectorAnswer(REFUSED, {}, str(error))
    except FAILURES as error:
        return DetectorAnswer(FAILED, {}, f"{type(error).__name__}: {error}")
    names = [str(name) for name in answer.hypothesis.values if str(name).startswith(DELAMINATED)]
    best = min(names, key=lambda name: float(answer.misfit.sel(hypothesis=name)))
    chosen = answer[["value", "standard_error"]].sel(hypothesis=best, parameter=list(FITTED))
    numbers = dict(zip(FITTED, chosen.value.values.tolist(), strict=True))
    errors = chosen.standard_error.values.tolist()
    numbers |= {f"{name} error": error for name, error in zip(FITTED, errors, strict=True)}
    numbers |= {"ratio": float(answer.ratio), "smallest": float(answer.smallest_opening)}
    return DetectorAnswer(str(answer.verdict.item()), numbers)


def frequency_errors(parameters: Mapping[str, float], truth: Truth) -> dict[str, float | None]:
    """Return relative errors of two masses' frequencies; empty for finite elements."""
    if not math.isnan(truth.size) or not truth.is_delaminated:
        return {}
    return {
        name: round_or_none(parameters[name] / getattr(truth, name) - 1.0)
        for name in ("f1", "f2")
        if math.isfinite(parameters.get(name, math.nan))
    }


def normalized_deviations(parameters: Mapping[str, float], truth: Truth) -> dict[str, float | None]:
    """Return parameters' errors over their stated standard errors; None if unknown."""
    if not math.isnan(truth.size) or not truth.is_delaminated:
        return {}
    every = {}
    for name in FITTED:
        known = truth.restitution if name == "e" else getattr(truth, name)
        stated = parameters.get(f"{name} error", math.nan)
        every[name] = round_or_none((parameters.get(name, math.nan) - known) / (stated or math.nan))
    return every


def verdict_problem(verdict: str, truth: Truth, message: str = "", smallest: float = 0.0) -> str:
    """Return what is wrong with a verdict; empty where nothing is."""
    if verdict == FAILED or (verdict == REFUSED and truth.setup.excitation != "random"):
        return f"{verdict}: {message}"
    if verdict == DELAMINATED and not truth.is_delaminated:
        return "called delaminated, and is sound"
    if verdict == DELAMINATED and not truth.opened:
        return "called delaminated, and did not open"
    visible = truth.opened and truth.touched and truth.largest_gap > max(VISIBLE, smallest)
    if verdict == NO_OPENING and visible:
        text = f"no opening seen, and it opened by {1e3 * truth.largest_gap:.3g} mm"
        return f"{text}, where {1e3 * smallest:.3g} mm would have been seen"
    return ""


def describe_beam(truth: Truth) -> str:
    """Return a few words on a beam, from its truth."""
    setup = truth.setup
    text = f"{truth.kind}, {setup.excitation}, {setup.level:.3g} m/s2, noise {setup.noise:.2g}"
    text += f", {setup.sensors} sensors"
    more = {"size": truth.size, "clearance": truth.clearance, "change": truth.change}
    shown = (f", {name} {value:.2g}" for name, value in more.items() if value and value == value)
    return text + "".join(shown)


def round_or_none(value: float) -> float | None:
    """Return a number rounded to three digits; None for NaN."""
    return float(f"{value:.3g}") if math.isfinite(value) else None
