"""Each module's tests notice nine of ten breakages of it; those of the list change no answer.

``python -m pytest tests/mutation -m slow -k first_root``, with ``--budget 50`` for as many by
chance; tables are in ``results/mutation`` and are resumed.
"""

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from .subjects import SUBJECTS

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "results" / "mutation"
HARMLESS = Path(__file__).with_name("harmless.csv")


def harmless(module):
    """What changes no answer, by line and broken line, with its reason."""
    with HARMLESS.open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["module"] == module]
    return {(row["line"], row["broken"]): row["reason"] for row in rows}


@pytest.mark.slow
@pytest.mark.parametrize("module", SUBJECTS)
def test_the_tests_notice_what_is_broken(module, request):
    table = TABLES / f"{Path(module).stem}.csv"
    options = ["--budget", request.config.getoption("--budget") or 0]
    options += ["--seed", request.config.getoption("--seed")]
    command = [sys.executable, "-m", "tests.mutation", module, table, *options]
    subprocess.run([str(part) for part in command], cwd=ROOT, check=True)
    with table.open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["outcome"] == "survived"]
        file.seek(0)
        count = sum(1 for _ in csv.DictReader(file))
    left = [row for row in rows if (row["line"], row["broken"]) not in harmless(module)]
    text = "\n".join(f"{row['line']}  ->  {row['broken']}" for row in left)
    assert len(left) <= 0.1 * count, f"{module}: {len(left)} of {count} are not noticed:\n{text}"


def test_what_is_called_harmless_is_a_breakage_of_the_present_source():
    """A line that changes has to be looked at again."""
    from .breakages import breakages

    with HARMLESS.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for module in {row["module"] for row in rows}:
        known = {(one.text, one.broken) for one in breakages((ROOT / module).read_text())}
        assert set(harmless(module)) <= known
    assert all(row["reason"] for row in rows)


@pytest.mark.parametrize("module", SUBJECTS)
def test_the_tests_of_a_subject_exist(module):
    assert all((ROOT / name).exists() for name in (module, *SUBJECTS[module]))
