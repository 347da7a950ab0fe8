"""Workers end with the process they work for, however it is killed; what they did is kept."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from ..cli.commands import all_end, below, chunks_in, wait_for

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = """
import sys
from pathlib import Path
from orchestrate.running.runner import compute_dataset
from tests.orchestrate.running.sums import Model, Squares
store = Path(sys.argv[1])
fmu = store.with_suffix(".fmu")
fmu.write_bytes(b"an FMU")
running = {"store": store, "jobs": 2, "progress": False}
compute_dataset(Squares("squares", size=120, pause=0.1), running, lambda model: Model(fmu, model))
"""


@pytest.mark.slow
def test_workers_end_with_the_process_they_work_for(tmp_path):
    """A script of a user, without a ``__main__`` guard."""
    store, script = tmp_path / "result.nc", tmp_path / "script.py"
    script.write_text(SCRIPT)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command, pipe = [sys.executable, str(script), str(store)], subprocess.PIPE
    process = subprocess.Popen(command, env=environment, stdout=pipe, stderr=pipe, text=True)
    journal = Path(f"{store}.journal")
    wait_for(lambda: chunks_in(journal) > 3, process, "they have computed")
    workers, begun = list(below(process.pid)), time.monotonic()
    process.kill()
    process.communicate(timeout=20)
    assert len(workers) >= 3 and all_end(workers) and time.monotonic() - begun < 10
    assert journal.exists()
