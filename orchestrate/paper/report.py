"""The report: one HTML page that needs no network, with the claims, and each picture with its caption and how it was computed."""

import base64
from importlib import import_module

import jinja2

from .. import __version__
from ..store import write_whole
from .claims.claim import WORDS


def write(output, parts, pictures, content):
    """Write ``report.html``.

    Parameters
    ----------
    output : Path
    parts : list of Part
        Those with a picture, in their order.
    pictures : list of Path
        PNG files.
    content : dict
        ``resolution``, ``fmu`` and, where it was computed, ``claims``.

    Returns
    -------
    Path
    """
    environment = jinja2.Environment(loader=jinja2.PackageLoader("orchestrate.paper"), autoescape=True, undefined=jinja2.StrictUndefined)
    claims = content["claims"]
    counts = {verdict: sum(row["verdict"] == verdict for row in claims) for verdict in WORDS}
    figures = [entry(part, picture) for part, picture in zip(parts, pictures, strict=True)]
    text = environment.get_template("report.html.j2").render(figures=figures, counts=counts, words=WORDS, version=__version__, **content)
    path = output / "report.html"
    write_whole(path, text.encode())
    return path


def entry(part, picture):
    """What the page shows of a part."""
    module = import_module(f"orchestrate.figures.{part.module}")
    return {
        "anchor": part.module,
        "title": getattr(module, "TITLE", f"Figure {part.name}"),
        "caption": module.CAPTION,
        "method": module.METHOD,
        "picture": base64.b64encode(picture.read_bytes()).decode(),
        "data": [f"{name}.nc" for name in part.jobs],
    }
