"""Who computes the chunks: this machine's cores, or the workers of a running Dask scheduler; the same code for both."""

import multiprocessing
import os
import signal
import tempfile
import threading
import time
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path

import xarray
from tqdm import tqdm

from .errors import UserError
from .jobs import Progress, identities
from .store import Lock
from .workers import stop


def compute_chunk(job, fmu, items, carry):
    """One chunk in a worker, which may be on another machine: the FMU travels as bytes."""
    with tempfile.TemporaryDirectory(prefix="vibroimpact-") as folder:
        path = Path(folder) / "model.fmu"
        path.write_bytes(fmu)
        return job.work(path, items, carry)


def attend(parent):
    """End this worker when its parent has ended: nobody waits for its results."""

    def watch():
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class Local:
    """Processes of this machine."""

    def __init__(self, jobs):
        self.size = jobs
        context = multiprocessing.get_context("spawn")
        self._pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=attend, initargs=(os.getpid(),))

    def submit(self, *task):
        """Hand out a chunk."""
        return self.call(compute_chunk, *task)

    def call(self, function, *arguments):
        """Hand out any call; a process started for it is deaf to Ctrl-C from its first instruction on."""
        attentive = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            return self._pool.submit(function, *arguments)
        finally:
            signal.signal(signal.SIGINT, attentive)

    def room(self):
        """Chunks worth having under way: one more than are computed."""
        return self.size + 1

    def close(self, in_haste):
        """End the workers, in the middle of their chunks where ``in_haste``."""
        if in_haste:
            stop(self._pool)
        self._pool.shutdown(wait=True, cancel_futures=True)


class Cluster:
    """Workers of a Dask scheduler; a chunk whose worker is lost is computed by another."""

    def __init__(self, address):
        try:
            from distributed import Client
        except ImportError:
            raise UserError('--cluster: needs Dask; `pip install -e ".[cluster]"` in the clone brings it') from None
        try:
            self._client = Client(address, timeout="5s", set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise UserError(f"--cluster {address}: no scheduler answers there ({error}); start one with `dask scheduler`") from None
        if not self._client.ncores():
            self._client.close()
            raise UserError(f"--cluster {address}: the scheduler has no workers; start some with `dask worker {address} --nthreads 1`")
        self._executor = self._client.get_executor(pure=False, retries=3)

    def submit(self, *task):
        """Hand out a chunk."""
        return self._executor.submit(compute_chunk, *task)

    def room(self):
        """Chunks worth having under way: workers may come and go."""
        return 2 * max(1, sum(self._client.ncores().values()))

    def close(self, in_haste):
        """Leave the scheduler; what it still computes for us is cancelled."""
        self._executor.shutdown(wait=not in_haste)
        self._client.close()


@contextmanager
def workers(jobs, cluster=None):
    """Workers for a while.

    Parameters
    ----------
    jobs : int
        Processes on this machine.
    cluster : str, optional
        Address of a Dask scheduler to take instead.
    """
    pool = Cluster(cluster) if cluster else Local(jobs)
    try:
        yield pool
    except BrokenProcessPool:
        pool.close(True)
        raise UserError("a worker process ended without a word (killed, or out of memory); the same command goes on from where it was") from None
    except BaseException:
        pool.close(True)
        raise
    else:
        pool.close(False)


def run(jobs, fmu, folder, make_pool):
    """Compute jobs until each has its result file.

    Parameters
    ----------
    jobs : list of Job
        Each after those it needs.
    fmu : Path
    folder : Path
    make_pool : callable
        Gives a context manager of workers; asked only where there is work.
    """
    lock = Lock(Path(folder) / "paper")
    states: dict = {}
    try:
        known = identities(jobs)
        for job in jobs:
            states[job.name] = Progress(job, folder, known[job.name])
        if not all(state.complete for state in states.values()):
            with make_pool() as pool:
                Runner(states, fmu.read_bytes(), pool).run()
    finally:
        for state in states.values():
            state.close()
        lock.release()


def spread(function, tasks, jobs):
    """Results of a function for each tuple of arguments, in order, on so many processes of this machine."""
    if min(jobs, len(tasks)) < 2:
        return [function(*task) for task in tasks]
    with workers(min(jobs, len(tasks))) as pool:
        return [future.result() for future in [pool.call(function, *task) for task in tasks]]


class Runner:
    """Keeps the workers busy, the earliest job first, with a bar over all chunks.

    Parameters
    ----------
    states : dict of Progress
        By name.
    fmu : bytes
    pool : Local or Cluster
    """

    def __init__(self, states, fmu, pool):
        self.states, self.fmu, self.pool = states, fmu, pool
        self.under_way: dict = {}  # future: name, index

    def run(self):
        """Until every job is complete."""
        total = sum(state.job.chunks() for state in self.states.values())
        done = sum(state.done for state in self.states.values())
        with tqdm(total=total, initial=done, unit="chunk", desc="paper", dynamic_ncols=True, smoothing=0.05) as bar:
            while not all(state.complete for state in self.states.values()):
                self.hand_out()
                finished, _ = wait(self.under_way, timeout=0.5, return_when=FIRST_COMPLETED)
                for future in finished:
                    name, index = self.under_way.pop(future)
                    self.states[name].enter(index, future.result())
                    bar.update()

    def hand_out(self):
        """Submit chunks until the workers have enough."""
        for state in self.states.values():
            if state.complete or not self.ready(state):
                continue
            while len(self.under_way) < self.pool.room():
                busy = sum(name == state.job.name for name, _ in self.under_way.values())
                chunk = state.take(busy)
                if chunk is None:
                    break
                index, items, carry = chunk
                future = self.pool.submit(state.job, self.fmu, items, carry)
                self.under_way[future] = state.job.name, index

    def ready(self, state):
        """Whether a job can start; starts it."""
        if not state.started:
            if not all(self.states[name].complete for name in state.job.needs()):
                return False
            state.start({name: xarray.load_dataset(self.states[name].result, engine="netcdf4") for name in state.job.needs()})
            state.finish_if_done()
        return not state.complete
