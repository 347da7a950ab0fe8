"""Time one FMU step called from a compiled C program."""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests import importers

SOURCE = Path(__file__).with_suffix(".c")
APART = {"x1_start": -1.0, "x2_start": 1e4, "box_amplitude": 1.0, "box_frequency": 0.4}


def time_quiet_step(fmu: Path, with_gap_maximum: bool = False, step: float = 1e-3) -> float:
    values = {**APART, "x_rel_max_on": float(with_gap_maximum)}
    with tempfile.TemporaryDirectory() as folder:
        program = importers.compile_against(fmu, Path(folder), [SOURCE], ("-O2",))
        library = importers.unpack_binary(fmu, "fmi3", Path(folder))
        done = importers.Importer(program, library, "fmi3").run(step, *importers.settings(values))
    return float(done.stdout) * 1e-9
