"""Judge random cases one by one: a line of JSON for each, so that a run resumes."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

Line = dict[str, Any]


def judged_cases(
    judge: Callable[[int, str, int], Line],
    cases: Iterable[tuple[str, int]],
    seed: int,
    budget: float,
    out: Path,
) -> list[Line]:
    """Judge cases (kind and number) until the processor time (s) is spent; return their lines.

    Each has a generator of its own, and one that stands in the file is not judged again.
    """
    out.touch()
    lines = {
        (line["seed"], line["kind"], line["number"]): line
        for line in map(json.loads, out.read_text("utf-8").splitlines())
    }
    chosen = [(seed, kind, number) for kind, number in cases]
    for key in chosen:
        if key in lines or time.process_time() > budget:
            continue
        lines[key] = {**dict(zip(("seed", "kind", "number"), key, strict=True)), **judge(*key)}
        with out.open("a", encoding="utf-8") as file:
            file.write(json.dumps(lines[key]) + "\n")
    return [lines[key] for key in chosen if key in lines]
