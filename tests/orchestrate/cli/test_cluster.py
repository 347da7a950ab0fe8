"""A command on the workers of a Dask scheduler: the same bytes as here, though a worker is lost."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import pytest

from orchestrate.cli import main

from .commands import PATIENCE, ROOT, end, wait_for

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="process groups")
RUN = (
    *("map", "--eta", "1.1:1.3:0.01", "--over", "e", "--values", "0.3:0.8:0.05"),
    *("--transient", "2000", "--plot", "none"),
)
OPTIONS = ("--nthreads", "1", "--no-dashboard", "--local-directory")
Dask = tuple[subprocess.Popen[bytes], IO[str]]
Nodes = tuple[str, list[Dask]]


def start(folder: Path, name: str, *arguments: str, temporary: Path | None = None) -> Dask:
    """A process of Dask, and its log; its temporary files in a folder of their own."""
    log = (folder / f"{name}.log").open("w+")
    command = [sys.executable, "-m", "dask", *arguments]
    streams = {"stdout": log, "stderr": subprocess.STDOUT}
    surroundings = {**os.environ, **({"TMPDIR": str(temporary)} if temporary else {})}
    process = subprocess.Popen(
        command, cwd=ROOT, env=surroundings, start_new_session=True, **streams
    )
    return process, log


def read(dask: Dask, pattern: str) -> str:
    """Wait until a log has what a pattern describes."""
    stop = time.monotonic() + PATIENCE
    while True:
        dask[1].seek(0)
        found = re.search(pattern, text := dask[1].read())
        if found:
            return found.group()
        assert time.monotonic() < stop and dask[0].poll() is None, text
        time.sleep(0.05)


def end_all(started):
    """Kill those processes that still run, wait for all of them, and close their logs."""
    for process, log in started:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        log.close()


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Nodes]:
    """Address of a scheduler on loopback; the scheduler and its two workers, one with a nanny."""
    pytest.importorskip("distributed")
    options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    started = [start(tmp_path, "scheduler", "scheduler", *options)]
    try:
        address = read(started[0], r"tcp://127\.0\.0\.1:\d+")
        for nanny in ("--no-nanny", "--nanny"):
            (folder := tmp_path / nanny).mkdir()
            arguments = ("worker", address, nanny, *OPTIONS, str(tmp_path))
            started.append(start(tmp_path, nanny, *arguments, temporary=folder))
        for dask in started[1:]:
            read(dask, "Registered to")
        yield address, started
    finally:
        end_all(started)


@pytest.mark.slow  # 10 s
def test_a_lost_worker_loses_nothing_and_the_other_leaves_no_fmu(
    commands, cluster, tmp_path, monkeypatch
):
    address, (_, *workers) = cluster
    process = commands.start(*RUN, "--cluster", address)
    wait_for(lambda: commands.chunks() >= 2, process, "two chunks were on disk")
    os.kill(workers[0][0].pid, signal.SIGKILL)
    done = end(process)
    assert done.code == 0, done.err
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    assert main([*RUN, "--output", str(tmp_path / "here")]) == 0
    here = {path.name: path.read_bytes() for path in (tmp_path / "here").glob("*.nc")}
    assert commands.results() == here and len(here) == 1
    temporary = tmp_path / "--nanny"
    assert list(temporary.glob("vibroimpact*")), "the worker had no FMU"
    workers[1][0].send_signal(signal.SIGTERM)
    workers[1][0].wait(60.0)
    assert not list(temporary.glob("vibroimpact*"))
