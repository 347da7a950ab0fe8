"""A sweep ended by force goes on where it was: its result file equals the uninterrupted one byte for byte."""

import math
import os
import random
import signal
import sqlite3
import sys
import time

import pytest

from .command import Done, Sweeps, children, is_alive
from .conftest import ROWS, RUN

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="process groups and /proc")
INTERRUPTED = "interrupted: nothing computed is lost, the same command goes on from here"


def goes_on(sweeps, least, uninterrupted):
    """See that the same command goes on from row ``least`` or later, and gives the uninterrupted bytes."""
    assert not sweeps.result().exists()
    kept = sweeps.rows()
    assert least <= kept < ROWS
    process = sweeps.start(*RUN)
    seen = []
    unfinished = sweeps.result().with_name(sweeps.result().name + ".tmp")
    while process.poll() is None:
        if unfinished.exists() or sweeps.result().exists():  # the journal is about to go: one who reads it now leaves a file of SQLite's behind
            break
        seen.append(sweeps.rows())
        time.sleep(0.005)
    done = sweeps.end(process).success()
    assert min(seen) >= kept and kept <= done.counts[0] < ROWS, "it began anew"
    assert sweeps.result().read_bytes() == uninterrupted
    assert sweeps.files() == [sweeps.result().name, sweeps.result().with_suffix(".png").name]


def worker_of(process):
    """Process id of the one worker."""
    workers = [pid for pid, command in children(process.pid).items() if "spawn_main" in command]
    assert len(workers) == 1, workers
    return workers[0]


def test_kill_9(sweeps, uninterrupted):
    process = sweeps.start(*RUN)
    least = sweeps.wait_for_rows(process, 40)
    sweeps.kill(process)
    goes_on(sweeps, least, uninterrupted)


def test_rows_are_on_disk_one_by_one(sweeps):
    # a row is a transaction: what a second reader sees never shrinks, and never comes in one lump at the end
    process = sweeps.start(*RUN, "--transient", "5000")  # the later option counts: slow enough to be watched
    seen = set()
    sweeps.wait_for(lambda: seen.add(sweeps.rows()) or len(seen) >= 20, process, "the twentieth intermediate state was seen")
    sweeps.kill(process)
    assert max(seen) < ROWS
    assert math.gcd(*seen) == 1, seen  # nor in lumps of a fixed size


def test_ctrl_c(sweeps, uninterrupted):
    process = sweeps.start(*RUN)
    sweeps.wait_for_rows(process, 10)
    os.kill(worker_of(process), signal.SIGINT)  # a worker works on: the main process is to end it
    least = sweeps.wait_for_rows(process, 30)
    done = sweeps.kill(process, signal.SIGINT)
    assert done.complaint(code=130) == INTERRUPTED
    goes_on(sweeps, least, uninterrupted)


def test_ctrl_c_while_the_worker_starts(sweeps):
    # a terminal's signal may reach the worker first
    process = sweeps.start(*RUN)
    sweeps.wait_for(lambda: any("spawn_main" in line for line in children(process.pid).values()), process, "a worker was there")
    time.sleep(0.1)
    os.kill(worker_of(process), signal.SIGINT)
    time.sleep(0.5)  # time enough for it to say something
    assert sweeps.kill(process, signal.SIGINT).complaint(code=130) == INTERRUPTED


def test_ctrl_c_leaves_no_temporary_files(sweeps):
    process = sweeps.start(*RUN)
    sweeps.wait_for_rows(process, 5)
    sweeps.kill(process, signal.SIGINT)
    assert list(sweeps.temporary.iterdir()) == []


def test_a_killed_worker(sweeps, uninterrupted):
    process = sweeps.start(*RUN)
    least = sweeps.wait_for_rows(process, 20)
    os.kill(worker_of(process), signal.SIGKILL)
    sweeps.end(process).complaint("worker process", "goes on")
    goes_on(sweeps, least, uninterrupted)


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.slow)])
def test_kill_9_at_random_moments_in_a_row(sweeps, uninterrupted, seed):
    chance = random.Random(seed)
    kept = 0
    for _ in range(3):
        process = sweeps.start(*RUN)
        stop = time.monotonic() + chance.uniform(0.1, 1.5)  # start-up included
        sweeps.wait_for(lambda: time.monotonic() > stop or sweeps.rows() > kept + 60, process, "the moment came")  # noqa: B023 - used at once
        done = sweeps.kill(process)
        assert done.code == -signal.SIGKILL, done
        assert sweeps.rows() >= kept
        kept = sweeps.rows()
        if kept:
            with sqlite3.connect(sweeps.journal()) as database:
                assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
                assert [i for (i,) in database.execute("SELECT i FROM rows ORDER BY i")] == list(range(kept))
            database.close()
    goes_on(sweeps, kept, uninterrupted)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_no_worker_outlives_the_main_process(sweeps, number):
    process = sweeps.start(*RUN)
    sweeps.wait_for_rows(process, 5)
    worker = worker_of(process)
    os.kill(process.pid, number)
    process.wait()
    try:
        stop = time.monotonic() + 10.0
        while is_alive(worker) and time.monotonic() < stop:
            time.sleep(0.05)
        assert not is_alive(worker)
    finally:
        if is_alive(worker):
            os.kill(worker, signal.SIGKILL)


def test_ctrl_c_ends_sweeps_that_wait_for_their_turn_too(sweeps):
    cases = [option for e in (0.7, 0.6, 0.5, 0.4) for option in ("--case", f"e={e}")]
    process = sweeps.start("--eta", "1:3:0.0001", *cases, "--jobs", "1")
    sweeps.wait_for_rows(process, 5)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=8.0)
    assert Done(process.returncode, out, err).complaint(code=130) == INTERRUPTED


@pytest.fixture(scope="module")
def twice(tmp_path_factory, fmu):
    """Start the same command once more while it runs; yields both answers, and the sweeps."""
    commands = Sweeps(tmp_path_factory.mktemp("twice"), fmu)
    first = commands.start(*RUN)
    kept = commands.wait_for_rows(first, 5)
    os.killpg(first.pid, signal.SIGSTOP)  # while the second starts up
    second = commands.start(*RUN)
    stop = time.monotonic() + 2.5  # stopped inside a transaction, the first one would block the second
    while commands.rows() <= kept + 2 and second.poll() is None and time.monotonic() < stop:
        time.sleep(0.005)
    os.killpg(first.pid, signal.SIGCONT)
    yield (commands.end(first), commands.end(second)), commands
    commands.clean_up()


def test_the_same_command_twice_at_once_spoils_nothing(twice, uninterrupted):
    answers, sweeps = twice
    assert not any("Traceback" in answer.err for answer in answers)
    if all(answer.code for answer in answers):
        sweeps.run(*RUN).success()
    assert sweeps.result().read_bytes() == uninterrupted


def test_the_same_command_twice_at_once_is_refused_in_plain_words(twice):
    (complaint,) = [answer.complaint() for answer in twice[0] if answer.code]
    assert "UNIQUE" not in complaint
