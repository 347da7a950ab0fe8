"""``examples/ci``: the guarantees in a user's own pipeline, where there is nothing but FMPy."""

import re
import shutil
import subprocess
import sys

import pytest

from tests import ROOT

from ..sparing import ordinary
from .driver import FMUS, environment_of_users


def run_pipeline(fmu, folder):
    """The test file alone in a folder, as a user has it."""
    shutil.copy(ROOT / "examples" / "ci" / "test_fmu.py", folder)
    environment = environment_of_users(PYTHONDONTWRITEBYTECODE="1", FMU=str(fmu))
    options = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:hypothesispytest"]
    command = [sys.executable, "-m", "pytest", *options, "test_fmu.py"]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("form", ordinary(["fmi3", "fmi2", "fmi2-python"]))
def test_the_example_passes_on_the_exported_file(form, tmp_path):
    done = run_pipeline(FMUS[form], tmp_path)
    assert done.returncode == 0, done.stdout[-3000:]
    assert int(re.search(r"(\d+) passed", done.stdout).group(1)) > 25
