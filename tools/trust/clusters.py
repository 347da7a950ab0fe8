"""A Dask scheduler and its workers, killed while a command computes on them."""

from __future__ import annotations

import asyncio
import functools
import os
import signal
import time
from collections.abc import Callable, Coroutine, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from .trials import Disturbances, Trial, format_end, in_a_line

START = 60.0  # s
CONNECTING = 1.0  # s


def forked(life: Callable[[], Coroutine[Any, Any, None]], log: Path) -> int:
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


class Nodes:
    """A scheduler and two workers.

    Parameters
    ----------
    folder : Path
        For logs and what workers keep.
    """

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.pids = folder, []  # type: Path, list[int]
        self.start()

    def start(self) -> None:
        """Start the scheduler at an address of its own, and its workers."""
        place = self.folder / "address"
        place.unlink(missing_ok=True)
        self.scheduler = forked(lambda: schedule(place), self.folder / "log")
        self.pids.append(self.scheduler)
        stop = time.monotonic() + START
        while not place.exists():
            assert time.monotonic() < stop, (self.folder / "log").read_text()[-1000:]
            time.sleep(0.01)
        self.address = place.read_text()
        self.workers = [self.start_worker() for _ in range(2)]

    def start_worker(self, version: str = "") -> int:
        """Start one more worker; ``version`` makes its sources differ."""
        folder = str(self.folder)
        pid = forked(lambda: work(self.address, folder, version), self.folder / "log")
        self.pids.append(pid)
        return pid

    def kill(self, pid: int) -> None:
        """Kill a process by SIGKILL."""
        if pid in self.pids:
            self.pids.remove(pid)
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)

    def close(self) -> None:
        """End all processes."""
        for pid in list(self.pids):
            self.kill(pid)


async def schedule(place: Path) -> None:
    """Run a scheduler."""
    from distributed import Scheduler

    async with Scheduler(host="127.0.0.1", port=0, dashboard=False) as scheduler:
        partial = place.with_suffix(".partial")
        partial.write_text(scheduler.address)
        partial.rename(place)
        await scheduler.finished()


async def work(address: str, folder: str, version: str) -> None:
    """Run a worker."""
    from distributed import Worker

    if version:
        from orchestrate.running import executors

        original = executors.code_digests
        executors.code_digests = lambda module: {**original(module), "orchestrate.version": version}
    options: dict[str, Any] = {"nthreads": 1, "local_directory": folder, "dashboard": False}
    async with Worker(address, **options) as worker:
        await worker.finished()


@dataclass
class OnCluster(Trial):
    """Trial of a command that computes on a cluster."""

    nodes: Nodes

    def arguments(self) -> list[str]:
        """Return the arguments of the command."""
        return [*super().arguments(), "--cluster", self.nodes.address]

    def wait_a_moment(self) -> None:
        """Wait for a random moment of the command, after it has connected."""
        time.sleep(self.chance.uniform(0.0, self.seconds + CONNECTING))


def worker_killed(trial: OnCluster) -> str:
    """Kill one of two workers; another one joins later."""
    child = trial.start()
    trial.wait_a_moment()
    trial.nodes.kill(trial.nodes.workers.pop(trial.chance.randrange(2)))
    trial.nodes.workers.append(trial.nodes.start_worker())
    ended = child.wait()
    return format_end(ended) if ended.code else trial.verdict()


def scheduler_killed(trial: OnCluster) -> str:
    """Kill the scheduler: the command ends with one line; on another cluster it goes on."""
    child = trial.start()
    trial.wait_a_moment()
    trial.nodes.kill(trial.nodes.scheduler)
    ended = child.wait()
    trial.nodes.close()
    trial.nodes.start()
    return in_a_line(ended) or trial.goes_on()


def wrong_version(trial: OnCluster) -> str:
    """Let a worker with other sources join: its chunks must be refused."""
    pid = trial.nodes.start_worker("0.0.1")
    child = trial.start()
    trial.wait_a_moment()
    ended = child.wait()
    trial.nodes.kill(pid)
    return in_a_line(ended) or trial.goes_on()


class Clusters(Disturbances):
    """Campaign: faults of a Dask cluster."""

    name = "cluster"
    title = "Dask"
    commands = ("sweep", "resonance", "map", "basin")
    asks = (
        "A command computes on two workers of a Dask scheduler. A worker is killed with kill -9 "
        "and another one comes; the scheduler is killed; a worker joins whose sources are others. "
        "The command ends well, or gives up in one line and goes on where it was when it is asked "
        "again; its results have the bytes of those that are computed without a cluster. "
        f"Commands: {', '.join(commands)}."
    )
    target, batch = 100, 12
    faults: ClassVar[Mapping[str, Callable[[Any], str]]] = {
        "worker killed": worker_killed,
        "scheduler killed": scheduler_killed,
        "wrong version": wrong_version,
    }

    @contextmanager
    def trials(self, holder: Path) -> Iterator[Callable[..., Trial]]:
        """Start a cluster and return what makes trials on it."""
        import distributed

        assert distributed.Scheduler and distributed.Worker  # imported once, for all that is forked
        nodes = Nodes(holder / "nodes")
        try:
            yield functools.partial(OnCluster, nodes=nodes)
        finally:
            nodes.close()
