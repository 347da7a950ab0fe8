"""Several sweeps side by side: one process each, a progress bar over all, every one resumable.

A sweep is sequential by nature, each eta starts from the end of the last; different cases and directions share nothing.
"""

import multiprocessing
import os
import signal
import sqlite3
import sys
from concurrent.futures import FIRST_EXCEPTION, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from pathlib import Path

from tqdm import tqdm

from .errors import UserError
from .store import Journal, Lock
from .sweep import run
from .workers import stop

POLL = 0.2  # s between looks at the journals


def journal_path(result):
    """Where the journal of a result file lies."""
    return Path(f"{result}.journal")


def work(plan, fmu, result):
    """One sweep in a worker process; the parent answers interrupts, and tells it to end by SIGTERM."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # by way of the context managers: nothing is left behind
    alone = orphaned(os.getppid())
    try:
        with closing(Journal(journal_path(result), plan.identity())) as journal:
            run(plan, fmu, journal, alone)
    except SystemExit:
        os._exit(1)  # the pool would take the next sweep
    if alone():
        os._exit(1)  # the pool would wait for orders that never come


def orphaned(parent):
    """A question: has the parent process ended, so that nobody waits for the result?"""
    return lambda: os.getppid() != parent


def count(result):
    """Rows in a sweep's journal, read while it is being written."""
    try:
        database = sqlite3.connect(f"file:{journal_path(result)}?mode=ro", uri=True, timeout=5.0)
        try:
            return database.execute("SELECT COUNT(*) FROM rows").fetchone()[0]
        finally:
            database.close()
    except sqlite3.Error:
        return 0


def run_all(plans, fmu, results, jobs=None):
    """Run plans on all cores until each has a complete journal.

    Parameters
    ----------
    plans : list of Plan
    fmu : path-like
    results : list of Path
        Result file of each plan.
    jobs : int, optional
        Processes at once; all cores by default.

    Raises
    ------
    UserError
        Of the first sweep that fails; the journals keep what was computed.
    KeyboardInterrupt
        After the workers were stopped.
    """
    if not plans:
        return
    jobs = min(len(plans), jobs or os.cpu_count() or 1)
    locks: list = []
    pool = ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn"))
    try:
        locks += [Lock(result) for result in results]
        attentive = signal.signal(signal.SIGINT, signal.SIG_IGN)  # workers inherit this from their first instruction on
        futures = [pool.submit(work, plan, fmu, result) for plan, result in zip(plans, results, strict=True)]
        signal.signal(signal.SIGINT, attentive)
        watch(futures, results, sum(len(plan.etas) for plan in plans))
    except BrokenProcessPool:
        stop(pool)
        raise UserError("a worker process ended without a word (killed, or out of memory); the same command goes on from where it was") from None
    except BaseException:
        stop(pool)
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
        for lock in locks:
            lock.release()


def watch(futures, results, total):
    """Show the progress until every sweep is complete; raises what a worker raised."""
    pending = set(futures)
    with tqdm(total=total, initial=sum(map(count, results)), unit="eta", desc="sweep", dynamic_ncols=True, smoothing=0.1) as bar:
        while pending:
            finished, pending = wait(pending, timeout=POLL, return_when=FIRST_EXCEPTION)
            bar.update(sum(map(count, results)) - bar.n)
            for future in finished:
                future.result()
