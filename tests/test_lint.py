"""Style, format and types of the whole tree: ruff and mypy have nothing to say."""

import subprocess
import sys

import pytest

from tests import ROOT

from .sparing import ordinary

COMMANDS = {
    "ruff check": ("ruff", "check", "--output-format", "concise", "--no-cache", "."),
    "ruff format": ("ruff", "format", "--check", "--no-cache", "."),
    "mypy": ("mypy", "--cache-dir"),
}


@pytest.mark.parametrize("name", ordinary(COMMANDS, 2))
def test_finds_nothing(name, tmp_path):
    """Nothing is written into the tree, so that runs side by side do not meet."""
    cache = [str(tmp_path)] if name == "mypy" else []
    command = [sys.executable, "-m", *COMMANDS[name], *cache]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-8000:] + done.stderr[-2000:]
