"""Where users work: a script without a `__main__` guard, a notebook, and code that has changed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from ..sparing import ordinary

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "tests" / "orchestrate" / "own_question.py"
CELLS = (
    "import orchestrate\nown = orchestrate.Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3)",
    "found = orchestrate.map(own, eta=[0.6, 0.7, 0.8, 1.0], e=[0.3, 0.5, 0.7, 0.8], jobs=2,\n"
    "                        transient=300)\nfound.xi_rel_max",
    "motion = orchestrate.simulate(own, frequency=80.0, amplitude=1e-3, periods=5)",
    "%matplotlib inline\nimport matplotlib\nmatplotlib.get_backend()",
    "from orchestrate.show.lines import draw_sweep as draw\n"
    "figure = draw(orchestrate.sweep(own, eta=[1.0, 1.1], transient=50, samples=20))",
    "motion.x1.plot();",
)


def test_a_notebook(exported, tmp_path):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in CELLS])
    client = nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()
    shown = [output.get("data", {}) for output in notebook.cells[-1].outputs]
    assert any("image/png" in data for data in shown)  # our drawing has left the backend alone
    assert "text/html" in notebook.cells[1].outputs[-1]["data"]  # the dataset shows itself


def run(folder: Path, package: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """Run the script of an own question with the package that lies in a folder."""
    command = [sys.executable, str(SCRIPT), str(folder / "own.nc"), *options]
    environment = {**os.environ, "PYTHONPATH": str(package), "SOURCE_DATE_EPOCH": "0"}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )


@pytest.fixture(scope="module")
def answered(exported, tmp_path_factory):
    """A copy of the package, and the answer to the script's question made by it."""
    package = tmp_path_factory.mktemp("copy")
    for name in ("orchestrate", "fmu_src", "build"):
        shutil.copytree(ROOT / name, package / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", package)
    folder = tmp_path_factory.mktemp("answer")
    done = run(folder, package)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("begun") == 1  # a plain script: no worker has run it again
    assert "impacts per period" in done.stdout
    return package, folder


EDITS = {
    "a constant": ("orchestrate/response/respond.py", "\n", "\nADDED = 1\n"),
    "a function": (
        "orchestrate/fmu/instance.py",
        "def get(",
        "def got(self): ...\n\n    def get(",
    ),
}


@pytest.mark.parametrize("edit", ordinary(EDITS, ["a function"]))
def test_an_edit_of_the_code_makes_results_stale(answered, tmp_path, edit):
    file, old, new = EDITS[edit]
    package, answer = answered
    shutil.copytree(package, tmp_path / "edited", dirs_exist_ok=True)
    shutil.copytree(answer, tmp_path / "answer")
    path = tmp_path / "edited" / file
    head, found, rest = path.read_text().rpartition(old)
    assert found, f"{file} has no {old!r}"
    path.write_text(head + new + rest)
    before = (tmp_path / "answer" / "own.nc").read_bytes()
    done = run(tmp_path / "answer", tmp_path / "edited")
    assert "StaleError" in done.stderr
    assert file in done.stderr
    assert (tmp_path / "answer" / "own.nc").read_bytes() == before
    kept = run(tmp_path / "answer", tmp_path / "edited", "keep")
    assert kept.returncode == 0, kept.stderr
    assert "stale" in kept.stderr


def test_unedited_code_finds_its_result(answered):
    package, folder = answered
    before = (folder / "own.nc").stat().st_mtime_ns
    assert run(folder, package).returncode == 0
    assert (folder / "own.nc").stat().st_mtime_ns == before
