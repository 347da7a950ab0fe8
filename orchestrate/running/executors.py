"""Who computes: this process, processes of this machine, or others (:mod:`.cluster`).

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
from .identity import changed, code_of
from .job import Job, Table, last_entries

IDLE = 30  # s that processes wait for another question


def compute(
    job: Job,
    fmus: Mapping[str, Path | bytes],
    items: Sequence[Any],
    carry: Table | None,
    lead: Sequence[Any],
    code: Mapping[str, str] | None = None,
) -> tuple[bytes, Table]:
    """One chunk, wherever it is computed; FMUs travel to other machines as bytes.

    Parameters
    ----------
    job : Job
    fmus : mapping
    items : sequence
    carry : dict of ndarray, optional
        What the chunk starts from.
    lead : sequence
        Items to compute first, from the job's own beginning, in place of ``carry``.
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
    here = code_of(type(job).__module__) if code is not None else {}
    if code is not None and here != code:
        names = changed(here, code)
        raise WorkerError(f"a worker has other sources ({names}); expected the same version there")
    paths = {
        model: unpacked(model, fmu) if isinstance(fmu, bytes) else fmu
        for model, fmu in fmus.items()
    }
    if lead:
        carry = last_entries(job.work(paths, lead, None))
    start = job.seam(carry) if job.lead and carry is not None else b""
    return start, job.work(paths, items, carry)


def unpacked(model: str, content: bytes) -> Path:
    """An FMU that came as bytes, as a file."""
    return kept(model, hashlib.sha256(content).hexdigest(), content)


@functools.lru_cache(maxsize=16)
def kept(model: str, digest: str, content: bytes) -> Path:
    """Write an FMU into the temporary folder of this process, once."""
    folder = process_folder() / f"sent-{digest[:32]}"
    folder.mkdir(exist_ok=True)
    return write_whole(folder / f"{model}.fmu", lambda place: place.write_bytes(content))


class Workers(Protocol):
    """Those who compute chunks."""

    @property
    def executor(self) -> Executor:
        """Takes the calls."""

    @property
    def remote(self) -> bool:
        """Whether they share no disk with this process."""

    @property
    def losses(self) -> Mapping[type[BaseException], str]:
        """Exceptions by which it shows that they are lost, and what has happened then."""

    def room(self) -> int:
        """Chunks worth having under way."""

    def close(self, in_haste: bool) -> None:
        """Let them go, in the middle of their chunks where ``in_haste``."""


class Here(Executor):
    """A call is carried out by this process, when it is submitted."""

    remote = False
    losses: ClassVar[Mapping[type[BaseException], str]] = {}

    @property
    def executor(self) -> Executor:
        """Itself."""
        return self

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Carry a call out; what it raises is raised here."""
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future

    def room(self) -> int:
        """One chunk at a time."""
        return 1

    def close(self, in_haste: bool) -> None:
        """Nobody to let go."""


class Processes:
    """Processes of this machine."""

    remote = False
    losses: ClassVar[Mapping[type[BaseException], str]] = {
        BrokenProcessPool: "a worker process ended without a word (an FMU has crashed or ended "
        "it, it was killed, or out of memory)"
    }

    def __init__(self, count: int) -> None:
        import loky

        self.count = count
        self.executor: Executor = Deaf(
            loky.get_reusable_executor(
                count, timeout=IDLE, initializer=attend, initargs=(os.getpid(),)
            )
        )

    def room(self) -> int:
        """One chunk more than are computed."""
        return self.count + 1

    def close(self, in_haste: bool) -> None:
        """Keep the processes for the next question, or end them."""
        if in_haste:
            self.executor.shutdown(wait=True, cancel_futures=True)


class Deaf(Executor):
    """An executor whose processes do not hear Ctrl-C, from their first instruction on."""

    def __init__(self, pool: Any) -> None:
        self._pool = pool

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hand out a call; processes that are started for it inherit that Ctrl-C is held back."""
        with interrupts_held():
            future: Future[Any] = self._pool.submit(fn, *args, **kwargs)
            return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes, in the middle of what they do."""
        self._pool.shutdown(wait=wait, kill_workers=cancel_futures)


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back for a moment; what is started meanwhile holds it back for good."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # or it is started meanwhile, and lets Ctrl-C through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def attend(parent: int) -> None:
    """End this process when its parent has ended: nobody waits for its results."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform == "win32":  # there a process does not learn of it
        return

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def ended_at_once(workers: Workers) -> Iterator[None]:
    """End workers where something is raised, and say so where they are lost."""
    try:
        yield
    except BaseException as error:
        workers.close(True)
        for kind, what in workers.losses.items():
            if isinstance(error, kind):
                raise WorkerError(
                    f"{what}; what was stored is kept, the same call goes on from there"
                ) from None
        raise


@contextmanager
def at_work(workers: Workers) -> Iterator[Workers]:
    """Workers for a while."""
    with ended_at_once(workers):
        yield workers
    workers.close(False)
