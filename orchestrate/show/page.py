"""Report page: sections, tables, pictures and verdict, rendered as HTML without scripts."""

from __future__ import annotations

import base64
import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import jinja2
from markupsafe import Markup

from ..running.store import timestamp
from ..version import __version__
from .figure_files import Figure, png_bytes

MISSING = "–"  # in place of a number
POLICY = (  # own pictures and the style with a digest, nothing else
    "default-src 'none'; style-src 'sha256-{}'; img-src data:; base-uri 'none'; form-action 'none'"
)
PLACES = ("front", "second", "appendix")  # on paper: first page, pages that follow, end


@dataclass(frozen=True)
class Table:
    """A table of texts: column titles, rows and highlighted rows."""

    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    marked: frozenset[int] = frozenset()  # rows that stand out


@dataclass(frozen=True)
class Section:
    """A part of the page: title, texts, picture and tables."""

    heading: str
    paragraphs: list[str] = field(default_factory=list)
    points: list[str] = field(default_factory=list)  # of a list
    picture: Figure | bytes | None = None  # or a PNG file
    caption: str = ""  # what the picture shows, for those who do not see it too
    tables: list[Table] = field(default_factory=list)
    place: str = "second"  # of `PLACES`

    @property
    def image(self) -> dict[str, Any]:
        """Address, width and height of the picture, which is a PNG file inside the page."""
        if self.picture is None:
            return {}
        png = self.picture if isinstance(self.picture, bytes) else png_bytes(self.picture)
        width, height = (int.from_bytes(png[start : start + 4], "big") for start in (16, 20))
        address = f"data:image/png;base64,{base64.b64encode(png).decode()}"
        return {"src": address, "width": width, "height": height}


@dataclass(frozen=True)
class Verdict:
    """The verdict at the top of the page: a word, a sentence, and a tone for its colour."""

    word: str
    sentence: str
    tone: str  # "bad", "good", "unclear" or "open"


@dataclass(frozen=True)
class Page:
    """A report page; with a verdict, what is signed comes first, and an appendix last."""

    title: str
    about: str  # below the title
    sections: list[Section]
    verdict: Verdict | None = None

    @property
    def parts(self) -> list[tuple[str, list[Section]]]:
        parts = [(place, [s for s in self.sections if s.place == place]) for place in PLACES]
        return [(place, sections) for place, sections in parts if sections]

    def html(self) -> str:
        environment = jinja2.Environment(
            loader=jinja2.PackageLoader("orchestrate.show"),
            autoescape=True,
            undefined=jinja2.StrictUndefined,
        )
        style = environment.get_template("report.css").render()
        return environment.get_template("report.html.j2").render(
            page=self,
            style=Markup(style),
            policy=POLICY.format(
                base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
            ),
            version=__version__,
            date=timestamp().replace("T", " ").removesuffix(":00Z").removesuffix("Z"),
        )


# -- numbers as texts -----------------------------------------------------------------------------


def format_number(value: float, unit: str = "", digits: int = 3) -> str:
    """Format a number with its unit; a dash for NaN or infinity."""
    if not math.isfinite(value):
        return MISSING
    factor, shown = divisor_and_unit(abs(value), unit)
    return f"{value / factor:.{digits}g} {shown}".rstrip()


def format_with_error(value: float, error: float, unit: str = "") -> str:
    if not (math.isfinite(error) and error > 0.0):
        return format_number(value, unit, 4)
    factor, shown = divisor_and_unit(max(abs(value), error), unit)
    value, error = value / factor, error / factor
    places = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{places}f} ± {error:.{places}f} {shown}".rstrip()


def divisor_and_unit(size: float, unit: str) -> tuple[float, str]:
    """Return divisor and unit for showing a number: short lengths in micrometres."""
    if unit == "m" and 0.0 < size < 1e-3:
        return 1e-6, "µm"
    return 1.0, "" if unit == "1" else unit.replace("s2", "s²")
