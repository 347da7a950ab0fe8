"""Long sweeps into a file take no memory for what is done; of steps, valgrind says so."""

import multiprocessing
import resource
import sys
from pathlib import Path

import numpy as np
import pytest

import orchestrate

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")
LARGEST = 2000.0  # bytes a frequency, about what the result holds


def peak_memory(store: Path, number: int) -> int:
    """Compute a sweep of ``number`` frequencies into a file; return the peak memory, bytes."""
    structure, quiet = orchestrate.Structure.nondimensional(), {"jobs": 1, "progress": False}
    etas = np.linspace(0.9, 1.3, number)
    orchestrate.sweep(structure, eta=etas, transient=2, samples=1, store=store, **quiet)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


@pytest.mark.slow
@pytest.mark.budget(5000)  # frequencies: of less, what a process takes once is more
def test_memory_does_not_grow(exported, budget, tmp_path):
    peak_memory(tmp_path / "first.nc", 10)  # what a process takes once
    peaks = []
    for number in (budget // 10, budget):
        with multiprocessing.get_context("fork").Pool(1) as pool:
            peaks.append(pool.apply(peak_memory, (tmp_path / f"{number}.nc", number)))
    assert (peaks[1] - peaks[0]) / (budget - budget // 10) < LARGEST
