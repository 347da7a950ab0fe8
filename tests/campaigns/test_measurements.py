"""Files of measurements from anybody: read, or refused in one line, in little time and memory."""

import logging
import random
import resource
import shutil
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.errors import InputError, StoreError
from orchestrate.running.store import load_foreign_result

from . import measurements
from .findings import expect_none

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")
SLOW, LONG = 40.0, 1300  # s that a file may take, letters of a line
MEMORY = 6 << 20  # KiB: more than readers may have, and what they begin with
PLANTED = ("json", "io", "numpy", "csv", "scipy", "netCDF4", "nptdms", "lvm_read", "pyuff")
PLANT = "open({!r}, 'w').close()\nraise SystemError('a planted module ran')\n"


def read(path: Path, kind: str, arguments: dict[str, Any]) -> xr.Dataset:
    """Read a file as a user does."""
    if kind == "stored":
        return load_foreign_result(path)
    if kind == "curve":
        return orchestrate.read_curve(path, **arguments)
    return orchestrate.read_record(path, **arguments)


def check_line(text: str) -> str:
    """Return what is wrong with a line for people; empty if nothing is."""
    return "" if text.isprintable() and 0 < len(text) < LONG else f"not a line: {text[:300]!r}"


def attack(path: Path, kind: str, arguments: dict[str, Any]) -> tuple[str, str]:
    """Read a hostile file; return its fate and what is wrong with that."""
    begun, problem, fate = time.monotonic(), "", "read"
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            data = read(path, kind, arguments)
        except (InputError, StoreError) as error:
            fate, problem = "refused", check_line(str(error))
        except BaseException as error:  # of any kind: that is the finding
            fate, problem = "raised", f"{type(error).__name__}: {str(error)[:200]!r}"
        else:
            if kind not in ("stored", "curve"):
                finite = all(np.isfinite(one.values).all() for one in data.data_vars.values())
                problem = "" if finite else "a record with numbers that are none"
    others = [str(one.message) for one in warned]
    problem = problem or next(filter(None, map(check_line, others)), "")
    seconds = time.monotonic() - begun
    return fate, problem or (f"took {seconds:.0f} s" if seconds > SLOW else "")


@pytest.mark.slow
@pytest.mark.budget(70)  # files
def test_hostile_measurements_are_read_or_refused_in_one_line(
    seed, budget, tmp_path, monkeypatch, capfd, caplog
):
    """Records, curves and stored results of every format, in a folder with planted modules."""
    findings, counts, folder = [], Counter[str](), tmp_path / "zip"
    folder.mkdir()
    ran = tmp_path / "ran"
    for name in PLANTED:
        (folder / f"{name}.py").write_text(PLANT.format(str(ran)))
    measurements.record()  # what is imported late would be the planted ones, by the path below
    monkeypatch.chdir(folder)
    kinds = list(measurements.FORMATS)
    caplog.set_level(logging.WARNING)
    before = sorted(folder.iterdir())
    for number in range(budget):
        draw, kind = random.Random(f"{seed} {number}"), kinds[number % len(kinds)]
        path, harm = measurements.write_hostile(kind, folder, draw)
        kept = path.read_bytes() if path.stat().st_size < 1 << 20 else b""
        arguments = measurements.reading(kind, draw)
        fate, problem = attack(path, kind, arguments)
        path.unlink()
        strays = [one for one in folder.iterdir() if one not in before] + [ran] * ran.exists()
        texts = [*capfd.readouterr(), *(one.getMessage() for one in caplog.records)]
        caplog.clear()
        problem = problem or (f"left {strays}" if strays else "")
        problem = problem or (f"printed {texts}"[:200] if any(texts) else "")
        counts[f"{kind} {fate}"] += 1
        if problem:
            findings.append(f"file {number} ({kind}, {harm}, {arguments}): {problem}")
            (tmp_path / f"finding{number}{path.suffix}").write_bytes(kept)
    shutil.rmtree(folder)
    whose = resource.RUSAGE_CHILDREN, resource.RUSAGE_SELF
    largest = [resource.getrusage(who).ru_maxrss for who in whose]
    if max(largest) > MEMORY:
        findings.append(f"{largest} KiB of memory in readers and here")
    expect_none(findings, counts)
