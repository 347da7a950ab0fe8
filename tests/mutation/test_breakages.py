"""Each module's tests notice nine of ten breakages of it; those of the list change no answer.

``python -m pytest tests/mutation -m slow`` takes a quarter of an hour at most: ``PART`` modules
by the seed, each for ``EACH`` seconds; ``-k first_root`` one module, ``--budget 0`` all and without
an end. Tables are in ``results/mutation``, are resumed and judged whole, from ``LEAST`` rows on.
"""

import csv
import importlib
import math
import random
import subprocess
import sys
from pathlib import Path

import pytest

from .subjects import HARMLESS, SUBJECTS, harmless

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "results" / "mutation"
USUAL, PART, EACH = 20, 4, 150  # breakages of a module; modules; s of each
LEAST = 8  # breakages: of fewer nothing is said


@pytest.mark.slow
@pytest.mark.parametrize("module", SUBJECTS)
def test_the_tests_notice_what_is_broken(module, request):
    table, budget = TABLES / f"{Path(module).stem}.csv", request.config.getoption("--budget")
    seed, name = request.config.getoption("--seed"), request.node.originalname
    items = [one for one in request.session.items if getattr(one, "originalname", "") == name]
    asked = [one.callspec.params["module"] for one in items]
    if budget is None and module not in random.Random(seed).sample(asked, min(PART, len(asked))):
        pytest.skip(f"not among the {PART} modules of seed {seed}")
    options = ["--seed", seed, "--budget", USUAL if budget is None else budget]
    options += ["--seconds", EACH] if budget is None else []
    command = [sys.executable, "-m", "tests.mutation", module, table, *options]
    subprocess.run([str(part) for part in command], cwd=ROOT, check=True)
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    judged = [row for row in rows if row["outcome"] != "unchanged"]
    left = [row for row in judged if row["outcome"] == "survived"]
    text = "\n".join(f"{row['line']}  ->  {row['broken']}" for row in left)
    chance = 2.0 * math.sqrt(0.09 * len(judged)) if budget is None else 0.0  # of a sample
    told = f"{module}, seed {seed}: {len(left)} of {len(judged)} are not noticed"
    print(told)
    if len(judged) < LEAST:
        pytest.skip(f"{told}; expected {LEAST} or more in {EACH} s")
    assert len(left) <= 0.1 * len(judged) + chance, f"{told}:\n{text}"


def test_what_is_called_harmless_is_a_breakage_of_the_present_source():
    """A line that changes has to be looked at again."""
    from .breakages import changes

    with HARMLESS.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for module in {row["module"] for row in rows}:
        known = {(one.text, one.broken) for one in changes((ROOT / module).read_text())}
        assert set(harmless(module)) <= known
    assert all(row["reason"] for row in rows)


@pytest.mark.parametrize("module", SUBJECTS)
def test_the_tests_of_a_subject_exist(module):
    assert all((ROOT / name).exists() for name in (module, *SUBJECTS[module]))


SOURCE = """
from dataclasses import dataclass
FAR = (1.0, 2.0)

@dataclass(frozen=True)
class Settings:
    near: float = 0.5

KNOWN = Settings()

def is_far(x):
    return x > FAR[1]
"""


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        *(
            ("x > FAR", "x <= FAR", [True, False, 2.0, 0.5, 0.5]),
            ("2.0", "4.0", [0, 0, 4.0, 0.5, 0.5]),
        ),
        *(("= 0.5", "= 0.7", [False, True, 2.0, 0.7, 0.7]), ("> F", "> \\\nF", None)),
    ],
)
def test_a_loaded_module_becomes_what_it_is_changed_to(tmp_path, monkeypatch, old, new, found):
    from .in_memory import become

    monkeypatch.syspath_prepend(tmp_path)
    name = f"changing_{len(list(sys.modules))}"
    (tmp_path / f"{name}.py").write_text(SOURCE)
    module = importlib.import_module(name)
    is_far, known, kind = module.is_far, module.KNOWN, module.Settings
    assert become(module, SOURCE, SOURCE.replace(old, new)) == bool(found)
    seen = [is_far(1.0), is_far(3.0), module.FAR[1], known.near, kind().near]
    assert seen == (found or [False, True, 2.0, 0.5, 0.5])
