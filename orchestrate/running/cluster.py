"""The workers of a Dask scheduler, on any machine."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import suppress
from typing import Any

from ..errors import InputError
from .executors import workers_ended_on_error

DASK_LOGGERS = (
    *("distributed.batched", "distributed.client", "distributed.comm.core", "distributed.comm.tcp"),
    *("distributed.core", "distributed.utils", "distributed.utils_comm", "tornado.application"),
)
CONNECTION_ERRORS = (OSError, CancelledError, asyncio.CancelledError, asyncio.TimeoutError)
CONNECT_TIMEOUT = "5s"
RETRIES = 3  # a chunk whose worker is lost is computed by others


def is_worth_logging(record: logging.LogRecord) -> bool:
    """Return whether one of Dask's log records is kept; lost connections are reported by us."""
    kind = record.exc_info[0] if record.exc_info else None
    lost = kind is not None and issubclass(kind, CONNECTION_ERRORS)
    message = record.getMessage()
    return (
        not lost
        and "CommClosedError" not in message
        and not message.startswith("Failed to reconnect")
    )


class Cluster:
    """Computes chunks on the workers of a Dask scheduler."""

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
        for name in DASK_LOGGERS:
            logging.getLogger(name).addFilter(is_worth_logging)
        connect: Any = Client
        try:
            with ThreadPoolExecutor(1) as thread_pool:  # a notebook has a loop in this thread
                thread_pool.submit(asyncio.run, check_scheduler(address)).result()
            self._client = connect(address, timeout=CONNECT_TIMEOUT, set_as_default=False)
        except Exception as error:  # of whatever answers there, and however
            raise InputError(
                f"cluster {address}: no scheduler answers there ({str(error) or 'silence'}); "
                "`dask scheduler` starts one"
            ) from None
        self.executor: Executor = DaskExecutor(
            self._client.get_executor(pure=False, retries=RETRIES), self._client
        )
        with workers_ended_on_error(self):
            if not self._cores():
                raise InputError(
                    f"cluster {address}: the scheduler has no workers; "
                    f"`dask worker {address} --nthreads 1` starts one"
                )

    def _cores(self) -> int:
        """Return the number of cores of all Dask workers together."""
        try:
            return int(sum(self._client.ncores().values()))
        except Exception as error:  # one of many, where the connection is lost
            raise CancelledError from error

    def max_in_flight(self) -> int:
        """Return how many chunks to submit at once: two per core of the Dask workers."""
        return 2 * max(1, self._cores())

    def close(self, in_haste: bool) -> None:
        """Shut down the Dask client; running chunks are cancelled ``in_haste``, else awaited."""
        with suppress(Exception):
            self.executor.shutdown(wait=not in_haste)
        with suppress(Exception):
            self._client.close()


async def check_scheduler(address: str) -> None:
    """Try to connect to a Dask scheduler's address; raise unless it answers within the timeout."""
    from dask.utils import parse_timedelta
    from distributed.comm import connect
    from distributed.security import Security

    call: Any = connect
    security: Any = Security
    answer = call(address, timeout=CONNECT_TIMEOUT, **security().get_connection_args("client"))
    reached = await asyncio.wait_for(answer, 1.0 + parse_timedelta(CONNECT_TIMEOUT))
    reached.abort()


class DaskExecutor(Executor):
    """Wrapper of Dask's executor that raises ``CancelledError`` if the scheduler is lost."""

    def __init__(self, pool: Any, client: Any) -> None:
        self._pool, self._client = pool, client

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit a call to Dask; return its future; ``CancelledError`` without scheduler."""
        try:
            future: Future[Any] = self._pool.submit(fn, *args, **kwargs)
        except Exception as error:
            if self._client.status == "running":
                raise
            raise CancelledError from error
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Shut down Dask's executor, after its running calls if ``wait``, else cancelling them."""
        self._pool.shutdown(wait=wait)
