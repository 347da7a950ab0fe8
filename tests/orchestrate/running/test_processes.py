"""Processes, scripts and kills: what happens outside the test's own process."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from orchestrate.running.journal import journal_path

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = Path(__file__).parent / "long_job.py"
SIZE = 240


def start(store: Path, jobs: int, **environment: str) -> subprocess.Popen[str]:
    """Start a script without a ``__main__`` guard that computes on processes of its own."""
    command = [sys.executable, str(SCRIPT), str(store), str(jobs), str(SIZE)]
    return subprocess.Popen(
        command,
        cwd=store.parent,
        env={**os.environ, "PYTHONPATH": str(ROOT), "SOURCE_DATE_EPOCH": "0", **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def children(session: int) -> list[int]:
    """Processes of a session that are alive."""
    listed = subprocess.run(["ps", "-o", "pid=,stat=", "-s", str(session)], capture_output=True)
    rows = [line.split() for line in listed.stdout.decode().splitlines()]
    return [int(pid) for pid, state in rows if not state.startswith("Z")]


def test_a_plain_script_needs_no_guard(tmp_path):
    process = start(tmp_path / "result.nc", 2)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert out.splitlines() == ["begun", f"{(SIZE - 1) ** 2}.0"]  # once: no worker ran the script


@pytest.mark.slow
@pytest.mark.parametrize("jobs", [1, 2])
def test_killed_at_random_moments_it_goes_on_with_equal_bytes(tmp_path, jobs):
    whole = tmp_path / "whole.nc"
    assert start(whole, 1).wait(timeout=60) == 0
    broken, draw = tmp_path / "broken.nc", random.Random(jobs)
    for _ in range(3):
        process = start(broken, jobs)
        time.sleep(draw.uniform(0.5, 2.0))
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    process = start(broken, jobs)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert broken.read_bytes() == whole.read_bytes()
    assert not journal_path(broken).exists()


def test_workers_end_with_the_process_they_work_for(tmp_path):
    process = start(tmp_path / "result.nc", 2)
    stop = time.monotonic() + 30
    while len(children(process.pid)) < 3 and time.monotonic() < stop:
        time.sleep(0.05)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    while children(process.pid) and time.monotonic() < stop:
        time.sleep(0.1)
    assert children(process.pid) == []


def test_an_interrupt_ends_it_at_once(tmp_path):
    process = start(tmp_path / "result.nc", 2, PYTHONFAULTHANDLER="1")
    stop = time.monotonic() + 30
    while len(children(process.pid)) < 3 and time.monotonic() < stop:
        time.sleep(0.05)
    begun = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert time.monotonic() - begun < 10
    assert err.count("KeyboardInterrupt") == 1, err  # the script's own, none of a worker
    assert journal_path(tmp_path / "result.nc").exists()
