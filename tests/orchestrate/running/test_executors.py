"""Who computes changes no bit; workers that are lost are told in a line, and nothing is lost."""

import os
import subprocess
import sys
import time
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from orchestrate.errors import InputError, WorkerError
from orchestrate.fmu import OSCILLATOR
from orchestrate.running import cluster, runner
from orchestrate.running.executors import compute_chunk
from orchestrate.running.identity import digests_of_code
from orchestrate.running.runner import compute_dataset
from tests import ROOT

from ..cli.commands import all_end, below, chunks_in, wait_for
from .sums import Forgetful, Gathered, Squares, Sums

JOB = Squares("squares", size=40)
JOBS = [JOB, Sums("job", size=40), Gathered("job", size=40), Forgetful("job", stubborn=(100, 140))]


@pytest.fixture(scope="module")
def dask():
    """A client of a scheduler with two workers in threads."""
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.Client(processes=False, set_as_default=False, **options) as client:
        yield client


@pytest.mark.parametrize("where", ["processes", "threads", "executor", "client", "address"])
def test_all_give_what_this_process_gives(find, monkeypatch, where, dask):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    alone = [compute_dataset(job, {"jobs": 1}, find) for job in JOBS]
    monkeypatch.setattr(runner, "MIN_PARALLEL_SECONDS", 0.0)
    monkeypatch.setattr(Squares, "in_threads", where == "threads")
    with ThreadPoolExecutor(2) as executor:
        clusters = {"executor": executor, "client": dask, "address": dask.scheduler.address}
        running = {"jobs": 2, "cluster": clusters.get(where)}
        for job, expected in zip(JOBS, alone, strict=True):
            assert compute_dataset(job, running, find).identical(expected)


class Dying(Squares):
    """Kills the process that computes its last chunks."""

    def work(self, fmus, items, previous):
        if items[0] > 6:
            os.kill(os.getpid(), 9)
        return super().work(fmus, items, previous)


def test_a_worker_that_dies_is_told_and_what_it_did_before_is_kept(find, monkeypatch, tmp_path):
    monkeypatch.setattr(runner, "MIN_PARALLEL_SECONDS", 0.0)
    with pytest.raises(WorkerError, match=r"ended without a word \(by SIGKILL\).*kept"):
        compute_dataset(Dying("dying", size=30), {"jobs": 2, "store": tmp_path / "dying.nc"}, find)
    assert (tmp_path / "dying.nc.journal").is_file()


def test_a_worker_with_other_sources_computes_nothing():
    with pytest.raises(WorkerError, match=r"other sources \(orchestrate/version\.py\)"):
        compute_chunk(JOB, {}, [1], None, (), {"orchestrate.version": "other"})
    assert compute_chunk(JOB, {}, [3], None, (), None)[1]["square"] == [9.0]


def test_workers_elsewhere_get_the_fmu_s_bytes_and_the_sources(find):
    sent = []

    class Recording(ThreadPoolExecutor):
        def submit(self, fn, *arguments):
            sent.append(arguments)
            return super().submit(fn, *arguments)

    with Recording(1) as executor:
        compute_dataset(JOB, {"cluster": executor, "jobs": 1}, find)
    for _, fmus, *_, code in sent:
        assert all(isinstance(fmu, bytes) for fmu in fmus.values())
        assert code == digests_of_code(Squares.__module__)
    assert sent


def test_an_fmu_of_somebody_else_runs_in_a_process(find, monkeypatch, tmp_path):
    running = {"jobs": 1, "fmu": {OSCILLATOR: tmp_path / "model.fmu"}}
    assert compute_dataset(Where("where"), {"jobs": 1}, find).square == os.getpid()
    assert compute_dataset(Where("a"), running, find).square != os.getpid()


class Where(Squares):
    in_threads: ClassVar[bool] = True

    def count(self):
        return 1

    def work(self, fmus, items, previous):
        return {"square": np.array([float(os.getpid())])}


class Lost:
    """A client of Dask whose scheduler ends while it is asked for something."""

    status = "running"

    def __init__(self, when="", error=None):
        self.when, self.error = when, error

    def ncores(self):
        if self.when == "ncores":
            raise OSError("in <TCP (closed)>")
        return {"one": 1}

    def get_executor(self, **_):
        return self

    def submit(self, *_):
        if self.when == "submit":
            self.status = "connecting"  # the client itself may not know before
            raise OSError("in <TCP (closed)>")
        future = Future()
        future.set_exception(self.error or CancelledError())
        return future

    def shutdown(self, wait):
        raise OSError("in <TCP (closed)>")


@pytest.mark.parametrize("when", ["ncores", "submit", "", "workers"])
def test_a_scheduler_that_ends_and_workers_that_die_are_told(find, when):
    distributed, error, words = pytest.importorskip("distributed"), None, "has ended; .* resume"
    if when == "workers":
        error = distributed.KilledWorker("compute", None, 3)
        words = "workers of the cluster ended"
    with pytest.raises(WorkerError, match=words):
        compute_dataset(JOB, {"cluster": Lost(when, error)}, find)


@pytest.mark.parametrize("error", [OSError("refused"), MemoryError("an array of 3 EiB")])
def test_where_no_scheduler_answers(find, monkeypatch, error):
    async def greet(address):
        raise error

    pytest.importorskip("distributed")
    monkeypatch.setattr(cluster, "check_scheduler", greet)
    with pytest.raises(InputError, match="no scheduler answers there"):
        compute_dataset(JOB, {"cluster": "tcp://127.0.0.1:1"}, find)


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
