"""Break one module: ``python -m tests.mutation MODULE TABLE.csv --budget 100 --seed 1``.

Each breakage is written into a copy of the tree, where a fork that has loaded the libraries already
runs the module's tests. What was noticed once stays noticed; what was not is asked again when the
tests have changed.
"""

import argparse
import csv
import hashlib
import os
import random
import resource
import shutil
import sys
import tempfile
import time
from pathlib import Path

import hypothesis  # noqa: F401  # what the forks share
import mpmath  # noqa: F401
import netCDF4  # noqa: F401
import pytest
import scipy.signal  # noqa: F401
import scipy.stats  # noqa: F401
import xarray  # noqa: F401

from .breakages import breakages
from .subjects import SUBJECTS

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 3.0  # times the unbroken tests' time on a processor
OPTIONS = ["-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
OWN = ("tests", "fmu_src", "orchestrate", "tools")
NOTICED, SURVIVED = "noticed", "survived"
COLUMNS = ("line", "broken", "outcome", "tests", "by")


def copy_of_the_tree(folder):
    """Copy what the tests need; a broken kernel makes FMUs of its own there."""
    for name in (*OWN, "examples", "docs", "build"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "LICENSE", "README.md"):
        shutil.copy(ROOT / name, folder)


class FirstFailure:
    """A plugin that writes which test fails first to a file that is open."""

    def __init__(self, heard):
        self.heard = heard

    def pytest_runtest_logreport(self, report):
        if report.failed:
            os.write(self.heard, report.nodeid.encode())


def run_tests(folder, tests, seconds, heard):
    """Run tests in a folder for so long on a processor; never returns."""
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    os.chdir(folder)
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    sys.dont_write_bytecode = True
    for name in [name for name in sys.modules if name.split(".")[0] in OWN]:
        del sys.modules[name]
    sys.path[:] = [str(folder), *(part for part in sys.path if part not in ("", str(ROOT)))]
    present = [name for name in tests if Path(name).exists()]
    os._exit(int(pytest.main([*OPTIONS, *present], plugins=[FirstFailure(heard)])))


def outcome(folder, tests, seconds=1800):
    """Return whether tests fail in a folder or take too long, their time on a processor, and which
    test fails first: empty where it is the import, or time runs out.
    """
    with tempfile.TemporaryFile() as heard:
        child = os.fork()
        if child == 0:
            run_tests(folder, tests, seconds, heard.fileno())
        _, status, used = os.wait4(child, 0)
        heard.seek(0)
        return status != 0, used.ru_utime + used.ru_stime, heard.read().decode()


def digest(tests):
    """What the tests are, to ask the survivors again when they change."""
    texts = [(ROOT / name).read_bytes() for name in tests if (ROOT / name).exists()]
    return hashlib.sha256(b"\0".join(texts)).hexdigest()[:12]


def rows_of(table):
    """The rows of a table by their breakage."""
    if not table.exists():
        return {}
    with table.open(newline="") as file:
        return {(row["line"], row["broken"]): row for row in csv.DictReader(file)}


def break_module(module, table, budget, seed, seconds, again, thresholds):
    """Break a module in as many ways as budget and time allow, and write the table after each."""
    begun = time.monotonic()
    tests, chosen = SUBJECTS[module], breakages((ROOT / module).read_text())
    known = {(one.text, one.broken) for one in chosen}
    if thresholds:
        chosen = [one for one in chosen if one.threshold]
    before = {key: row for key, row in rows_of(table).items() if key in known}
    if budget and budget < len(chosen):
        chosen = random.Random(seed).sample(chosen, budget)
    token = digest(tests)
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home).resolve()
        copy_of_the_tree(folder)
        target = folder / module
        source = target.read_text()
        failed, usual, _ = outcome(folder, tests)
        assert not failed, f"{module}: its tests fail before it is broken"
        target.write_text(f"raise RuntimeError\n{source}")
        assert outcome(folder, tests)[0], f"{module}: its tests do not import it"
        for one in chosen:
            key = (one.text, one.broken)
            old = before.get(key)
            if old and (old["outcome"] == NOTICED or (old["tests"] == token and not again)):
                continue
            target.write_text(one.source)
            failed, _, by = outcome(folder, tests, int(10.0 + PATIENCE * usual))
            result = NOTICED if failed else SURVIVED
            before[key] = dict(zip(COLUMNS, (*key, result, token, by), strict=True))
            write(table, before.values())
            if seconds and time.monotonic() - begun > seconds:
                break
    keys = [(one.text, one.broken) for one in chosen]
    return [before[key]["outcome"] for key in keys if key in before]


def write(table, rows):
    """Write a table whole, so that an interrupted run loses one breakage at most."""
    table.parent.mkdir(parents=True, exist_ok=True)
    part = table.with_suffix(".part")
    with part.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    part.replace(table)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("module", choices=list(SUBJECTS))
    parser.add_argument("table", type=Path)
    parser.add_argument("--budget", type=int, default=0, help="breakages; 0: all")
    parser.add_argument("--seed", type=int, default=1, help="of the choice")
    parser.add_argument("--seconds", type=float, default=0.0, help="at most; 0: any")
    parser.add_argument("--again", action="store_true", help="ask all survivors again")
    parser.add_argument("--thresholds", action="store_true", help="fields of Settings alone")
    asked = vars(parser.parse_args())
    results = break_module(**asked)
    print(f"{asked['module']},{len(results)},{results.count(NOTICED)}")


if __name__ == "__main__":
    main()
