"""Reproduce the paper into one folder: results, pictures, claims and a report."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..access import OSCILLATOR, finder
from ..files import write_whole
from ..running.options import RunOptions
from ..running.runner import answer_all
from ..running.store import load
from . import claims, plan, report
from .claims import answers
from .pictures import draw_all
from .resolution import Resolution

NOTHING: Mapping[str, Any] = {"claims": [], "regions": [], "answers": []}


@dataclass(frozen=True)
class Reproduction:
    """Claims with verdicts, paths of the pictures and of the report."""

    # `claims` and `regions`, lists of texts by name, and `answers`, sentences; empty where they
    # were not asked for
    found: Mapping[str, Any]
    pictures: Mapping[str, Path]  # PNG files by the names of their parts
    report: Path


def reproduce(
    output: Path,
    resolution: Resolution,
    figures: Sequence[str] | None,
    running: Mapping[str, object],
) -> Reproduction:
    """Compute the paper, or some figures; reuse stored results; write pictures and report."""
    whole = plan.make_plan(resolution)
    parts = whole.choose(figures)
    options, find = RunOptions.from_keywords(running), finder(running)
    answer_all(whole.jobs_for(parts), output, options, find)
    drawn = [part for part in parts if part.picture]
    pictures = draw_all(drawn, output, options.processes)
    asked = [part for part in parts if not part.picture]
    checked = check_claims(output, asked[0].jobs, resolution.decides) if asked else NOTHING
    content = {"resolution": resolution, "fmu": find(OSCILLATOR), **checked}
    return Reproduction(
        checked, pictures, report.write_report(output, pictures, whole.parts, content)
    )


def check_claims(output: Path, names: Sequence[str], full: bool) -> dict[str, Any]:
    """Check the claims against stored results; write them as JSON and return them."""
    data = {name: load(output / f"{name}.nc") for name in names}
    checked = {
        "claims": claims.check_all_claims(data, full),
        "regions": answers.region_rows(data),
        "answers": answers.answer_sentences(data),
    }
    text = json.dumps(checked, indent=1, ensure_ascii=False) + "\n"
    write_whole(output / "claims.json", lambda path: path.write_text(text, encoding="utf-8"))
    return checked
