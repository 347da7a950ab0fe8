"""Write the paper's report: one HTML page with claims and pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from markupsafe import Markup

from ..files import write_atomically
from ..show.page import Page, Section, Table
from .claims import NO, PARTLY, WORDS
from .pictures import PARTS
from .resolution import Resolution
from .typeset import typeset

TITLE = "A vibro-impacting model for the detection of delamination"
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
ABOUT = """The paper, recomputed through the FMU: its Figures 5 to 12, its claims, and what it
could not ask. The text of the paper that this is made from names no authors, no year and no DOI.
Resolution: {size.name}, {count:,} frequencies sampled at $n = {size.transient}(1){last}$, phase
curves after {size.skip} periods over {size.keep}. All numbers are in the paper's units. A ± is
one standard error, everywhere."""
REDUCED = """Reduced resolution: transients are cut short, so limits at high frequency and all
counts are less certain than in the full report."""
CLAIMS = """A printed number counts as found when what is found rounds to it; a limit is given
twice, where the sweep passes it and where it is, and is borne out in part where the paper's
number agrees with one of them. No tolerance was widened to make a claim fit. The same table is in
the file claims.json."""
CHAOS = """Largest Lyapunov exponents along the up-sweeps, {size.long_run} periods each, of
responses run on until their state repeats, at most for {stages:,} periods: chaos that dies out by
then is not counted. Chaotic: at least three standard errors above zero; neutral: a torus, or not
decided at that length; the others are periodic. Regions lie between exact limits of stability.
The largest exponent of each region is that of long runs of {long:,} periods at the two
frequencies with the largest exponents; with one standard error."""


def write_report(
    output: Path,
    pictures: Mapping[str, Path],
    content: Mapping[str, Any],
    size: Resolution,
    fmu: Any,
) -> Path:
    last = size.transient + size.samples
    about = typeset(ABOUT.format(size=size, count=len(size.etas()), last=last))
    about += f" FMU {fmu.name}, FMI {fmu.fmi_version}, {fmu.guid}, driven by FMPy."
    about += "" if size.name == "full" else f" {REDUCED}"
    sections = list(claim_sections(content, size)) if content["claims"] else []
    sections += [picture_section(name, picture) for name, picture in pictures.items()]
    text = Page(TITLE, about, sections).html().encode()
    return write_atomically(output / "report.html", lambda path: path.write_bytes(text))


def claim_sections(content: Mapping[str, Any], size: Resolution) -> Iterator[Section]:
    claims = content["claims"]
    counts = Counter(row["verdict"] for row in claims)
    rows = [(words, str(counts[verdict])) for verdict, words in WORDS.items()]
    summary = Table(("verdict", f"of {len(claims)} claims of the paper"), rows)
    yield Section("Summary", tables=[summary])
    yield Section("Claims", [CLAIMS], tables=[typeset_table("claims", map(claim_cells, claims))])
    words = CHAOS.format(size=size, stages=sum(size.stages), long=5 * size.part)
    table = typeset_table("regions", content["regions"])
    yield Section("Is it chaos?", [words], tables=[table])


def claim_cells(row: Mapping[str, str]) -> dict[str, str]:
    """Return a claim's texts, its verdict in bold where it differs from the paper."""
    words = Markup("<b>{}</b>" if row["verdict"] in (NO, PARTLY) else "{}")
    how = "; ".join(filter(None, (row["how"], row["why"])))
    return {**row, "verdict": words.format(WORDS[row["verdict"]]), "how": how}


def typeset_table(name: str, rows: Iterable[Mapping[str, str]]) -> Table:
    columns = COLUMNS[name]
    texts = (tuple(row[column] for column in columns) for row in rows)
    cells = [tuple(t if isinstance(t, Markup) else typeset(t) for t in row) for row in texts]
    return Table(tuple(columns.values()), cells)


def picture_section(name: str, picture: Path) -> Section:
    part, png = PARTS[name], picture.read_bytes()
    files = [picture.with_suffix(".pdf").name, *(f"{stem}.nc" for stem in part.files)]
    links = Markup(", ").join(Markup('<a href="{0}">{0}</a>').format(file) for file in files)
    points: list[str] = [typeset(f"How it was computed: {part.method}"), links]
    return Section(part.title, points=points, picture=png, caption=typeset(part.text))
