"""Executors: where chunks are computed. A chunk is the same call for all of them.

- Threads compute where the work is in our own FMUs, past Python, where no interrupt is heard.
- The present thread computes what else is short (:class:`InlineExecutor`).
- Processes of this machine, loky's, compute what else is long (:func:`process_workers`), and
  whatever an FMU of somebody else computes: it may crash, exit or hang there.
- Workers of a Dask scheduler, or any executor of ``concurrent.futures`` (:mod:`.cluster`).
"""

from __future__ import annotations

import functools
import hashlib
import os
import re
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import resource_tracker
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from ..errors import WorkerError
from ..files import write_atomically
from ..temporary import process_temporary_folder, remove_folders_of_ended_processes
from .identity import digests_of_code, format_changed_modules
from .job import Job, Table, last_entries

IDLE_TIMEOUT = 30  # s that worker processes wait for the next question before they end
RESUMES = "what was stored is kept; repeat the call to resume (without force)"
_writing = threading.Lock()  # workers may be threads of one process


def compute_chunk(
    job: Job,
    fmus: Mapping[str, Path | bytes],
    items: Sequence[Any],
    previous: Table | None,
    warmup_items: Sequence[Any],
    code: Mapping[str, str] | None = None,
) -> tuple[bytes, Table]:
    own_code = digests_of_code(type(job).__module__) if code is not None else {}
    if code is not None and own_code != code:
        names = format_changed_modules(own_code, code)
        raise WorkerError(f"a worker has other sources ({names}); expected the same version there")
    with _writing:
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
    folder = process_temporary_folder() / f"sent-{hashlib.sha256(content).hexdigest()[:32]}"
    folder.mkdir(exist_ok=True)
    return write_atomically(folder / f"{model}.fmu", lambda path: path.write_bytes(content))


@dataclass(frozen=True)
class Workers:
    """An executor, and how it is used."""

    executor: Executor
    max_in_flight: Callable[[], int]  # chunks to submit at once


class InlineExecutor(Executor):
    """Executor without workers: runs each call in this thread as soon as it is submitted."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


class ThreadExecutor(Executor):
    """Executor of daemon threads, which an interrupted process does not wait for at its end."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.calls: SimpleQueue[Callable[[], None] | None] = SimpleQueue()

        def work() -> None:
            for call in iter(self.calls.get, None):  # until there is a None in place of one
                call()

        for _ in range(count):
            threading.Thread(target=work, daemon=True).start()

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()

        def call() -> None:
            if future.set_running_or_notify_cancel():
                try:
                    future.set_result(fn(*args, **kwargs))
                except BaseException as error:
                    future.set_exception(error)

        self.calls.put(call)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Let the threads end after what was submitted; nobody waits for them."""
        for _ in range(self.count):
            self.calls.put(None)


@contextmanager
def thread_workers(count: int) -> Iterator[Workers]:
    with ThreadExecutor(count) as executor:
        yield Workers(executor, lambda: count + (count > 1))


@contextmanager
def process_workers(count: int, foreign_fmus: str = "") -> Iterator[Workers]:
    """Provide loky's processes, new ones for other FMUs; an error kills them."""
    import loky

    with sigint_blocked():
        start: Any = {"initializer": initialize_worker, "initargs": (os.getpid(), foreign_fmus)}
        pool = loky.get_reusable_executor(count, timeout=IDLE_TIMEOUT, **start)
        pool.submit(int)  # starts them
    try:
        with warnings.catch_warnings():
            # loky's, of a worker that it replaces: nothing is lost and nothing is to be done
            replaced = "A worker (stopped|was restarted) while some jobs"
            warnings.filterwarnings("ignore", replaced, UserWarning)
            yield Workers(pool, lambda: count + 1)
    except BaseException as error:
        pool.shutdown(wait=True, kill_workers=True)
        remove_folders_of_ended_processes()
        if isinstance(error, BrokenExecutor):
            raise WorkerError(f"{format_broken_pool(error)}; {RESUMES}") from None
        raise


def format_broken_pool(error: BrokenExecutor) -> str:
    names = dict.fromkeys(re.findall(r"(SIG[A-Z]+)\(|EXIT\((\d+)\)", str(error)))
    ends = [f"by {name}" if name else f"with exit code {code}" for name, code in names]
    return (
        f"a worker process ended without a word{''.join(f' ({end})' for end in ends)}: an FMU has "
        "crashed or ended it, it was killed, or out of memory"
    )


@contextmanager
def sigint_blocked() -> Iterator[None]:
    """Block Ctrl-C in a ``with`` block: processes started in it ignore it from the beginning."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # or it is started meanwhile, and lets Ctrl-C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def initialize_worker(parent_id: int, _: str) -> None:
    """Set up a worker process: no Ctrl-C, no report of a crash, an end when its parent ends."""
    os.environ.setdefault("PYTHONFAULTHANDLER", "0")  # or loky's report of a crash has many lines
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        if sys.platform == "win32":  # where its number stays a child's parent
            import _winapi

            with suppress(OSError):  # it has ended before
                process = _winapi.OpenProcess(_winapi.SYNCHRONIZE, False, parent_id)
                _winapi.WaitForSingleObject(process, _winapi.INFINITE)
        else:
            while os.getppid() == parent_id:
                time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
