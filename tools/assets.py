"""Generate the FMUs' documentation, tables and reference results: ``python -m tools.assets``.

Pictures of the documentation, ``model.png`` and the reference results; the variable tables of
``docs/variables.md`` too. They are kept in the repository, so that an export does not depend on a
plotting library.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from orchestrate.access import Instance, describe, find
from orchestrate.figures import files

from .pictures import icon, oscillator
from .pictures import shaker as shaker_pictures
from .references import MODELS, REFERENCES, SHAKER, Reference, reference_rows, write_reference

TABLES = Path(__file__).resolve().parents[1] / "docs" / "variables.md"
SERIES = re.compile(r"\[(?!1\])\d+\]$")  # of a series, the first stands for all


def table_marks(reference: Reference) -> tuple[str, str]:
    """Return the comment lines that stand before and after a model's variable table."""
    source = f"fmu_src/models/{reference.folder}/variables.py"
    begin = f"<!-- variables: generated from {source}, kept so by a test -->"
    return begin, "<!-- end of variables -->"


def variable_table(path: str | PathLike[str]) -> str:
    """Return an FMU's variables as a Markdown table, from its model description."""
    lines = ["| name | causality | unit | start | meaning |", "|---|---|---|---|---|"]
    for v in describe(path).variables.values():
        if SERIES.search(v.name):
            continue
        parameter = v.causality == "parameter"
        kind = f"parameter, {v.variability}" if parameter else v.causality
        start = "" if v.start is None else v.start
        lines.append(f"| `{v.name}` | {kind} | {v.unit or v.type} | {start} | {v.description} |")
    return "\n".join(lines) + "\n"


def replace_table(page: str, reference: Reference, table: str) -> str:
    """Return a page's text with a model's variable table replaced."""
    begin, end = table_marks(reference)
    head, rest = page.split(begin + "\n")
    _, tail = rest.split(end, 1)
    return f"{head}{begin}\n{table}{end}{tail}"


def simulate_example(
    fmu: str | PathLike[str],
    eta: float = 0.4,
    transient: int = 500,
    periods: int = 2,
    points: int = 600,
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Simulate two settled periods of the paper's Figure 5; return times and values by name."""
    names = ("x1", "x2", "x_rel", "in_contact")
    period = 2.0 * math.pi / eta
    times = [0.0, *(transient * period + np.linspace(0.0, periods * period, points))]
    rows = []
    with Instance(fmu) as instance:
        instance.initialize(0.0, box_amplitude=1.0 / eta**2, box_frequency=eta)
        for time, target in itertools.pairwise(times):
            instance.step(time, target)
            rows.append([float(value) for value in instance.get(*names)])
    return np.array(times[1:]), dict(zip(names, np.array(rows).T, strict=True))


def draw_documentation(
    reference: Reference, fmu: str | PathLike[str], rows: Sequence[Sequence[float]]
) -> None:
    """Draw a model's scheme, icon and example run into its documentation folder."""
    folder = MODELS / reference.folder
    shaker = reference is SHAKER
    scheme = shaker_pictures.draw_shaker if shaker else oscillator.draw_scheme
    tight: Any = {"dpi": 100, "bbox_inches": "tight"}
    files.save(scheme(), folder / "documentation" / "scheme", **tight)
    files.save(icon.draw_icon(shaker), folder / "model", dpi=96)
    if shaker:
        values = dict(zip(("time", *reference.outputs), np.array(rows).T, strict=True))
        plot = shaker_pictures.draw_run_up(values["time"], values["speed"], values["box_position"])
    else:
        plot = oscillator.draw_example(*simulate_example(fmu))
    files.save(plot, folder / "documentation" / "plot", ("svg",))


def main() -> None:
    """Write all generated assets of the FMUs and the documentation."""
    for reference in REFERENCES:
        fmu = find(reference.model).path
        rows = reference_rows(reference, fmu)
        write_reference(reference, rows)
        draw_documentation(reference, fmu, rows)
        table = variable_table(find(reference.model, "fmi2-python").path)
        page = TABLES.read_text(encoding="utf-8")
        TABLES.write_text(replace_table(page, reference, table), encoding="utf-8")


if __name__ == "__main__":
    main()
