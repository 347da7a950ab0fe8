"""Campaign on memory: instances, steps and long sweeps give back what they take."""

from __future__ import annotations

import os
import resource
import tempfile
from pathlib import Path

from . import programs
from .campaign import BatchOutcome, Campaign
from .children import import_all

FEWEST = 5000  # frequencies: of less, what a process takes once is more than what they hold
PER_STEP = 1000  # steps for each instance, and for each frequency of the sweep
LARGEST = (
    2000.0  # bytes that a frequency may hold: it has a state and a dozen numbers in the result
)


class LeakCampaign(Campaign):
    """Campaign: instances, steps and sweeps do not make memory grow."""

    name = "leaks"
    title = "Leaks"
    asks = (
        "An instance is made, set, run, saved, restored and freed for each thousand steps of "
        "another one that stays, natively: after the first tenth the heap does not grow by a "
        "byte. And for each thousand steps a sweep has a frequency: the greatest memory of its "
        "process, against that of a sweep of a tenth, grows by less than 2,000 bytes a frequency, "
        "about what the result holds; there are 5,000 frequencies at least."
    )
    unit, target, batch = "steps", 100_000_000, 10_000_000
    measures = "bytes a frequency"

    def run(self, fmu: Path, seed: int, count: int) -> BatchOutcome:
        """Create, step and free instances; compare the memory before and after."""
        number = max(10, count // PER_STEP)
        grown, more, failed = map(int, programs.run_program(fmu, "leaks", number, count).split())
        notes = [
            f"{what}: {value} bytes"
            for what, value in (("instances", grown), ("steps", more))
            if value > 0
        ]
        import_all()
        along = max(FEWEST, number)
        few, many = (peak_memory(fmu, part) for part in (along // 10, along))
        each = max(0.0, (many - few) / (along - along // 10))
        if each > LARGEST:
            notes.append(f"a frequency: {each:.0f} bytes")
        if failed:
            notes.append(f"{failed} steps failed")
        counts = {"instances:": number, "frequencies:": along}
        return BatchOutcome(count, len(notes), each, counts, tuple(notes))


def peak_memory(fmu: Path, number: int) -> int:
    """Compute a sweep in a child; return the child's peak memory, bytes."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            compute_sweep(fmu, number)
            peak_now = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
            os.write(writer, str(peak_now).encode())
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as told:
        size = told.read()
    os.waitpid(child, 0)
    return int(size)


def compute_sweep(fmu: Path, number: int) -> None:
    """Compute a sweep of ``number`` frequencies with a result file in a temporary folder."""
    import numpy as np

    import orchestrate

    with tempfile.TemporaryDirectory(prefix="vibroimpact-trust-") as folder:
        orchestrate.sweep(
            orchestrate.Structure.nondimensional(),
            eta=np.linspace(0.9, 1.3, number),
            transient=2,
            samples=1,
            jobs=1,
            fmu=fmu,
            progress=False,
            store=Path(folder) / "sweep.nc",
        )
