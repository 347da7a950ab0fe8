"""Write the paper's report: one HTML page with claims and pictures."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from ..files import write_whole
from ..running.store import now
from ..show.figure_files import png_size
from ..version import __version__
from .claims import NO, PARTLY, WORDS
from .pictures import PARTS
from .resolution import Resolution
from .typeset import typeset

PAPER = {
    "title": "A vibro-impacting model for the detection of delamination",
    "source": "The text of the paper that this is made from names no authors, no year and no DOI.",
}
COLUMNS = {  # of both tables, with their headings
    "claims": {
        "section": "Section",
        "text": "The paper",
        "printed": "Paper's value",
        "found": "Found",
        "tolerance": "Tolerance",
        "verdict": "Verdict",
        "how": "How it was found, and why it differs",
    },
    "regions": {
        "case": "Case",
        "region": "Region",
        "count": "Frequencies",
        "chaotic": "Chaotic",
        "neutral": "Neutral",
        "largest": "Largest exponent",
        "verdict": "Verdict",
    },
}


def write_report(
    output: Path,
    pictures: Mapping[str, Path],
    content: Mapping[str, Any],
    size: Resolution,
    fmu: Any,
) -> Path:
    loader, strict = jinja2.PackageLoader("orchestrate.paper"), jinja2.StrictUndefined
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=strict)
    environment.filters["typeset"] = typeset
    claims, first = content["claims"], size.transient
    numbered = [{**row, "number": number} for number, row in enumerate(claims, 1)]
    page = environment.get_template("report.html.j2").render(
        **content,
        counts={verdict: sum(row["verdict"] == verdict for row in claims) for verdict in WORDS},
        differing=[row for row in numbered if row["verdict"] in (NO, PARTLY)],
        figures=[picture_entry(name, picture) for name, picture in pictures.items()],
        columns=COLUMNS,
        words=WORDS,
        paper=PAPER,
        css=Markup(environment.get_template("report.css").render()),
        version=__version__,
        date=now().replace("T", " ").removesuffix(":00Z").removesuffix("Z"),
        count=len(size.etas()),
        sampled=f"$n = {first}(1){first + size.samples}$",
        resolution=size,
        fmu=fmu,
    )
    return write_whole(output / "report.html", lambda path: path.write_bytes(page.encode()))


def picture_entry(name: str, picture: Path) -> dict[str, Any]:
    part, content = PARTS[name], picture.read_bytes()
    data = base64.b64encode(content).decode()
    return {"file": picture.stem, "part": part, "picture": data, **png_size(content)}
