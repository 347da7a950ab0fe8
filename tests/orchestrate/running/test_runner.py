"""Results do not depend on who computes them, nor on how often they were interrupted."""

from __future__ import annotations

import asyncio
import functools
import logging
import os
from concurrent.futures import Future
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestrate.errors import InputError, StaleError, StoreError, WorkerError
from orchestrate.running import runner
from orchestrate.running.cluster import Cluster, is_worth_logging
from orchestrate.running.executors import compute, running_workers
from orchestrate.running.journal import Journal, Lock, journal_path
from orchestrate.running.options import RunOptions
from orchestrate.running.runner import answer, answer_all, gather

from .conftest import Find
from .sums import Gathered, Squares, Sums

SQUARES = np.arange(10.0) ** 2


def test_a_job_without_a_store_is_answered_in_memory(find, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = answer(Squares("squares"), {}, find)
    assert np.array_equal(found.square, SQUARES)
    assert [path.name for path in tmp_path.iterdir()] == ["model.fmu"]


def test_where_it_comes_from_is_in_the_attributes(find, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    found = answer(Squares("squares", size=7), {}, find).attrs
    assert found["size"] == 7
    assert found["fmu_guid"] == "{1}"
    assert found["call"] == "Squares(size=7, pause=0.0, fail_at=-1)"
    assert found["history"] == f"1970-01-02T00:00:00Z: {found['call']}"


def test_lanes_know_nothing_of_each_other(find):
    found = answer(Sums("sums", size=12), {}, find)["sum"]
    squares = np.arange(12.0) ** 2
    assert np.array_equal(found, [*np.cumsum(squares[:6]), *np.cumsum(squares[6:])])


@pytest.mark.parametrize("size", [1, 3, 10])
def test_what_gathers_starts_when_all_others_are_there(find, size):
    job = Gathered("all", size=size)
    assert [chunk.stop - chunk.start for chunk in job.chunks()][-1] == 1
    assert float(answer(job, {}, find)["whole"]) == (np.arange(size) ** 2.0).sum()


@pytest.mark.parametrize(
    "job", [Squares("job", size=40), Sums("job", size=40), Gathered("job", size=40)]
)
def test_processes_give_what_this_process_gives(find, monkeypatch, job):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    alone = answer(job, {"jobs": 1}, find)
    monkeypatch.setattr(runner, "MIN_PARALLEL_SECONDS", 0.0)
    assert answer(job, {"jobs": 2}, find).identical(alone)


def test_several_jobs_are_stored_in_a_folder(find, tmp_path):
    paths = answer_all([Squares("squares"), Sums("sums")], tmp_path, RunOptions(), find)
    assert np.array_equal(xr.load_dataset(paths["squares"]).square, np.arange(10.0) ** 2)
    assert xr.load_dataset(paths["sums"]).sizes["number"] == 10


def test_jobs_side_by_side_come_in_their_order(find):
    first, second = gather([Squares("a"), Squares("b", size=3)], {}, find)
    assert (first.sizes["number"], second.sizes["number"]) == (10, 3)


def test_the_bar_says_what_is_done_aside(find, monkeypatch, capfd):
    """While its last chunk is at work the bar stands still: what it does is said before."""
    monkeypatch.setattr(runner, "BAR_DELAY", 0.0)
    monkeypatch.setattr(
        Sums, "progress_note", lambda self, first: "counting again" if first == 8 else ""
    )
    answer(Sums("sums"), {"jobs": 1}, find)
    shown = capfd.readouterr().err
    assert "sums, counting again:" in shown and "sums:" in shown


def test_an_interrupted_job_goes_on(find, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    whole, broken = tmp_path / "whole.nc", tmp_path / "broken.nc"
    answer(Sums("sums", size=20), {"store": whole}, find)
    work, calls = Squares.work, []

    def interrupted(self, fmus, items, carry):
        calls.append(items)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return work(self, fmus, items, carry)

    monkeypatch.setattr(Squares, "work", interrupted)
    with pytest.raises(KeyboardInterrupt):
        answer(Sums("sums", size=20), {"store": broken}, find)
    assert not broken.exists()
    answer(Sums("sums", size=20), {"store": broken}, find)
    assert len(calls) == 3 + len(Sums("sums", size=20).chunks()) - 2  # two were there
    assert broken.read_bytes() == whole.read_bytes()
    assert not journal_path(broken).exists()


def test_a_finished_result_is_read_not_computed(find, tmp_path, monkeypatch):
    path = tmp_path / "squares.nc"
    first = answer(Squares("squares"), {"store": path}, find)
    monkeypatch.setattr(Squares, "work", lambda *_: pytest.fail("computed again"))
    assert answer(Squares("squares"), {"store": path}, find).identical(first)


def test_a_journal_that_a_killed_process_left_beside_its_result_goes(find, tmp_path):
    path = tmp_path / "squares.nc"
    answer(Squares("squares"), {"store": path}, find)
    for ending in ("", "-wal", "-shm"):
        Path(f"{journal_path(path)}{ending}").write_bytes(b"left")
    answer(Squares("squares"), {"store": path}, find)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["model.fmu", "squares.nc"]


def test_another_question_is_refused_and_nothing_is_lost(find, tmp_path):
    path = tmp_path / "squares.nc"
    answer(Squares("squares"), {"store": path}, find)
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"squares\.nc: .*size = 10 there, 11 here"):
        answer(Squares("squares", size=11), {"store": path}, find)
    assert path.read_bytes() == before
    assert answer(Squares("squares", size=11), {"store": path, "force": True}, find).sizes == {
        "number": 11
    }


def test_another_fmu_makes_a_result_stale(find: Find, tmp_path):
    path = tmp_path / "squares.nc"
    answer(Squares("squares"), {"store": path}, find)

    def other(model):
        return type(find(model))(find(model).path, model, "{2}")

    with pytest.raises(StaleError, match="made by another FMU"):
        answer(Squares("squares"), {"store": path}, other)
    kept = answer(Squares("squares"), {"store": path, "keep_stale": True}, other)
    assert kept.attrs["fmu_guid"] == "{1}"
    anew = answer(Squares("squares"), {"store": path, "force": True}, other)
    assert anew.attrs["fmu_guid"] == "{2}"


def stopped_at(item, monkeypatch, job, options, find):
    """Ask, with a Ctrl-C when that item is computed."""
    work = type(job).work

    def stop(self, fmus, items, carry):
        if item in items:
            raise KeyboardInterrupt
        return work(self, fmus, items, carry)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(type(job), "work", stop)
        answer(job, {**options, "jobs": 1}, find)


def test_a_result_stays_until_the_one_computed_anew_is_whole(find, tmp_path, monkeypatch):
    job, path = Squares("squares"), tmp_path / "squares.nc"
    answer(job, {"store": path}, find)
    before, inode = path.read_bytes(), path.stat().st_ino
    stopped_at(7, monkeypatch, job, {"store": path, "force": True}, find)
    assert path.read_bytes() == before
    assert answer(job, {"store": path}, find).square.values.tolist()[-1] == 81.0
    asked, work = [], Squares.work

    def noted(self, fmus, items, carry):
        asked.extend(items)
        return work(self, fmus, items, carry)

    monkeypatch.setattr(Squares, "work", noted)
    answer(job, {"store": path, "force": True, "jobs": 1}, find)
    assert asked == [6, 7, 8, 9], "the chunks from before the Ctrl-C were not taken"
    assert path.stat().st_ino != inode
    assert sorted(p.name for p in tmp_path.iterdir()) == ["model.fmu", "squares.nc"]
    answer(job, {"store": path, "force": True, "jobs": 1}, find)
    assert asked[4:] == list(range(10))


@pytest.mark.parametrize("kind", ["NetCDF", "NetCDF with an identity", "text", "empty"])
def test_a_file_of_others_is_never_replaced(find, tmp_path, kind):
    path = tmp_path / "squares.nc"
    if kind.startswith("NetCDF"):
        attributes = {"identity": '{"mine": 1}'} if kind.endswith("identity") else {}
        xr.Dataset({"measured": ("x", [1.0, 2.0])}, attrs=attributes).to_netcdf(path)
    else:
        path.write_text("notes" * (kind == "text"))
    before = path.read_bytes()
    for force in (False, True):
        with pytest.raises(StoreError, match=r"squares\.nc: .*remove it and compute it again"):
            answer(Squares("squares"), {"store": path, "force": force}, find)
        assert path.read_bytes() == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["model.fmu", "squares.nc"]


def test_a_damaged_chunk_is_computed_anew(find, tmp_path, monkeypatch):
    path = tmp_path / "squares.nc"
    with pytest.raises(AssertionError, match="as it was told to"):
        answer(Squares("squares", fail_at=7), {"store": path}, find)
    journal = Journal(journal_path(path), {}, "")
    assert journal.indices() == {0, 1}
    journal._query("UPDATE chunks SET data = substr(data, 1, length(data) - 1) || 'x' WHERE i = 1")
    assert journal.indices() == {0}
    journal.close()


@pytest.mark.parametrize("place", [20, 100, 4100, 8192, 8200, -4000, -1])
def test_a_flipped_bit_of_the_journal(find, tmp_path, monkeypatch, place):
    """The answer is right, or the message names the file and says what to do."""
    path, work = tmp_path / "squares.nc", Squares.work

    def interrupted(self, fmus, items, carry):
        if 7 in items:
            raise KeyboardInterrupt
        return work(self, fmus, items, carry)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Squares, "work", interrupted)
        answer(Squares("squares"), {"store": path}, find)
    journal = journal_path(path)
    data = bytearray(journal.read_bytes())
    data[place] ^= 0x10
    journal.write_bytes(data)
    try:
        found = answer(Squares("squares"), {"store": path}, find)
    except StoreError as error:
        assert str(journal) in str(error) and "remove it" in str(error), error
    else:
        assert found.square.values.tolist() == [float(i * i) for i in range(10)]


def test_a_journal_that_is_none(find, tmp_path):
    path = tmp_path / "squares.nc"
    journal_path(path).write_bytes(b"not a database" * 1000)
    with pytest.raises(StoreError, match="remove it and compute it again"):
        answer(Squares("squares"), {"store": path}, find)


def test_a_file_that_is_no_result(find, tmp_path):
    path = tmp_path / "squares.nc"
    path.write_text("notes")
    with pytest.raises(StoreError, match="not a result of this project"):
        answer(Squares("squares"), {"store": path}, find)
    assert path.read_text() == "notes"


def test_one_process_at_a_time(find, tmp_path):
    path = tmp_path / "squares.nc"
    lock = Lock(path)
    with pytest.raises(InputError, match="another process is computing it"):
        answer(Squares("squares"), {"store": path}, find)
    lock.release()
    answer(Squares("squares"), {"store": path}, find)
    assert {path.name for path in tmp_path.iterdir()} == {"model.fmu", "squares.nc"}


def test_a_folder_that_cannot_be_made(find, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="expected a folder that can be written"):
        answer(Squares("squares"), {"store": tmp_path / "file" / "squares.nc"}, find)


def test_a_worker_with_other_sources_computes_nothing():
    with pytest.raises(WorkerError, match=r"other sources \(orchestrate/version\.py\)"):
        compute(Squares("squares"), {}, [1], None, (), {"orchestrate.version": "other"})
    assert compute(Squares("squares"), {}, [3], None, (), {})[1]["square"] == [9.0]


def test_of_dasks_log_only_a_lost_connection_is_left_out():
    def record(text, error=None):
        told = (type(error), error, None) if error else None
        return logging.LogRecord("tornado", logging.ERROR, "", 1, text, (), told)

    assert is_worth_logging(record("slow"))
    assert is_worth_logging(record("wrong", ValueError("5")))
    assert not is_worth_logging(record("", ConnectionRefusedError(111, "refused")))
    assert not is_worth_logging(record("exception=CommClosedError('in <TCP>')"))
    assert not is_worth_logging(record("", asyncio.CancelledError()))
    assert not is_worth_logging(record("Failed to reconnect to scheduler after 5 seconds"))


class Lost:
    """A client of Dask whose scheduler has ended while it was asked for something."""

    lasts = 2  # calls

    def __init__(self, *_, when="", **__):
        self.when, self.status, self.calls = when, "running", 0

    def there(self, name):
        self.calls += name == "ncores"
        if name == self.when or self.calls > self.lasts or self.status != "running":
            self.status = "connecting"
            raise OSError(f"in <TCP (closed)> {name}")

    def ncores(self):
        self.there("ncores")
        return {"one": 1}

    def get_executor(self, **_):
        return self

    def submit(self, *_):
        self.there("submit")
        return Future()

    def shutdown(self, wait):
        self.there("shutdown")

    def close(self):
        self.there("close")


def false_client(monkeypatch, client):
    """Dask with another client, whose address is greeted by nobody."""
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed, "Client", client)

    async def greet(address):
        pass

    monkeypatch.setattr("orchestrate.running.cluster.check_scheduler", greet)
    return distributed


@pytest.mark.parametrize("when", ["ncores", "submit", ""])
def test_a_scheduler_that_ends_is_told(find, tmp_path, monkeypatch, when):
    false_client(monkeypatch, functools.partial(Lost, when=when))
    with pytest.raises(WorkerError, match=r"has ended; .* the same call goes on from there"):
        answer(Squares("squares"), {"cluster": "tcp://127.0.0.1:1"}, find)


def test_what_has_been_computed_needs_no_scheduler_for_the_end(monkeypatch):
    false_client(monkeypatch, functools.partial(Lost, when="shutdown"))
    with running_workers(Cluster("tcp://127.0.0.1:1")) as workers:
        assert workers.max_in_flight() == 2


def test_workers_of_a_cluster_that_die_are_told(find, monkeypatch):
    distributed = false_client(monkeypatch, Lost)
    monkeypatch.setattr(Lost, "lasts", 99)
    died = Future()
    died.set_exception(distributed.KilledWorker("compute", None, 3))
    monkeypatch.setattr(Lost, "submit", lambda *_: died)
    with pytest.raises(WorkerError, match=r"workers of the cluster ended without a word"):
        answer(Squares("squares"), {"cluster": "tcp://127.0.0.1:1"}, find)


def test_something_else_than_a_scheduler_answers(find, monkeypatch):
    def answers(*_, **__):
        raise MemoryError("an array of 3 EiB")  # a length, as Dask reads it

    false_client(monkeypatch, answers)
    with pytest.raises(InputError, match="no scheduler answers there"):
        answer(Squares("squares"), {"cluster": "tcp://127.0.0.1:1"}, find)


def test_a_bar_that_is_shown_early_ends_its_line(find, monkeypatch, capsys):
    monkeypatch.setattr(runner.Runner, "describe", shown_early(runner.Runner.describe))
    with pytest.raises(AssertionError, match="as it was told to"):
        answer(Squares("squares", fail_at=0), {"progress": True, "jobs": 1}, find)
    shown = capsys.readouterr().err
    assert "0/10" in shown
    assert shown.endswith("\n")


def shown_early(describe):
    """Describe a job that began long before its bar."""

    def described(self, bar, note):
        self.start_time -= 10.0
        describe(self, bar, note)

    return described


def test_a_worker_that_dies_is_told(find, monkeypatch):
    monkeypatch.setattr(runner, "MIN_PARALLEL_SECONDS", 0.0)
    with pytest.raises(WorkerError, match="a worker process ended without a word"):
        answer(Dying("dying", size=30), {"jobs": 2}, find)


class Dying(Squares):
    """Kills the process that computes its last chunks."""

    def work(self, fmus, items, previous):
        if items[0] > 6:
            os.kill(os.getpid(), 9)
        return super().work(fmus, items, previous)


@pytest.mark.parametrize(
    ("running", "text"),
    [
        ({"jobs": 0}, "jobs = 0: expected a whole number from 1"),
        ({"jobs": 1000000}, "jobs = 1000000: expected"),
        ({"jobs": 1.5}, r"jobs = 1\.5: expected"),
        ({"cluster": "tcp://127.0.0.1:1"}, "no scheduler answers there"),
    ],
)
def test_wrong_keywords(find, running, text):
    with pytest.raises(InputError, match=text):
        answer(Squares("squares"), running, find)


def test_an_unknown_keyword_is_an_error_of_pythons_kind(find):
    with pytest.raises(TypeError, match="'job'"):
        answer(Squares("squares"), {"job": 2}, find)


def test_a_store_without_an_ending_is_a_folder(find, tmp_path: Path):
    answer(Squares("squares"), {"store": tmp_path / "results"}, find)
    assert (tmp_path / "results" / "squares.nc").is_file()
