"""Write the results of ``orchestrate paper`` into docs/paper.md and docs/claims.md.

    python -m tools.paper_page results/paper

keeps ``claims.json`` next to the pages and rewrites their counts and tables.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from orchestrate.files import write_atomically
from orchestrate.paper.claims import WORDS

DOCS = Path(__file__).resolve().parents[1] / "docs"
IMPLIED = re.compile(r"; the paper's number agrees with (?:both|neither)\b")  # by the verdict
MARK = "<!-- {}: {} -->\n"
PAGES, CLAIMS = (DOCS / "paper.md", DOCS / "claims.md"), DOCS / "claims.json"


def verdict_count_lines(rows: Sequence[Mapping[str, str]]) -> list[str]:
    number = Counter(row["verdict"] for row in rows)
    return [
        f"Of {len(rows)} statements of all sections {number['yes']} are borne out, "
        f"{number['partly']} in part, {number['no']} are not."
    ]


def section_table(rows: Sequence[Mapping[str, str]]) -> list[str]:
    words = [word for word in WORDS if any(row["verdict"] == word for row in rows)]
    lines = [f"| section | {' | '.join(WORDS[word] for word in words)} |"]
    lines.append(f"|{'---|' * (1 + len(words))}")
    for section in dict.fromkeys(row["section"] for row in rows):
        own = [row["verdict"] for row in rows if row["section"] == section]
        lines.append(f"| {section} | {' | '.join(str(own.count(word)) for word in words)} |")
    return lines


def claim_table(rows: Sequence[Mapping[str, str]]) -> list[str]:
    lines = []
    for section in dict.fromkeys(row["section"] for row in rows):
        lines += [f"Section {section}:", "", "| the paper | its value | computed | |"]
        lines.append("|---|---|---|---|")
        for row in rows:
            if row["section"] == section:
                texts = (row["text"], row["printed"], IMPLIED.sub("", row["found"]))
                cells = [re.sub(r"([|*_])", r"\\\1", text) for text in texts]
                lines.append(f"| {' | '.join(cells)} | {WORDS[row['verdict']]} |")
        lines.append("")
    return lines[:-1]


def region_table(rows: Sequence[Mapping[str, str]]) -> list[str]:
    names = ("region", "count", "chaotic", "neutral", "largest")
    heads = ("from, to", "frequencies", "chaotic", "neutral", "largest exponent")
    lines = []
    for case in dict.fromkeys(row["case"] for row in rows):
        lines += [f"{case}:", "", f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
        for row in rows:
            if row["case"] == case and (row["chaotic"], row["neutral"]) != ("0 %", "0 %"):
                lines.append(f"| {' | '.join(row[name] for name in names)} |")
        lines.append("")
    return lines[:-1]


def fill_page(text: str, results: Mapping[str, Any]) -> str:
    parts = {
        "counts": lambda: verdict_count_lines(results["claims"]),
        "sections": lambda: section_table(results["claims"]),
        "verdicts": lambda: claim_table(results["claims"]),
        "regions": lambda: region_table(results["regions"]),
    }
    for name, lines in parts.items():
        begin, end = (MARK.format(name, word) for word in ("begin", "end"))
        if begin in text:
            before, rest = text.split(begin)
            text = "\n".join([before + begin + lines()[0], *lines()[1:], end + rest.split(end)[1]])
    return text


def main(folder: str) -> None:
    shutil.copyfile(Path(folder) / "claims.json", CLAIMS)
    results = json.loads(CLAIMS.read_text("utf-8"))
    for path in PAGES:
        text = fill_page(path.read_text("utf-8"), results)
        write_atomically(path, partial(Path.write_text, data=text, encoding="utf-8"))


if __name__ == "__main__":
    main(*sys.argv[1:])
