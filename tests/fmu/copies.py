"""Exports of copies of the sources, in processes of their own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from ..fresh import ROOT

EXPORT = Path(__file__).with_name("programs") / "export_uncompiled.py"


def export_copy(folder, changes=(), model="TwoMassImpactOscillator", **environment):
    """Path of the pythonfmu FMU of a copy of the sources in a folder.

    Changes are a file below ``fmu_src``, text that stands there once, and what replaces it.
    """
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "fmu_src", folder / "fmu_src", ignore=ignored)
    for name, old, new in changes:
        path = folder / "fmu_src" / name
        text = path.read_text()
        assert text.count(old) == 1
        path.write_text(text.replace(old, new))
    environment = {**os.environ, "PYTHONPATH": str(folder), **environment}
    command = [sys.executable, str(EXPORT), model]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    (made,) = folder.glob("out/*/*.fmu")
    return made
