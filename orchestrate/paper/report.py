"""The report: one HTML page that needs no network, with the claims and each picture."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jinja2

from ..files import write_whole
from ..version import __version__
from .captions import CAPTIONS
from .claims.claim import WORDS
from .plan import Part


def write(
    output: Path, pictures: Mapping[str, Path], parts: Mapping[str, Part], content: dict[str, Any]
) -> Path:
    """Write ``report.html``.

    Parameters
    ----------
    output : Path
        The folder.
    pictures : mapping of Path
        PNG files by the names of their parts, in the order of the page.
    parts : mapping of Part
        By name.
    content : dict
        ``resolution``, ``fmu`` and ``claims``, ``regions`` and ``answers``, empty where they were
        not asked for.

    Returns
    -------
    Path
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("orchestrate.paper"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
    )
    claims = content["claims"]
    counts = {verdict: sum(row["verdict"] == verdict for row in claims) for verdict in WORDS}
    figures = [entry(parts[name], picture) for name, picture in pictures.items()]
    shown = {"figures": figures, "counts": counts, "words": WORDS, "version": __version__}
    page = environment.get_template("report.html.j2").render(**shown, **content)
    return write_whole(output / "report.html", lambda place: place.write_bytes(page.encode()))


def entry(part: Part, picture: Path) -> dict[str, Any]:
    """What the page shows of a part."""
    caption = CAPTIONS[part.name]
    return {
        "anchor": picture.stem,
        "title": caption.title,
        "caption": caption.text,
        "method": caption.method,
        "picture": base64.b64encode(picture.read_bytes()).decode(),
        "data": [f"{name}.nc" for name in part.jobs],
    }
