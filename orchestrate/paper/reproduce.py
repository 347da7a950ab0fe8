"""Reproduce the paper into one folder: results, pictures, claims and a report."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..files import make_writable_folder, write_atomically
from ..fmu import OSCILLATOR, make_fmu_finder
from ..show.figure_files import save
from .claims import read_claims
from .datasets import Datasets
from .measures import check_claims
from .measures.influence import region_table_rows
from .pictures import PARTS, picture_file_stem
from .report import write_report
from .resolution import Resolution

CLAIMS = "claims"  # the part that is no picture


@dataclass(frozen=True)
class Reproduction:
    """Claims with verdicts, and regions; paths of the pictures and of the report."""

    # `claims` and `regions`, lists of texts by name; empty where they were not asked for
    claims_and_regions: Mapping[str, Any]
    pictures: Mapping[str, Path]  # PNG files by the names of their parts
    report: Path


def reproduce(
    output: Path, resolution: Resolution, figures: Sequence[str] | None, running: Mapping[str, Any]
) -> Reproduction:
    """Compute the paper, or some parts; take stored results; write pictures, claims and report."""
    parts = select_parts(figures)
    fmu = make_fmu_finder(running)(OSCILLATOR)
    make_writable_folder(output)
    data = Datasets(output, resolution, running)
    checked = check_and_write_claims(data) if CLAIMS in parts else {"claims": [], "regions": []}
    shown = {name: PARTS[name].results(data) for name in parts if name != CLAIMS}
    pictures = {}
    for name, results in shown.items():
        figure = PARTS[name].draw(*results)
        pictures[name] = save(figure, output / picture_file_stem(name), ("png", "pdf"))[0]
    return Reproduction(checked, pictures, write_report(output, pictures, checked, resolution, fmu))


def select_parts(names: Sequence[str] | None) -> list[str]:
    known = [CLAIMS, *PARTS]
    chosen = known if names is None else [name.strip() for name in names]
    for name in chosen:
        if name not in known:
            raise InputError(f"unknown figure {name!r}; choose from {', '.join(known)}")
    return [name for name in known if name in chosen]


def check_and_write_claims(data: Datasets) -> dict[str, Any]:
    checked = {"claims": check_claims(read_claims(), data), "regions": region_table_rows(data)}
    text = json.dumps(checked, indent=1, ensure_ascii=False) + "\n"
    write_atomically(data.folder / "claims.json", lambda path: path.write_text(text, "utf-8"))
    return checked
