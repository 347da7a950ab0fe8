"""Save pictures as PNG files with a small palette, to keep the repository small."""

from __future__ import annotations

import io
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from orchestrate.files import write_atomically
from orchestrate.show.figure_files import png_bytes

COLOURS = 128  # more are not seen in lines and letters


def save_with_few_colours(figure: Figure, path: Path) -> None:
    write_png_with_few_colours(png_bytes(figure), path)


def write_png_with_few_colours(png: bytes, path: Path) -> None:
    with Image.open(io.BytesIO(png)) as picture:
        few = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)

    write_atomically(path, lambda place: few.save(place, format="png", optimize=True))
