"""Option ``--overlay``: draw stored branches over the picture of responses."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from .options import FunctionOptions
from .output import digest
from .question import Draw, draw_result, is_curve, read_earlier_result

if TYPE_CHECKING:
    from ..structures import Structure


def add_overlay_option(question: FunctionOptions) -> None:
    """Add ``--overlay FILE``, which may be repeated."""
    text = (
        "NetCDF file of a branch that is drawn over the picture, solid where stable, dashed where "
        "not; may be repeated"
    )
    option = question.group.add_argument
    option("--overlay", type=Path, action="append", default=[], metavar="FILE", help=text)


def drawing_function(
    arguments: argparse.Namespace, structure: Structure, question: Mapping[str, Any]
) -> tuple[Draw | None, str]:
    """Return the function that draws a result (None: no curve), and a picture-name ending."""
    if not arguments.overlay:
        return draw_result if is_curve(question) else None, ""
    if not is_curve(question):
        raise InputError("--overlay: one value has no picture; expected a range or a list")
    from ..figures.overlay import explain_mismatch

    over = question.get("over") or ("eta" if "eta" in question else "frequency")
    parameters = structure.parameters()
    if arguments.command == "resonance":  # of both
        parameters.pop("bonded")
    branches = [read_earlier_result("--overlay", path) for path in arguments.overlay]
    for path, branch in zip(arguments.overlay, branches, strict=True):
        why = explain_mismatch(branch, over, parameters)
        if why:
            raise InputError(f"--overlay {path}: {why}")
    return partial(draw_result, overlay=branches), f"over_{digest(*branches)}"
