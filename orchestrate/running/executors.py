"""Executors: this process, worker processes of this machine, or others (:mod:`.cluster`).

Processes are loky's: they start without running the caller's script again, so a script needs no
``__main__`` guard and a notebook works. A chunk is the same call for all three.
"""

from __future__ import annotations

import functools
import hashlib
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any, ClassVar, Protocol

from ..errors import WorkerError
from ..files import write_whole
from ..temporary import process_folder
from .identity import changed_modules, code_digests
from .job import Job, Table, last_entries

IDLE_TIMEOUT = 30  # s that worker processes wait for the next question before they end


def compute(
    job: Job,
    fmus: Mapping[str, Path | bytes],
    items: Sequence[Any],
    previous: Table | None,
    warmup_items: Sequence[Any],
    code: Mapping[str, str] | None = None,
) -> tuple[bytes, Table]:
    """Compute a chunk, on other machines by FMUs sent as bytes; return its start state and table.

    Parameters
    ----------
    job : Job
    fmus : mapping
    items : sequence
    previous : dict of ndarray, optional
        What the chunk starts from.
    warmup_items : sequence
        Items to compute first, from the job's own beginning, in place of ``previous``.
    code : mapping of str to str, optional
        Digests of the sources that the job belongs to, where it travels to another machine.

    Returns
    -------
    start : bytes
        What it started from, of a sequential job.
    table : dict of ndarray

    Raises
    ------
    WorkerError
        Where the sources here are others: they would give other numbers.
    """
    own_code = code_digests(type(job).__module__) if code is not None else {}
    if code is not None and own_code != code:
        names = changed_modules(own_code, code)
        raise WorkerError(f"a worker has other sources ({names}); expected the same version there")
    paths = {
        model: fmu_file(model, fmu) if isinstance(fmu, bytes) else fmu
        for model, fmu in fmus.items()
    }
    if warmup_items:
        previous = last_entries(job.work(paths, warmup_items, None))
    start = job.boundary_state(previous) if job.warmup_items and previous is not None else b""
    return start, job.work(paths, items, previous)


def fmu_file(model: str, content: bytes) -> Path:
    """Write an FMU that came as bytes to a file; return its path."""
    return write_fmu_once(model, hashlib.sha256(content).hexdigest(), content)


@functools.lru_cache(maxsize=16)
def write_fmu_once(model: str, digest: str, content: bytes) -> Path:
    """Write an FMU into the temporary folder of this process, once."""
    folder = process_folder() / f"sent-{digest[:32]}"
    folder.mkdir(exist_ok=True)
    return write_whole(folder / f"{model}.fmu", lambda path: path.write_bytes(content))


class Workers(Protocol):
    """Interface of everything that computes chunks."""

    @property
    def executor(self) -> Executor:
        """Executor that takes the calls."""

    @property
    def remote(self) -> bool:
        """Return whether the workers share no disk with this process."""

    @property
    def losses(self) -> Mapping[type[BaseException], str]:
        """Return the exceptions that mean lost workers, each with a text for the user."""

    def max_in_flight(self) -> int:
        """Return how many chunks should be submitted at once."""

    def close(self, in_haste: bool) -> None:
        """Release the workers; ``in_haste`` ends them in the middle of their chunks."""


class InlineExecutor(Executor):
    """Runs each call in this process as soon as it is submitted."""

    remote = False
    losses: ClassVar[Mapping[type[BaseException], str]] = {}

    @property
    def executor(self) -> Executor:
        """Return itself."""
        return self

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Run a call now; what it raises is raised here."""
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future

    def max_in_flight(self) -> int:
        """Return 1: chunks are computed one at a time."""
        return 1

    def close(self, in_haste: bool) -> None:
        """Do nothing: there are no workers to release."""


class Processes:
    """Computes chunks in worker processes of this machine (loky)."""

    remote = False
    losses: ClassVar[Mapping[type[BaseException], str]] = {
        BrokenProcessPool: "a worker process ended without a word (an FMU has crashed or ended "
        "it, it was killed, or out of memory)"
    }

    def __init__(self, count: int) -> None:
        import loky

        self.count = count
        self.executor: Executor = SigintMaskedExecutor(
            loky.get_reusable_executor(
                count, timeout=IDLE_TIMEOUT, initializer=initialize_worker, initargs=(os.getpid(),)
            )
        )

    def max_in_flight(self) -> int:
        """Return one chunk more than there are processes, so that none waits."""
        return self.count + 1

    def close(self, in_haste: bool) -> None:
        """Keep the processes for the next question, or end them."""
        if in_haste:
            self.executor.shutdown(wait=True, cancel_futures=True)


class SigintMaskedExecutor(Executor):
    """Wraps an executor whose processes ignore Ctrl-C from their first instruction on."""

    def __init__(self, pool: Any) -> None:
        self._pool = pool

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit a call; processes that are started for it inherit the blocked signal."""
        with sigint_masked():
            future: Future[Any] = self._pool.submit(fn, *args, **kwargs)
            return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Shut down the processes; ``cancel_futures`` kills them in the middle of their work."""
        self._pool.shutdown(wait=wait, kill_workers=cancel_futures)


@contextmanager
def sigint_masked() -> Iterator[None]:
    """Block SIGINT (Ctrl-C) for a moment; processes started meanwhile keep it blocked."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # or it is started meanwhile, and lets Ctrl-C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def initialize_worker(parent: int) -> None:
    """Set up a worker process: ignore Ctrl-C, and end when the parent process has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "win32":  # there a process does not learn of it
        return

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def workers_ended_on_error(workers: Workers) -> Iterator[None]:
    """Run a block; if it raises, end the workers, and turn a lost one into ``WorkerError``."""
    try:
        yield
    except BaseException as error:
        workers.close(True)
        for kind, explanation in workers.losses.items():
            if isinstance(error, kind):
                raise WorkerError(
                    f"{explanation}; what was stored is kept, the same call goes on from there"
                ) from None
        raise


@contextmanager
def running_workers(workers: Workers) -> Iterator[Workers]:
    """Provide workers for a block of code and release them afterwards."""
    with workers_ended_on_error(workers):
        yield workers
    workers.close(False)
