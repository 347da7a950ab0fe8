"""Workers elsewhere: those of a Dask scheduler, or of any executor of ``concurrent.futures``."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import Any

from ..errors import InputError, VibroimpactError, WorkerError
from .executors import RESUMES, Workers, format_broken_pool

CONNECT_TIMEOUT = "5s"
RETRIES = 3  # a chunk whose worker is lost is computed by others


@contextmanager
def cluster_workers(where: Any, count: int) -> Iterator[Workers]:
    """Provide workers by a scheduler's address, a Dask client, or an executor of ``count``."""
    if isinstance(where, str):
        with dask_client(where) as client, dask_workers(client) as workers:
            if not client.ncores():
                advice = f"`dask worker {where} --nthreads 1` starts one"
                raise InputError(f"cluster {where}: the scheduler has no workers; {advice}")
            yield workers
    elif isinstance(where, Executor):
        try:
            yield Workers(where, lambda: count + 1)
        except BrokenExecutor as error:
            raise WorkerError(f"{format_broken_pool(error)}; {RESUMES}") from None
    else:
        with dask_workers(where) as workers:
            yield workers


@contextmanager
def dask_workers(client: Any) -> Iterator[Workers]:
    executor = client.get_executor(pure=False, retries=RETRIES)
    try:
        yield Workers(executor, lambda: 2 * max(1, sum(client.ncores().values())))
    except BaseException as error:
        with suppress(Exception):
            executor.shutdown(wait=False)
        of_connection = OSError, CancelledError, asyncio.CancelledError
        lost = isinstance(error, of_connection) or client.status != "running"
        if lost and not isinstance(error, (VibroimpactError, KeyboardInterrupt)):
            raise WorkerError(f"the scheduler of the cluster has ended; {RESUMES}") from None
        if type(error).__name__ == "KilledWorker":
            ended = "workers of the cluster ended without a word (killed, or out of memory)"
            raise WorkerError(f"{ended}; {RESUMES}") from None
        raise


@contextmanager
def dask_client(address: str) -> Iterator[Any]:
    """Provide a Dask client of its own for a scheduler's address, whose log is silent."""
    try:
        from distributed import Client
    except ImportError:
        raise InputError("cluster: needs Dask; pip install distributed brings it") from None
    for name in [*logging.root.manager.loggerDict]:  # some have levels of their own
        if name.split(".")[0] == "distributed":  # what is lost is reported by us
            logging.getLogger(name).setLevel(logging.CRITICAL)
    connect: Any = Client
    try:
        with ThreadPoolExecutor(1) as thread:  # a notebook has a loop in this thread
            thread.submit(asyncio.run, check_scheduler(address)).result()
        client = connect(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
    except Exception as error:  # of whatever answers there, and however
        text = f"no scheduler answers there ({str(error) or 'silence'})"
        raise InputError(f"cluster {address}: {text}; `dask scheduler` starts one") from None
    try:
        yield client
    finally:
        with suppress(Exception):
            client.close()


async def check_scheduler(address: str) -> None:
    """Try to connect to a scheduler's address, as a client waits for ever where one is silent."""
    from dask.utils import parse_timedelta
    from distributed.comm import connect
    from distributed.security import Security

    call: Any = connect
    security: Any = Security
    answer = call(address, timeout=CONNECT_TIMEOUT, **security().get_connection_args("client"))
    reached = await asyncio.wait_for(answer, 1.0 + parse_timedelta(CONNECT_TIMEOUT))
    reached.abort()
