"""Exports of copies of the sources, in processes of their own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from fmu_src.export import forms

from ..fresh import ROOT

EXPORT = Path(__file__).with_name("programs") / "export_uncompiled.py"


GUID = "import sys; from fmu_src.export import forms; print(forms.guid(*sys.argv[1:]))"


def copy_sources(folder, changes):
    """The sources below ``folder``, with the changes of :func:`export_copy`."""
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "fmu_src", folder / "fmu_src", ignore=ignored)
    for name, old, new in changes:
        path = folder / "fmu_src" / name
        text = path.read_text()
        assert text.count(old) == 1
        path.write_text(text.replace(old, new))


def run_there(folder, *command, **environment):
    """What a Python with the copy on its path prints."""
    environment = {**os.environ, "PYTHONPATH": str(folder), **environment}
    command = [sys.executable, *command]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout


def guid_of_copy(folder, changes, model="TwoMassImpactOscillator"):
    """The GUID that an FMU of a changed copy would bear; arguments as of :func:`export_copy`."""
    copy_sources(folder, changes)
    return run_there(folder, "-c", GUID, model, forms.PYTHON_FORM).strip()


def export_copy(folder, changes=(), model="TwoMassImpactOscillator", **environment):
    """Path of the pythonfmu FMU of a copy of the sources.

    Parameters
    ----------
    folder : Path
        Where the copy goes.
    changes : sequence of (str, str, str)
        File below ``fmu_src``, text that stands there once, and what replaces it.
    model : str
    **environment : str
        Variables of the process that exports.
    """
    copy_sources(folder, changes)
    run_there(folder, str(EXPORT), model, **environment)
    (made,) = folder.glob("out/*/*.fmu")
    return made
