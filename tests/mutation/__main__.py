"""Break one module: ``python -m tests.mutation MODULE TABLE.csv --budget 100 --seed 1``.

Each breakage is made in a fork that has loaded the module and its tests already, see
:mod:`.in_memory`; what cannot be made there is "unchanged" and is not judged. What was noticed once
stays noticed; what was not is asked again when the tests have changed.
"""

import argparse
import csv
import hashlib
import importlib
import os
import random
import resource
import sys
import tempfile
import time
from pathlib import Path

import pytest
from hypothesis import Phase, settings

from .breakages import breakages
from .in_memory import become
from .subjects import SUBJECTS, harmless

ROOT = Path(__file__).resolve().parents[2]
PATIENCE = 3.0  # times the unbroken tests' time on a processor
OPTIONS = ["-x", "-q", "-n", "0", "-p", "no:cacheprovider"]
NOTICED, SURVIVED, UNCHANGED = "noticed", "survived", "unchanged"
ENDS = {0: SURVIVED, 77: UNCHANGED}  # by how a fork ends
COLUMNS = ("line", "broken", "outcome", "tests", "by")


def loaded(file):
    return importlib.import_module(file.removesuffix(".py").replace("/", "."))


class FirstFailure:
    """A plugin that writes which test fails first to a file that is open."""

    def __init__(self, heard):
        self.heard = heard

    def pytest_runtest_logreport(self, report):
        if report.failed:
            os.write(self.heard, report.nodeid.encode())


def run_tests(module, source, tests, seconds, heard):
    """Run tests on a module with another source, for so long on a processor; never returns."""
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    code = 1
    try:
        before = Path(module.__file__).read_text()
        if source != before and not become(module, before, source):
            os._exit(77)
        code = int(pytest.main([*OPTIONS, *tests], plugins=[FirstFailure(heard)]))
    finally:
        os._exit(code)


def outcome(module, source, tests, seconds=1800):
    """Return what becomes of a source, its tests' time on a processor, and which test fails first:
    empty where time runs out.
    """
    with tempfile.TemporaryFile() as heard:
        child = os.fork()
        if child == 0:
            run_tests(module, source, tests, seconds, heard.fileno())
        _, status, used = os.wait4(child, 0)
        heard.seek(0)
        end = ENDS.get(os.waitstatus_to_exitcode(status), NOTICED)
        return end, used.ru_utime + used.ru_stime, heard.read().decode()


def digest(tests):
    """What the tests are, to ask the survivors again when they change."""
    texts = [(ROOT / name).read_bytes() for name in tests if (ROOT / name).exists()]
    return hashlib.sha256(b"\0".join(texts)).hexdigest()[:12]


def rows_of(table):
    if not table.exists():
        return {}
    with table.open(newline="") as file:
        return {(row["line"], row["broken"]): row for row in csv.DictReader(file)}


def break_module(module, table, budget, seed, seconds, again, thresholds):
    """Break a module in as many ways as budget and time allow, but those known to change no answer;
    write the table after each.
    """
    begun = time.monotonic()
    tests, same = SUBJECTS[module], harmless(module)
    chosen = breakages((ROOT / module).read_text())
    chosen = [one for one in chosen if (one.text, one.broken) not in same]
    known = {(one.text, one.broken) for one in chosen}
    if thresholds:
        chosen = [one for one in chosen if one.threshold]
    before = {key: row for key, row in rows_of(table).items() if key in known}
    if budget and budget < len(chosen):
        chosen = random.Random(seed).sample(chosen, budget)
    token = digest(tests)
    loaded("tests/conftest.py")  # how many examples properties take, and no clock
    quick = settings(settings.default, phases=(Phase.explicit, Phase.generate))  # none is shrunk
    settings.register_profile("quick", quick)
    settings.load_profile("quick")
    for name in tests:
        loaded(name)
    assert module.removesuffix(".py").replace("/", ".") in sys.modules, f"{module}: not tested"
    own = loaded(module)
    end, usual, by = outcome(own, (ROOT / module).read_text(), tests)
    assert end == SURVIVED, f"{module}: {by} fails before it is broken"
    for one in chosen:
        key = (one.text, one.broken)
        old = before.get(key)
        if old and (old["outcome"] == NOTICED or (old["tests"] == token and not again)):
            continue
        end, _, by = outcome(own, one.source, tests, int(10.0 + PATIENCE * usual))
        before[key] = dict(zip(COLUMNS, (*key, end, token, by), strict=True))
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
