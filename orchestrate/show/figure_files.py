"""Save figures to PNG, PDF or SVG files atomically."""

from __future__ import annotations

import io
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from ..errors import InputError
from ..files import write_atomically
from .style import set_title, style_context

SLIDE_HEIGHT, SLIDE_PART, SLIDE_PIXELS = 4.2, 0.75, 1920.0  # inches at least, of its own; across
UNDATED: dict[str, dict[str, Any]] = {  # the same figure is the same bytes, today and tomorrow
    "pdf": {"CreationDate": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": "matplotlib"},
}


def save(
    figure: Figure, path: str | Path, formats: Iterable[str] = ("png",), **options: Any
) -> list[Path]:
    written = []
    for ending in formats:
        write = partial(write_figure, figure, ending=ending, **options)
        written.append(write_atomically(f"{path}.{ending}", write))
    return written


def png_bytes(figure: Figure) -> bytes:
    file = io.BytesIO()
    write_figure(figure, file, "png")
    return file.getvalue()


def write_figure(figure: Figure, file: Path | io.BytesIO, ending: str, **options: Any) -> None:
    with style_context():
        figure.savefig(file, format=ending, metadata=UNDATED.get(ending), **options)


def parse_slide_shape(size: str) -> tuple[float, float] | None:
    """Return width and height of a shape such as ``16:9``; None of an empty one."""
    try:
        width, height = map(float, size.split(":")) if size else (1.0, 1.0)
        if not (0.1 <= width / height <= 10.0):
            raise ValueError
    except (ValueError, ZeroDivisionError):
        raise InputError(f"size = {size}: expected W:H such as 16:9") from None
    return (width, height) if size else None


def resize_for_slide(figure: Figure, shape: tuple[float, float] | None) -> Figure:
    """Give a figure the shape of a slide, if any, so small that its letters are large on it."""
    if shape is None:
        return figure
    height = max(SLIDE_HEIGHT, SLIDE_PART * figure.get_figheight())
    width = height * shape[0] / shape[1]
    figure.set_size_inches(width, height)
    set_title(figure, figure.get_suptitle().replace("\n", " "))
    figure.set_dpi(SLIDE_PIXELS / width)
    return figure
