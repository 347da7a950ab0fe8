"""The numbers of docs/paper.md: made from the claims that ``orchestrate paper`` has found.

    python -m tools.paper_page results/paper

keeps ``claims.json`` beside the page and writes the page's counts and its tables anew.
"""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from orchestrate.files import write_whole
from orchestrate.paper.claims.claim import WORDS
from tools.marked import put

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, CLAIMS = DOCS / "paper.md", DOCS / "claims.json"


def counts(rows: Sequence[Mapping[str, str]]) -> list[str]:
    """Return how many claims are borne out."""
    number = {verdict: sum(row["verdict"] == verdict for row in rows) for verdict in WORDS}
    return [
        f"Of {len(rows)} statements of all sections {number['yes']} are borne out, "
        f"{number['partly']} in part, {number['no']} are not."
    ]


def cell(text: str) -> str:
    """Return a text in a table's cell."""
    return text.replace("|", "\\|").replace("*", "\\*").replace("_", "\\_")


def verdicts(rows: Sequence[Mapping[str, str]]) -> list[str]:
    """Return the table of claims."""
    names = ("section", "text", "printed", "found")
    lines = ["| section | the paper | its value | found | |", "|---|---|---|---|---|"]
    for row in rows:
        cells = [cell(row[name]) for name in names]
        lines.append(f"| {' | '.join(cells)} | {WORDS[row['verdict']]} |")
    return lines


def regions(rows: Sequence[Mapping[str, str]]) -> list[str]:
    """Return the table of regions."""
    names = ("case", "region", "count", "chaotic", "neutral", "largest")
    heads = ("case", "from, to", "frequencies", "chaotic", "neutral", "largest exponent")
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    return lines + [f"| {' | '.join(row[name] for name in names)} |" for row in rows]


def page(text: str, found: Mapping[str, Any]) -> str:
    """Return the page's text with what was found."""
    text = put(text, "counts", counts(found["claims"]))
    text = put(text, "verdicts", verdicts(found["claims"]))
    text = put(text, "regions", regions(found["regions"]))
    return put(text, "answers", [f"- {sentence}" for sentence in found["answers"]])


def main(folder: str) -> None:
    """Write the page."""
    shutil.copyfile(Path(folder) / "claims.json", CLAIMS)
    text = page(PAGE.read_text("utf-8"), json.loads(CLAIMS.read_text("utf-8")))
    write_whole(PAGE, lambda place: place.write_text(text, "utf-8"))


if __name__ == "__main__":
    main(*sys.argv[1:])
