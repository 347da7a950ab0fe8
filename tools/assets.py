"""Generate the FMUs' documentation, tables and reference results: ``python -m tools.assets``.

Pictures of the documentation, ``model.png`` and the reference results; the variable tables of
``docs/variables.md`` too. They are kept in the repository, so that an export does not depend on a
plotting library.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from orchestrate.fmu import describe, find_or_export
from orchestrate.show import figure_files

from .pictures import electrodynamic_shaker, icon, oscillator, shaker
from .references import (
    COIL,
    MODELS,
    MOTOR_SHAKER,
    REFERENCES,
    Reference,
    compute_reference_rows,
    run_and_record,
    write_reference_files,
)

TABLES = Path(__file__).resolve().parents[1] / "docs" / "variables.md"
SERIES = re.compile(r"\[(?!1\])\d+\]$")  # of a series, the first stands for all


def variable_tables_as_markdown(path: str | PathLike[str]) -> str:
    """Return an FMU's variables as Markdown tables by causality, from its model description."""
    variables = [v for v in describe(path).variables.values() if not SERIES.search(v.name)]
    lines = []
    for causality in dict.fromkeys(v.causality for v in variables):
        rows = [v for v in variables if v.causality == causality]
        with_start = any(v.start is not None for v in rows)
        heads = ["name", "unit", *["start"] * with_start, "meaning"]
        lines += [f"**{causality.capitalize()}**", "", f"| {' | '.join(heads)} |"]
        lines.append(f"|{'---|' * len(heads)}")
        for v in rows:
            tunable = " (tunable)" if v.variability == "tunable" else ""
            start = ["" if v.start is None else str(v.start)] * with_start
            cells = [f"`{v.name}`{tunable}", v.unit or v.type, *start, v.description]
            lines.append(f"| {' | '.join(cells)} |")
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def replace_variable_table(page: str, reference: Reference, table: str) -> str:
    source, end = f"fmu_src/models/{reference.folder}/variables.py", "<!-- end of variables -->"
    begin = f"<!-- variables: generated from {source}, kept so by a test -->"
    head, rest = page.split(begin + "\n")
    _, tail = rest.split(end, 1)
    return f"{head}{begin}\n{table}{end}{tail}"


def columns_of(rows: Sequence[Sequence[float]], names: Sequence[str]) -> dict[str, np.ndarray]:
    return dict(zip(("time", *names), np.array(rows, dtype=float).T, strict=True))


def simulate_oscillator_example(fmu: str | PathLike[str]) -> dict[str, np.ndarray]:
    names, eta = ("x1", "x2", "x_rel", "in_contact"), 0.4
    period = 2.0 * math.pi / eta
    times = [0.0, *(500 * period + np.linspace(0.0, 2 * period, 600))]
    box = {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
    rows = run_and_record(fmu, times, names, lambda _: {}, **box)[1:]
    return columns_of(rows, names)


def simulate_shaker_limits(fmu: str | PathLike[str]) -> dict[str, np.ndarray]:
    names = ("voltage", "current", "box_position", "limited")
    coil = {"coil_inductance": 0.02, "voltage_limit": 5.0, "current_limit": 1.0}
    times = np.linspace(0.0, 1.5, 801).tolist()
    rows = run_and_record(fmu, times, names, growing_sine_command, **coil)[1:]
    return columns_of(rows, names)


def growing_sine_command(time: float, frequency: float = 40.0) -> dict[str, float]:
    """Return command and derivatives of ``12 t sin(frequency t)``, V."""
    turn, wave = 12.0 * np.exp(1j * frequency * time), 1j * frequency
    values = [((time * wave**n + n * wave ** max(n - 1, 0)) * turn).imag for n in range(4)]
    return dict(zip(("command", "command_1", "command_2", "command_3"), values, strict=True))


def draw_and_save_documentation(
    reference: Reference, fmu: str | PathLike[str], rows: Sequence[Sequence[float]]
) -> None:
    """Draw a model's scheme, icon and example run into its documentation folder."""
    folder = MODELS / reference.folder
    tight: Any = {"dpi": 100, "bbox_inches": "tight"}
    if reference is MOTOR_SHAKER:
        scheme, image = shaker.draw_shaker(), icon.draw_motor_icon()
        values = columns_of(rows, reference.outputs)
        plot = shaker.draw_run_up(values["time"], values["speed"], values["box_position"])
    elif reference is COIL:
        scheme, image = electrodynamic_shaker.draw_shaker(), icon.draw_coil_icon()
        plot = electrodynamic_shaker.draw_limited_run(simulate_shaker_limits(fmu))
    else:
        scheme, image = oscillator.draw_scheme(), icon.draw_oscillator_icon()
        plot = oscillator.draw_example(simulate_oscillator_example(fmu))
    figure_files.save(scheme, folder / "documentation" / "scheme", **tight)
    figure_files.save(image, folder / "model", dpi=96)
    figure_files.save(plot, folder / "documentation" / "plot", ("svg",))


def main() -> None:
    # all FMUs first: what is written below belongs to their sources
    names = "fmi3", "fmi2-python"
    forms = [[find_or_export(each.model, name).path for name in names] for each in REFERENCES]
    for reference, (fmu, python_fmu) in zip(REFERENCES, forms, strict=True):
        rows = compute_reference_rows(reference, fmu)
        write_reference_files(reference, rows)
        draw_and_save_documentation(reference, fmu, rows)
        table = variable_tables_as_markdown(python_fmu)
        page = TABLES.read_text(encoding="utf-8")
        TABLES.write_text(replace_variable_table(page, reference, table), encoding="utf-8")


if __name__ == "__main__":
    main()
