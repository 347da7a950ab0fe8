"""Results are stored, resumed and read; they are never taken for another question's."""

import numpy as np
import pytest
import xarray as xr

from orchestrate.errors import InputError, StaleError, StoreError
from orchestrate.running.journal import Journal, journal_path, lock_result
from orchestrate.running.runner import compute_dataset

from .conftest import Find
from .sums import Squares, Sums, interrupted

JOB = Squares("squares")
SQUARES = np.arange(10.0) ** 2


def ask_until(item, job, running, find):
    with interrupted(type(job), item):
        compute_dataset(job, {**running, "jobs": 1}, find)


def computed(monkeypatch):
    items, work = [], Squares.work

    def note(self, fmus, chunk, previous):
        items.extend(chunk)
        return work(self, fmus, chunk, previous)

    monkeypatch.setattr(Squares, "work", note)
    return items


def test_an_interrupted_job_goes_on_and_is_read_when_it_is_finished(find, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    whole, broken = tmp_path / "whole.nc", tmp_path / "results" / "sums.nc"
    compute_dataset(Sums("sums", size=20), {"store": whole}, find)
    in_folder = {"store": tmp_path / "results"}  # a place without an ending is a folder
    ask_until(8, Sums("sums", size=20), in_folder, find)
    assert not broken.exists()
    items = computed(monkeypatch)
    for _ in range(2):
        first = compute_dataset(Sums("sums", size=20), in_folder, find)
        assert items == list(range(6, 20)), "two chunks were there"
    assert broken.read_bytes() == whole.read_bytes()
    assert first.identical(xr.load_dataset(whole).drop_attrs().assign_attrs(first.attrs))
    assert not journal_path(broken).exists()


def test_another_question_is_refused_and_nothing_is_lost(find, tmp_path):
    path, other = tmp_path / "squares.nc", Squares("squares", size=11)
    compute_dataset(JOB, {"store": path}, find)
    before = path.read_bytes()
    with pytest.raises(InputError, match=r"squares\.nc: .*size = 10 there, 11 here"):
        compute_dataset(other, {"store": path}, find)
    assert path.read_bytes() == before
    assert compute_dataset(other, {"store": path, "force": True}, find).sizes == {"number": 11}


def test_another_fmu_makes_a_result_stale(find: Find, tmp_path):
    path = tmp_path / "squares.nc"
    compute_dataset(JOB, {"store": path}, find)

    def other(model):
        return type(find(model))(find(model).path, model, "{2}")

    with pytest.raises(StaleError, match="made by another FMU"):
        compute_dataset(JOB, {"store": path}, other)
    for keyword, guid in (("keep_stale", "{1}"), ("force", "{2}")):
        found = compute_dataset(JOB, {"store": path, keyword: True}, other)
        assert found.attrs["fmu_guid"] == guid


def test_a_result_stays_until_the_one_computed_anew_is_whole(find, tmp_path, monkeypatch):
    path = tmp_path / "squares.nc"
    compute_dataset(JOB, {"store": path}, find)
    before, inode = path.read_bytes(), path.stat().st_ino
    ask_until(7, JOB, {"store": path, "force": True}, find)
    assert path.read_bytes() == before
    items = computed(monkeypatch)
    compute_dataset(JOB, {"store": path}, find)
    assert items == [6, 7, 8, 9], "the chunks from before the Ctrl-C were not taken"
    assert path.stat().st_ino != inode
    assert sorted(p.name for p in tmp_path.iterdir()) == ["model.fmu", "squares.nc"]


@pytest.mark.parametrize("damage", ["", "noise", "no chunk"])
@pytest.mark.parametrize("stored", [False, True])
def test_force_never_reads_a_journal_and_an_older_result_stays(
    find, tmp_path, monkeypatch, stored, damage
):
    """Where the run with force cannot be resumed either."""
    path = tmp_path / "squares.nc"
    if stored:
        compute_dataset(JOB, {"store": path}, find)
    ask_until(7, JOB, {"store": path, "force": stored}, find)
    place = journal_path(path, recomputing=stored)
    if damage == "noise":
        place.write_bytes(b"noise" * 1000)
    elif damage:
        journal = Journal(place, {}, "")
        for index in journal.keep_intact_chunks():
            journal.drop(index, "")
        journal.close()
    items = computed(monkeypatch)
    if stored and damage:
        assert np.array_equal(compute_dataset(JOB, {"store": path}, find).square, SQUARES)
        assert not items
    anew = compute_dataset(JOB, {"store": path, "force": True}, find)
    assert np.array_equal(anew.square, SQUARES)
    assert items == list(range(10))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["model.fmu", "squares.nc"]


@pytest.mark.parametrize("kind", ["NetCDF with an identity", "text", "empty"])
def test_a_file_of_others_is_never_replaced(find, tmp_path, kind):
    path = tmp_path / "squares.nc"
    if kind.startswith("NetCDF"):
        xr.Dataset({"measured": ("x", [1.0])}, attrs={"identity": '{"mine": 1}'}).to_netcdf(path)
    else:
        path.write_text("notes" * (kind == "text"))
    before = path.read_bytes()
    for force in (False, True):
        with pytest.raises(StoreError, match=r"squares\.nc: .*remove it and compute it again"):
            compute_dataset(JOB, {"store": path, "force": force}, find)
        assert path.read_bytes() == before
    assert sorted(p.name for p in tmp_path.iterdir()) == ["model.fmu", "squares.nc"]


def test_one_process_at_a_time(find, tmp_path):
    path = tmp_path / "squares.nc"
    lock = lock_result(path)
    with pytest.raises(InputError, match="another process is computing it"):
        compute_dataset(JOB, {"store": path}, find)
    lock.release()
    compute_dataset(JOB, {"store": path}, find)
    assert {path.name for path in tmp_path.iterdir()} == {"model.fmu", "squares.nc"}
