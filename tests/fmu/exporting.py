"""Exports of copies of the sources, in processes of their own."""

import os
import shutil
import subprocess
import sys

from ..fresh import ROOT

# Without the compiled kernel, which takes a while: what is told from an export here does not depend
# on it.
EXPORT = """
from pathlib import Path
from fmu_src.export import pythonfmu_form
from fmu_src.export.linking import NoCompiler
from fmu_src.models.FOLDER.model import MODEL

def no_compiler(*_):
    raise NoCompiler("not wanted here")

pythonfmu_form.compile_objects = no_compiler
pythonfmu_form.export(MODEL, "KERNEL", "FOLDER", Path("out"))
"""


def export_copy(folder, changes=(), packages=("oscillator", "oscillator"), **environment):
    """Path of the pythonfmu FMU of a copy of the sources.

    Parameters
    ----------
    folder : Path
        Where the copy goes.
    changes : sequence of (str, str, str)
        File below ``fmu_src``, text that stands there once, and what replaces it.
    packages : (str, str)
        Kernel and model.
    """
    shutil.copytree(
        ROOT / "fmu_src", folder / "fmu_src", ignore=shutil.ignore_patterns("__pycache__")
    )
    for name, old, new in changes:
        path = folder / "fmu_src" / name
        text = path.read_text()
        assert text.count(old) == 1
        path.write_text(text.replace(old, new))
    environment = {**os.environ, "PYTHONPATH": str(folder), **environment}
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            EXPORT.replace("KERNEL", packages[0]).replace("FOLDER", packages[1]),
        ],
        cwd=folder,
        capture_output=True,
        text=True,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    (made,) = (folder / "out").iterdir()
    return made
