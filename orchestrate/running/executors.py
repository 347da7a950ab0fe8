"""Who computes: this process, processes of this machine, or the workers of a Dask scheduler.

Processes are loky's: they start without running the caller's script again, so a script needs no
``__main__`` guard and a notebook works. A chunk is the same call for all three.
"""

from __future__ import annotations

import asyncio
import functools
import hashlib
import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from importlib import import_module
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any, ClassVar, Protocol

from ..errors import InputError, WorkerError
from ..files import write_whole
from ..temporary import process_folder
from .identity import changed, code_of
from .job import Job, Table, last_entries

DASK = (
    *("distributed.batched", "distributed.client", "distributed.comm.core", "distributed.comm.tcp"),
    *("distributed.core", "distributed.utils", "distributed.utils_comm", "tornado.application"),
)
CONNECTION = (OSError, CancelledError, asyncio.CancelledError, asyncio.TimeoutError)
IDLE = 30  # s that processes wait for another question
CONNECT = "5s"
RETRIES = 3  # a chunk whose worker is lost is computed by others


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

    def start(self, modules: Iterable[str]) -> None:
        """Start the processes ahead of their chunks; they import some modules meanwhile."""
        for name in modules:
            for _ in range(self.count):
                self.executor.submit(import_module, name)

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


def is_no_lost_connection(record: logging.LogRecord) -> bool:
    """Whether a line of Dask's log stays: a lost connection is an exception of ours already."""
    kind = record.exc_info[0] if record.exc_info else None
    lost = kind is not None and issubclass(kind, CONNECTION)
    told = record.getMessage()
    return not lost and "CommClosedError" not in told and not told.startswith("Failed to reconnect")


class Cluster:
    """Workers of a Dask scheduler.

    Parameters
    ----------
    address : str

    Raises
    ------
    InputError
        Where no scheduler answers there, or it has no workers.
    WorkerError
        Where it ends while it is asked.
    """

    remote = True

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client, KilledWorker
        except ImportError:
            raise InputError(
                'cluster: needs Dask; pip install "vibroimpact[cluster]" brings it'
            ) from None
        self.losses: Mapping[type[BaseException], str] = {
            CancelledError: "the scheduler of the cluster has ended",
            KilledWorker: "workers of the cluster ended without a word (killed, or out of memory)",
        }
        for name in DASK:
            logging.getLogger(name).addFilter(is_no_lost_connection)
        connect: Any = Client
        try:
            with ThreadPoolExecutor(1) as beside:  # a notebook has a loop in this thread
                beside.submit(asyncio.run, greet(address)).result()
            self._client = connect(address, timeout=CONNECT, set_as_default=False)
        except Exception as error:  # of whatever answers there, and however
            raise InputError(
                f"cluster {address}: no scheduler answers there ({str(error) or 'silence'}); "
                "`dask scheduler` starts one"
            ) from None
        self.executor: Executor = Submitting(
            self._client.get_executor(pure=False, retries=RETRIES), self._client
        )
        with ended_at_once(self):
            if not self._cores():
                raise InputError(
                    f"cluster {address}: the scheduler has no workers; "
                    f"`dask worker {address} --nthreads 1` starts one"
                )

    def _cores(self) -> int:
        """Cores of all workers."""
        try:
            return int(sum(self._client.ncores().values()))
        except Exception as error:  # one of many, where the connection is lost
            raise CancelledError from error

    def room(self) -> int:
        """Two chunks for each core; workers may come and go."""
        return 2 * max(1, self._cores())

    def close(self, in_haste: bool) -> None:
        """Leave the scheduler, where it is there; what it still computes for us is cancelled."""
        with suppress(Exception):
            self.executor.shutdown(wait=not in_haste)
        with suppress(Exception):
            self._client.close()


async def greet(address: str) -> None:
    """See whether Dask answers at an address; its client waits for ever for one that is silent."""
    from dask.utils import parse_timedelta
    from distributed.comm import connect
    from distributed.security import Security

    call: Any = connect
    security: Any = Security
    answer = call(address, timeout=CONNECT, **security().get_connection_args("client"))
    reached = await asyncio.wait_for(answer, 1.0 + parse_timedelta(CONNECT))
    reached.abort()


class Submitting(Executor):
    """Dask's executor, where a call that finds no scheduler is one that is cancelled."""

    def __init__(self, pool: Any, client: Any) -> None:
        self._pool, self._client = pool, client

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hand out a call."""
        try:
            future: Future[Any] = self._pool.submit(fn, *args, **kwargs)
        except Exception as error:
            if self._client.status == "running":
                raise
            raise CancelledError from error
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Wait for what is under way, or cancel it."""
        self._pool.shutdown(wait=wait)


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
