"""Time one FMU step called from a compiled C program."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from orchestrate.access import describe

SOURCE = Path(__file__).with_suffix(".c")
APART = {"x1_start": -1.0, "x2_start": 1e4, "box_amplitude": 1.0, "box_frequency": 0.4}


def time_quiet_step(fmu: Path, watched: bool = False, step: float = 1e-3) -> float:
    """Return the seconds of an FMI 3.0 step without an impact, called from C.

    Parameters
    ----------
    fmu : Path
    watched : bool
        Whether the largest gap of each step is asked for.
    step : float
        Communication step, s.
    """
    described = describe(fmu)
    watch = str(described.variable("x_rel_max_on").valueReference), str(int(watched))
    start = [
        text
        for name, value in APART.items()
        for text in (str(described.variable(name).valueReference), repr(value))
    ]
    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(fmu) as archive:
            (entry,) = (
                name
                for name in archive.namelist()
                if name.startswith("binaries/x86_64-linux/") and name.endswith(".so")
            )
            library = archive.extract(entry, folder)
        program = Path(folder) / "c_host"
        own = shutil.which("cc") or shutil.which("gcc")
        compiler = [own] if own else [sys.executable, "-m", "ziglang", "cc"]
        subprocess.run([*compiler, "-std=gnu11", "-O2", SOURCE, "-o", program, "-ldl"], check=True)
        command = [program, library, described.guid, *watch, repr(step), *start]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stdout) * 1e-9
