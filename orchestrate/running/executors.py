"""Executors: this process, its threads, processes of this machine, or others (:mod:`.cluster`).

Processes are loky's: they start without running the caller's script again, so a script needs no
``__main__`` guard and a notebook works. A chunk is the same call for all.
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
from concurrent.futures import Executor, Future, ThreadPoolExecutor
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
    """Compute a chunk of a job in a worker; return its table, and the start state used, as
    bytes.
    """
    own_code = code_digests(type(job).__module__) if code is not None else {}
    if code is not None and own_code != code:
        names = changed_modules(own_code, code)
        raise WorkerError(f"a worker has other sources ({names}); expected the same version there")
    paths = {
        model: write_fmu_once(model, fmu) if isinstance(fmu, bytes) else fmu
        for model, fmu in fmus.items()
    }
    if warmup_items:
        previous = last_entries(job.work(paths, warmup_items, None))
    start = job.boundary_state(previous) if job.warmup_items and previous is not None else b""
    return start, job.work(paths, items, previous)


@functools.lru_cache(maxsize=16)
def write_fmu_once(model: str, content: bytes) -> Path:
    """Write an FMU's bytes, sent to this worker, to a temporary file once; return its path."""
    folder = process_folder() / f"sent-{hashlib.sha256(content).hexdigest()[:32]}"
    folder.mkdir(exist_ok=True)
    return write_whole(folder / f"{model}.fmu", lambda path: path.write_bytes(content))


class Workers(Protocol):
    """Protocol of what computes chunks: this process, worker processes or a Dask cluster."""

    @property
    def executor(self) -> Executor:
        """The ``concurrent.futures`` executor to which chunks are submitted."""

    @property
    def remote(self) -> bool:
        """Return whether the workers share no disk with this process."""

    @property
    def losses(self) -> Mapping[type[BaseException], str]:
        """Return a dict from exception types that mean lost workers to texts for the user."""

    def max_in_flight(self) -> int:
        """Return how many chunks should be submitted at once."""

    def close(self, in_haste: bool) -> None:
        """Release the workers; ``in_haste`` kills them in the middle of their chunks."""


class InlineExecutor(Executor):
    """Executor without workers: runs each call in this process as soon as it is submitted."""

    remote = False
    losses: ClassVar[Mapping[type[BaseException], str]] = {}

    @property
    def executor(self) -> Executor:
        """Return itself: it is its own ``concurrent.futures`` executor."""
        return self

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Run a call at once in this process; return a finished future, or raise its exception."""
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future

    def max_in_flight(self) -> int:
        """Return 1, the number of chunks to submit at once."""
        return 1

    def close(self, in_haste: bool) -> None:
        """Do nothing: there are no worker processes to release."""


class Processes:
    """Workers that are processes of this machine, from a reusable loky pool."""

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
        """Return how many chunks to submit at once: one more than there are processes."""
        return self.count + 1

    def close(self, in_haste: bool) -> None:
        """Kill the worker processes if ``in_haste``; else keep them for the next computation."""
        if in_haste:
            self.executor.shutdown(wait=True, cancel_futures=True)


class Threads:
    """Workers that are threads of this process, for work that is done past Python."""

    remote = False
    losses: ClassVar[Mapping[type[BaseException], str]] = {}

    def __init__(self, count: int) -> None:
        self.count, self.executor = count, ThreadPoolExecutor(count)

    def max_in_flight(self) -> int:
        """Return how many chunks to submit at once: one more than there are threads."""
        return self.count + 1

    def close(self, in_haste: bool) -> None:
        """End the threads after their present chunks."""
        self.executor.shutdown(wait=True, cancel_futures=True)


class SigintMaskedExecutor(Executor):
    """Wrapper of a process pool whose workers ignore Ctrl-C from their first instruction on."""

    def __init__(self, pool: Any) -> None:
        self._pool = pool

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit a call to the pool with SIGINT blocked; return its future."""
        with sigint_masked():
            future: Future[Any] = self._pool.submit(fn, *args, **kwargs)
            return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Shut down the pool's processes; ``cancel_futures`` kills them while they work."""
        self._pool.shutdown(wait=wait, kill_workers=cancel_futures)


@contextmanager
def sigint_masked() -> Iterator[None]:
    """Block SIGINT (Ctrl-C) in a ``with`` block, so that processes started in it inherit that."""
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
    """Set up a worker process: ignore Ctrl-C, and exit when the parent process has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "win32":  # there a process does not learn of it
        return

    def watch() -> None:
        """End this worker when its parent process has ended."""
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def workers_ended_on_error(workers: Workers) -> Iterator[None]:
    """Kill the workers if the ``with`` block raises; turn lost workers into ``WorkerError``."""
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
    """Provide workers for a ``with`` block; release them at its end, kill them on an error."""
    with workers_ended_on_error(workers):
        yield workers
    workers.close(False)
