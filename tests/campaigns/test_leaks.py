"""Instances, steps and long sweeps give back the memory that they take."""

from __future__ import annotations

import multiprocessing
import resource
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

import orchestrate

from . import programs
from .findings import expect_none

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="programs for Linux")
FEWEST = 5000  # frequencies: of less, what a process takes once is more than what they hold
PER_STEP = 1000  # steps for each instance, and for each frequency of the sweep
LARGEST = 2000.0  # bytes a frequency, about what the result holds


def peak_memory(number: int) -> int:
    """Compute a sweep of ``number`` frequencies in a child; return its peak memory, bytes."""
    with multiprocessing.get_context("fork").Pool(1) as pool:
        return pool.apply(sweep_and_measure, (number,))


def sweep_and_measure(number: int) -> int:
    """Compute a sweep into a file; return this process's peak memory, bytes."""
    structure = orchestrate.Structure.nondimensional()
    with tempfile.TemporaryDirectory(prefix="vibroimpact-campaign-") as folder:
        quiet = {"jobs": 1, "progress": False, "store": Path(folder) / "sweep.nc"}
        etas = np.linspace(0.9, 1.3, number)
        orchestrate.sweep(structure, eta=etas, transient=2, samples=1, **quiet)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


@pytest.mark.slow
@pytest.mark.budget(5_000_000)  # steps
def test_memory_does_not_grow(fmu, budget):
    """Natively by no byte after the first tenth; of a sweep by what a frequency's results take."""
    number = max(10, budget // PER_STEP)
    grown, more, failed = map(int, programs.run_program(fmu, "leaks", number, budget).split())
    along = max(FEWEST, number)
    sweep_and_measure(10)  # what a process takes once
    few, many = (peak_memory(part) for part in (along // 10, along))
    each = (many - few) / (along - along // 10)
    findings = [f"instances: {grown} bytes"] * (grown > 0) + [f"steps: {more} bytes"] * (more > 0)
    findings += [f"{failed} steps failed"] * (failed > 0)
    findings += [f"a frequency: {each:.0f} bytes"] * (each > LARGEST)
    expect_none(findings, {"instances": number, "bytes a frequency": each})
