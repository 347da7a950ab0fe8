"""Dask schedulers and workers killed while a command computes."""

from __future__ import annotations

import asyncio
import functools
import os
import random
import signal
import sys
import time
from collections.abc import Callable, Coroutine
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from .findings import expect_none
from .trials import Trial, attack, format_end, message_problem

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")

START = 60.0  # s
CONNECTING = 1.0  # s


def fork_coroutine(life: Callable[[], Coroutine[Any, Any, None]], log: Path) -> int:
    """Fork a process that runs a coroutine; return its process id."""
    pid = os.fork()
    if pid:
        return pid
    try:
        os.setsid()
        where = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(where, 1)
        os.dup2(where, 2)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        asyncio.run(life())
    finally:
        os._exit(1)


class DaskNodes:
    """A Dask scheduler and two workers as processes."""

    def __init__(self, folder: Path) -> None:
        """Create the folder and start scheduler and workers."""
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.pids = folder, []  # type: Path, list[int]
        self.start()

    def start(self) -> None:
        """Start the scheduler at an address of its own, and its workers."""
        path = self.folder / "address"
        path.unlink(missing_ok=True)
        self.scheduler = fork_coroutine(lambda: run_scheduler(path), self.folder / "log")
        self.pids.append(self.scheduler)
        stop = time.monotonic() + START
        while not path.exists():
            assert time.monotonic() < stop, (self.folder / "log").read_text()[-1000:]
            time.sleep(0.01)
        self.address = path.read_text()
        self.workers = [self.start_worker() for _ in range(2)]

    def start_worker(self, version: str = "") -> int:
        """Start one more worker; ``version`` makes its sources differ."""
        folder = str(self.folder)
        pid = fork_coroutine(lambda: run_worker(self.address, folder, version), self.folder / "log")
        self.pids.append(pid)
        return pid

    def kill(self, pid: int) -> None:
        """Kill the scheduler's or a worker's process by SIGKILL."""
        if pid in self.pids:
            self.pids.remove(pid)
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)

    def close(self) -> None:
        """End the scheduler's and all workers' processes."""
        for pid in list(self.pids):
            self.kill(pid)


async def run_scheduler(place: Path) -> None:
    """Run a scheduler that writes its address to a file."""
    from distributed import Scheduler

    async with Scheduler(host="127.0.0.1", port=0, dashboard=False) as scheduler:
        partial = place.with_suffix(".partial")
        partial.write_text(scheduler.address)
        partial.rename(place)
        await scheduler.finished()


async def run_worker(address: str, folder: str, version: str) -> None:
    """Run a worker of the scheduler at an address."""
    from distributed import Worker

    if version:
        from orchestrate.running import executors

        original = executors.code_digests
        executors.code_digests = lambda module: {**original(module), "orchestrate.version": version}
    options: dict[str, Any] = {"nthreads": 1, "local_directory": folder, "dashboard": False}
    async with Worker(address, **options) as worker:
        await worker.finished()


@dataclass
class ClusterTrial(Trial):
    """Trial of a command that computes on a cluster."""

    nodes: DaskNodes

    def arguments(self) -> list[str]:
        """Return the arguments of the command."""
        return [*super().arguments(), "--cluster", self.nodes.address]

    def wait_a_moment(self) -> None:
        """Wait for a random moment of the command, after it has connected."""
        time.sleep(self.chance.uniform(0.0, self.seconds + CONNECTING))


def kill_worker(trial: ClusterTrial) -> str:
    """Kill one of two workers; another one joins later. Return what is wrong ("")."""
    child = trial.start()
    trial.wait_a_moment()
    trial.nodes.kill(trial.nodes.workers.pop(trial.chance.randrange(2)))
    trial.nodes.workers.append(trial.nodes.start_worker())
    ended = child.wait()
    return format_end(ended) if ended.code else trial.result_problem()


def kill_scheduler(trial: ClusterTrial) -> str:
    """Kill the scheduler; check the error line, go on elsewhere. Return what is wrong ("")."""
    child = trial.start()
    trial.wait_a_moment()
    trial.nodes.kill(trial.nodes.scheduler)
    ended = child.wait()
    trial.nodes.close()
    trial.nodes.start()
    return message_problem(ended) or trial.run_again()


def join_wrong_version(trial: ClusterTrial) -> str:
    """Let a worker with other sources join: its chunks must be refused."""
    pid = trial.nodes.start_worker("0.0.1")
    child = trial.start()
    trial.wait_a_moment()
    ended = child.wait()
    trial.nodes.kill(pid)
    return message_problem(ended) or trial.run_again()


FAULTS: dict[str, Callable[[ClusterTrial], str]] = {
    "worker killed": kill_worker,
    "scheduler killed": kill_scheduler,
    "wrong version": join_wrong_version,
}


@pytest.mark.slow
@pytest.mark.budget(3)  # faults
def test_a_command_on_a_cluster_survives_its_loss(exported, seed, budget, tmp_path):
    """A worker or the scheduler is killed, or a worker joins whose sources are others."""
    commands = ("sweep", "resonance", "map", "basin") if budget > len(FAULTS) else ("sweep",)
    nodes = DaskNodes(tmp_path / "nodes")
    try:
        make_trial = functools.partial(ClusterTrial, nodes=nodes)
        parts = (FAULTS, commands, make_trial, random.Random(seed), tmp_path, budget)
        expect_none(attack(*parts), {"faults": budget})
    finally:
        nodes.close()
