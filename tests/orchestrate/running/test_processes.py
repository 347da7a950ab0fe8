"""Scripts of users on processes and threads, interrupted and killed: the same bytes in the end."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from ..cli.commands import all_end, below, chunks_in, wait_for

ROOT = Path(__file__).resolve().parents[3]
HEAD = """
import signal, sys
from pathlib import Path
import numpy as np
from orchestrate import Structure, sweep
from orchestrate.running.runner import answer
from tests.orchestrate.running.sums import Model, Squares
signal.signal(signal.SIGINT, signal.default_int_handler)  # where tests run in the background
running = {"store": Path(sys.argv[1]), "jobs": int(sys.argv[2]), "progress": False}
print("begun", flush=True)
"""
SQUARES = f"""{HEAD}
fmu = running["store"].with_suffix(".fmu")
fmu.write_bytes(b"an FMU")
job = Squares("squares", size=120, pause=0.1)
print(float(answer(job, running, lambda model: Model(fmu, model)).square[-1]))
"""


def start(script: str, store: Path, *arguments: object) -> subprocess.Popen[str]:
    """Start a script without a ``__main__`` guard, in a session of its own."""
    path = store.parent / "script.py"
    path.write_text(script)
    return subprocess.Popen(
        [sys.executable, *map(str, (path, store, *arguments))],
        cwd=store.parent,
        env={**os.environ, "PYTHONPATH": str(ROOT), "SOURCE_DATE_EPOCH": "0"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize(("number", "at_work"), [(signal.SIGKILL, True), (signal.SIGINT, False)])
def test_workers_end_with_the_process_they_work_for(tmp_path, number, at_work):
    """At work: they have computed a chunk; else they begin."""
    process, journal = start(SQUARES, tmp_path / "result.nc", 2), tmp_path / "result.nc.journal"
    wait_for(lambda: len(list(below(process.pid))) >= 3, process, "workers were there")
    wait_for(lambda: not at_work or chunks_in(journal) > 3, process, "they have computed")
    workers = list(below(process.pid))
    begun = time.monotonic()
    os.killpg(process.pid, number) if number == signal.SIGINT else process.kill()
    _, err = process.communicate(timeout=20)
    assert all_end(workers) and time.monotonic() - begun < 10
    assert err.count("KeyboardInterrupt") == (number == signal.SIGINT), err  # none of a worker
    assert journal.exists()
