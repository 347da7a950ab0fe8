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

from ..figures.files import png_bytes, png_size
from ..running.store import now
from ..version import __version__

MISSING = "–"  # in place of a number
TONES = ("bad", "good", "unclear", "open")  # of a verdict, for its colour


@dataclass(frozen=True)
class Picture:
    """PNG picture inside the page, with a text for those who cannot see it."""

    png: bytes
    words: str  # what it shows, for those who do not see it, and below it

    @classmethod
    def from_figure(cls, figure: Any, words: str) -> Picture:
        """Return a ``Picture`` of a Matplotlib figure."""
        return cls(png_bytes(figure), words)

    @property
    def source(self) -> str:
        """PNG file as a ``data:`` address."""
        return f"data:image/png;base64,{base64.b64encode(self.png).decode()}"

    @property
    def size(self) -> dict[str, int]:
        """Width and height in pixels."""
        return png_size(self.png)


@dataclass(frozen=True)
class Table:
    """A table of texts: column titles, rows, highlighted rows and a caption."""

    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    marked: frozenset[int] = frozenset()  # rows that stand out
    words: str = ""  # above it


@dataclass(frozen=True)
class Section:
    """A part of the page: title, texts, picture and tables."""

    heading: str
    paragraphs: list[str] = field(default_factory=list)
    points: list[str] = field(default_factory=list)  # of a list
    picture: Picture | None = None
    tables: list[Table] = field(default_factory=list)


@dataclass(frozen=True)
class Verdict:
    """The verdict at the top of the page: a word, a sentence, and a tone for its colour."""

    word: str
    sentence: str
    tone: str  # of `TONES`


@dataclass(frozen=True)
class Page:
    """A report page: title, metadata, verdict, sections, and whether it has room to sign."""

    title: str
    about: str  # below the title
    sections: list[Section]
    verdict: Verdict | None = None
    signed: bool = False  # whether there is a place for a signature

    def html(self) -> str:
        """Render the page as HTML text."""
        environment = jinja2.Environment(
            loader=jinja2.PackageLoader("orchestrate.reports"),
            autoescape=True,
            undefined=jinja2.StrictUndefined,
        )
        style = environment.get_template("report.css").render()
        return environment.get_template("report.html.j2").render(
            page=self,
            style=Markup(style),
            policy=content_security_policy(style),
            version=__version__,
            date=now().replace("T", " ").removesuffix(":00Z").removesuffix("Z"),
        )


def content_security_policy(style: str) -> str:
    """Return the page's Content-Security-Policy: own pictures and style, nothing else."""
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    allowed = f"default-src 'none'; style-src 'sha256-{digest}'; img-src data:"
    return f"{allowed}; base-uri 'none'; form-action 'none'"


# -- numbers as texts -----------------------------------------------------------------------------


def format_number(value: float, unit: str = "", digits: int = 3) -> str:
    """Format a number with its unit; a dash for NaN or infinity.

    Examples
    --------
    >>> (
    ...     format_number(0.012345, "Hz"), format_number(float("nan")),
    ...     format_number(12.0, "1"), format_number(2e-6, "m"),
    ... )
    ('0.0123 Hz', '–', '12', '2 µm')
    """
    if not math.isfinite(value):
        return MISSING
    factor, shown = display_scale(abs(value), unit)
    return f"{value / factor:.{digits}g} {shown}".rstrip()


def format_with_error(value: float, error: float, unit: str = "") -> str:
    """Format a number with its standard error, rounded to two digits of the error.

    Examples
    --------
    >>> format_with_error(42.12345, 0.0213, "Hz"), format_with_error(42.0, float("nan"), "Hz")
    ('42.123 ± 0.021 Hz', '42 Hz')
    >>> format_with_error(8437.5, 120.0, "N/m"), format_with_error(-3.4e-7, 4.4e-7, "m")
    ('8438 ± 120 N/m', '-0.34 ± 0.44 µm')
    """
    if not (math.isfinite(error) and error > 0.0):
        return format_number(value, unit, 4)
    factor, shown = display_scale(max(abs(value), error), unit)
    value, error = value / factor, error / factor
    places = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{places}f} ± {error:.{places}f} {shown}".rstrip()


def display_scale(size: float, unit: str) -> tuple[float, str]:
    """Return divisor and unit for showing a number: short lengths in micrometres."""
    if unit == "m" and 0.0 < size < 1e-3:
        return 1e-6, "µm"
    return 1.0, "" if unit == "1" else unit.replace("s2", "s²")
