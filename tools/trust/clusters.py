"""A Dask scheduler and its workers, killed while a command computes on them."""

from __future__ import annotations

import asyncio
import os
import random
import shutil
import signal
import tempfile
import time
from collections.abc import Callable, Coroutine
from contextlib import suppress
from pathlib import Path
from typing import Any

from .campaign import Campaign, Outcome
from .children import Child, Ended, import_all
from .faults import COMMANDS, in_a_line, results, told, undisturbed

NAMES = ("sweep", "resonance", "map", "basin")
START = 60.0  # s


def forked(life: Callable[[], Coroutine[Any, Any, None]], log: Path) -> int:
    """A process that lives so; returns its id."""
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
        place = folder / "address"
        place.unlink(missing_ok=True)
        self.scheduler = forked(lambda: schedule(place), folder / "log")
        self.pids.append(self.scheduler)
        stop = time.monotonic() + START
        while not place.exists():
            assert time.monotonic() < stop, (folder / "log").read_text()[-1000:]
            time.sleep(0.01)
        self.address = place.read_text()
        self.workers = [self.start_worker() for _ in range(2)]

    def start_worker(self, version: str = "") -> int:
        """One more; where a version is given, its sources are others."""
        folder = str(self.folder)
        pid = forked(lambda: work(self.address, folder, version), self.folder / "log")
        self.pids.append(pid)
        return pid

    def kill(self, pid: int) -> None:
        """kill -9."""
        if pid in self.pids:
            self.pids.remove(pid)
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)

    def close(self) -> None:
        """End them all."""
        for pid in list(self.pids):
            self.kill(pid)


async def schedule(place: Path) -> None:
    """A scheduler's life."""
    from distributed import Scheduler

    async with Scheduler(host="127.0.0.1", port=0, dashboard=False) as scheduler:
        partial = place.with_suffix(".partial")
        partial.write_text(scheduler.address)
        partial.rename(place)
        await scheduler.finished()


async def work(address: str, folder: str, version: str) -> None:
    """A worker's life."""
    from distributed import Worker

    if version:
        from orchestrate.running import executors

        original = executors.code_of
        executors.code_of = lambda module: {**original(module), "orchestrate.version": version}
    options: dict[str, Any] = {"nthreads": 1, "local_directory": folder, "dashboard": False}
    async with Worker(address, **options) as worker:
        await worker.finished()


class Trial:
    """One fault of a command on a cluster."""

    def __init__(self, name: str, folder: Path, nodes: Nodes, chance: random.Random) -> None:
        self.name, self.folder, self.nodes, self.chance = name, folder, nodes, chance

    def start(self) -> Child:
        """The command under way."""
        output = ["--output", str(self.folder / "results"), "--cluster", self.nodes.address]
        return Child([*COMMANDS[self.name], *output], self.folder / "temporary")

    def wait_a_moment(self, seconds: float) -> None:
        """Any moment of the command."""
        time.sleep(self.chance.uniform(0.0, seconds))


def worker_killed(trial: Trial, seconds: float) -> Ended:
    """One of two; another one comes later."""
    child = trial.start()
    trial.wait_a_moment(seconds)
    trial.nodes.kill(trial.nodes.workers.pop(trial.chance.randrange(2)))
    trial.nodes.workers.append(trial.nodes.start_worker())
    return child.wait()


def scheduler_killed(trial: Trial, seconds: float) -> Ended:
    """The command gives up in a line; another cluster, and the same command goes on."""
    child = trial.start()
    trial.wait_a_moment(seconds)
    trial.nodes.kill(trial.nodes.scheduler)
    ended = child.wait()
    trial.nodes.close()
    trial.nodes = Nodes(trial.nodes.folder)
    if in_a_line(ended):
        return ended
    return trial.start().wait()


def wrong_version(trial: Trial, seconds: float) -> Ended:
    """A worker with other sources joins: its chunks are refused, not mixed in."""
    pid = trial.nodes.start_worker("0.0.1")
    child = trial.start()
    trial.wait_a_moment(seconds)
    ended = child.wait()
    trial.nodes.kill(pid)
    if in_a_line(ended):
        return ended
    return trial.start().wait()


FAULTS: dict[str, Callable[[Trial, float], Ended]] = {
    "worker killed": worker_killed,
    "scheduler killed": scheduler_killed,
    "wrong version": wrong_version,
}


class Clusters(Campaign):
    """Dask under faults."""

    name = "cluster"
    title = "Dask"
    asks = (
        "A command computes on two workers of a Dask scheduler. A worker is killed with kill -9 "
        "and another one comes; the scheduler is killed; a worker joins whose sources are others. "
        "The command ends well, or gives up in one line and goes on where it was when it is asked "
        "again; its results have the bytes of those that are computed without a cluster. "
        f"Commands: {', '.join(NAMES)}."
    )
    unit, target, batch = "faults", 100, 12
    package = True

    def run(self, fmu: Path, seed: int, count: int) -> Outcome:
        """One fault after the other."""
        import_all()
        import distributed

        assert distributed.Scheduler and distributed.Worker  # imported once, for all that is forked
        chance, counts, notes = random.Random(seed), dict.fromkeys(FAULTS, 0), []
        known: dict[str, tuple[dict[str, bytes], float]] = {}
        with tempfile.TemporaryDirectory(prefix="vibroimpact-trust-") as holder:
            nodes = Nodes(Path(holder) / "nodes")
            try:
                for number in range(count):
                    name, fault = chance.choice(NAMES), list(FAULTS)[number % len(FAULTS)]
                    if name not in known:
                        known[name] = undisturbed(name, Path(holder) / "undisturbed")
                    trial = Trial(name, Path(holder) / "trial", nodes, chance)
                    ended = FAULTS[fault](trial, known[name][1])
                    nodes = trial.nodes
                    wrong = told(ended) if ended.code else ""
                    if not wrong and results(trial.folder / "results") != known[name][0]:
                        wrong = "other bytes"
                    counts[fault] += 1
                    if wrong:
                        notes.append(f"seed {seed}, fault {number} ({fault}, {name}): {wrong}")
                    shutil.rmtree(trial.folder, ignore_errors=True)
            finally:
                nodes.close()
        named = {f"{name}:": value for name, value in counts.items()}
        return Outcome(count, len(notes), counts=named, notes=tuple(notes))
