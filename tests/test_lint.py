"""Style, format and types of the whole tree: ruff and mypy have nothing to say."""

import subprocess
import sys
from importlib import metadata

import pytest

from .fresh import ROOT

COMMANDS = {
    "ruff check": ("ruff", "check", "--output-format", "concise", "--no-cache", "."),
    "ruff format": ("ruff", "format", "--check", "--no-cache", "."),
    "mypy": ("mypy", "--cache-dir"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_finds_nothing(name, tmp_path):
    """Nothing is written into the tree, so that runs side by side do not meet."""
    numpy = tuple(map(int, metadata.version("numpy").split(".")[:2]))
    if name == "mypy" and numpy >= (2, 5):
        pytest.skip("NumPy 2.5's annotations refuse max() and argmin() of arrays in 26 places")
    cache = [str(tmp_path)] if name == "mypy" else []
    command = [sys.executable, "-m", *COMMANDS[name], *cache]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-8000:] + done.stderr[-2000:]
