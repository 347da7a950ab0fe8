"""Damaged journals and results: told with what to do, or computed anew; never other numbers."""

from __future__ import annotations

import random
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestrate.errors import InputError, StoreError
from orchestrate.running.checksum import ATTRIBUTE, checksum
from orchestrate.running.journal import Journal, checksum_of_parts, journal_path
from orchestrate.running.runner import answer
from orchestrate.running.store import load, write_netcdf
from tests.faults import FILE_DAMAGE, ROW_DAMAGE, a_shorter_row, arrays, rows, too_many_rows
from tests.sparing import ordinary

from .sums import Squares

SQUARES = [float(i * i) for i in range(30)]
JOB = Squares("squares", size=30)


@pytest.fixture
def interrupted(find, tmp_path, monkeypatch) -> Path:
    """The result's path of a job that was interrupted after seven of ten chunks."""
    path, work = tmp_path / "squares.nc", Squares.work

    def stop(self, fmus, items, carry):
        if 22 in items:
            raise KeyboardInterrupt
        return work(self, fmus, items, carry)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Squares, "work", stop)
        answer(JOB, {"store": path, "jobs": 1}, find)  # other processes would not be stopped
    return path


def right_or_told(path: Path, damaged: Path, find) -> str:
    """The message where the job is refused, in a line with its remedy; else the answer is right."""
    try:
        found = answer(JOB, {"store": path}, find)
    except (StoreError, InputError) as error:
        text = str(error)
        assert "\n" not in text
        assert str(damaged) in text
        assert "remove it" in text, text
        return text
    assert found.square.values.tolist() == SQUARES
    return ""


@pytest.mark.parametrize("damage", [*FILE_DAMAGE, *ROW_DAMAGE])
@pytest.mark.parametrize("seed", ordinary(range(4)))
def test_a_damaged_journal(interrupted, find, damage, seed):
    journal = journal_path(interrupted)
    {**FILE_DAMAGE, **ROW_DAMAGE}[damage](journal, random.Random(seed))
    if right_or_told(interrupted, journal, find):
        found = answer(JOB, {"store": interrupted, "force": True}, find)
        assert found.square.values.tolist() == SQUARES


@pytest.mark.slow
@pytest.mark.parametrize("damage", FILE_DAMAGE)
def test_a_journal_damaged_in_many_ways(interrupted, find, damage):
    journal = journal_path(interrupted)
    whole = journal.read_bytes()
    for seed in range(250):
        interrupted.unlink(missing_ok=True)
        for ending in ("", "-wal", "-shm"):
            Path(f"{journal}{ending}").unlink(missing_ok=True)
        journal.write_bytes(whole)
        FILE_DAMAGE[damage](journal, random.Random(seed))
        right_or_told(interrupted, journal, find)


@pytest.mark.parametrize(
    ("damage", "text"),
    [(a_shorter_row, "not of 3 items"), (too_many_rows, "none of the 10 of this job")],
)
def test_sealed_rows_that_are_not_this_jobs_are_computed_anew(
    interrupted, find, caplog, damage, text
):
    """Even where whoever changed them knew how rows are sealed."""
    path = journal_path(interrupted)
    damage(path, random.Random(1))
    journal = Journal(path, {}, "")
    for index, data in rows(path):
        journal._query(
            "UPDATE chunks SET sha256 = ? WHERE i = ?", journal._row_checksum(index, data), index
        )
    journal.close()
    assert answer(JOB, {"store": interrupted}, find).square.values.tolist() == SQUARES
    assert text in caplog.text


def test_a_row_damaged_while_the_job_runs_makes_no_shorter_result(interrupted, find, monkeypatch):
    """What was sound when the job went on may be damaged when it is put together."""
    work, path = Squares.work, journal_path(interrupted)

    def damage(self, fmus, items, carry):
        journal = Journal(path, {}, "")
        journal._query("UPDATE chunks SET data = x'00' WHERE i = 2")
        journal.close()
        return work(self, fmus, items, carry)

    with monkeypatch.context() as patch, pytest.raises(StoreError, match="chunk 2 is damaged"):
        patch.setattr(Squares, "work", damage)
        answer(JOB, {"store": interrupted, "jobs": 1}, find)
    assert not interrupted.exists()
    assert answer(JOB, {"store": interrupted}, find).square.values.tolist() == SQUARES


def test_a_seal_covers_where_parts_end():
    assert checksum_of_parts(b"ab", b"c") != checksum_of_parts(b"a", b"bc")


@pytest.mark.parametrize("stop", range(4))
def test_killed_while_it_is_finished_it_leaves_nothing_behind(
    interrupted, find, tmp_path, monkeypatch, stop
):
    """Before any of the files goes that a finished result needs no more."""
    unlink, journal, gone = Path.unlink, journal_path(interrupted), []

    def killed(path, missing_ok=False):
        if interrupted.exists() and path.name.startswith(journal.name):
            gone.append(path)
            if len(gone) > stop:
                raise KeyboardInterrupt
        unlink(path, missing_ok=missing_ok)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", killed)
        with suppress(KeyboardInterrupt):
            answer(JOB, {"store": interrupted, "jobs": 1}, find)
    assert journal.exists() == (stop == 0)
    assert answer(JOB, {"store": interrupted}, find).square.values.tolist() == SQUARES
    assert {path.name for path in tmp_path.iterdir()} == {interrupted.name, "model.fmu"}


def test_rows_of_an_earlier_version_are_not_taken(interrupted, find):
    """They had no seal of the journal itself."""
    journal = Journal(journal_path(interrupted), {}, "")
    journal._query("DELETE FROM about WHERE name = 'sha256'")
    journal.close()
    with pytest.raises(StoreError, match=r"earlier version.*remove it and compute it again"):
        answer(JOB, {"store": interrupted}, find)


@pytest.mark.parametrize("ending", [".journal", ".lock"])
def test_a_folder_in_the_place_of_a_file(find, tmp_path, ending):
    path = tmp_path / "squares.nc"
    Path(f"{path}{ending}").mkdir()
    with pytest.raises(StoreError, match=rf"{ending}.*expected.*remove"):
        answer(JOB, {"store": path}, find)


def test_a_folder_in_the_place_of_the_result(find, tmp_path):
    path = tmp_path / "squares.nc"
    path.mkdir()
    for force in (False, True):
        with pytest.raises((StoreError, InputError), match=r"squares\.nc: .*expected"):
            answer(JOB, {"store": path, "force": force}, find)


# -- results --------------------------------------------------------------------------------------


@pytest.mark.parametrize("damage", FILE_DAMAGE)
@pytest.mark.parametrize("seed", range(4))
def test_a_damaged_result(find, tmp_path, damage, seed):
    path = tmp_path / "squares.nc"
    answer(JOB, {"store": path}, find)
    FILE_DAMAGE[damage](path, random.Random(seed))
    try:
        found = answer(JOB, {"store": path}, find)
    except (StoreError, InputError) as error:
        assert "\n" not in str(error)
        assert str(path) in str(error) and "remove it" in str(error)
        try:
            found = answer(JOB, {"store": path, "force": True}, find)
        except StoreError as refused:  # what it was cannot be read any more
            assert "not a result of this project, or damaged" in str(refused)
            path.unlink()
            found = answer(JOB, {"store": path}, find)
    assert found.square.values.tolist() == SQUARES


@pytest.mark.slow
def test_flipped_bits_of_a_result_are_seen(find, tmp_path):
    path = tmp_path / "squares.nc"
    whole = answer(JOB, {"store": path}, find)
    content, seen = path.read_bytes(), 0
    for seed in range(1000):
        path.write_bytes(content)
        FILE_DAMAGE["a flipped bit"](path, random.Random(seed))
        try:
            found = load(path)
        except StoreError:
            seen += 1
        else:  # in bytes that say nothing, or in the name of an attribute
            assert found.drop_attrs().identical(whole.drop_attrs())
    assert seen > 0


def test_numbers_changed_by_hand_are_told(find, tmp_path):
    import netCDF4

    path = tmp_path / "squares.nc"
    answer(JOB, {"store": path}, find)
    with netCDF4.Dataset(path, "a") as file:
        file["square"][4] = 17.0
    with pytest.raises(StoreError, match="do not fit its checksum"):
        answer(JOB, {"store": path}, find)
    with netCDF4.Dataset(path, "a") as file:
        file.delncattr(ATTRIBUTE)  # as the message says; and as results of earlier versions are
    assert answer(JOB, {"store": path}, find).square.values[4] == 17.0


def test_other_tools_read_a_result(find, tmp_path):
    import netCDF4

    path = tmp_path / "squares.nc"
    answer(JOB, {"store": path}, find)
    with netCDF4.Dataset(path) as file:
        assert file["square"][:].tolist() == SQUARES
    with xr.open_dataset(path) as data:
        assert data.square.values.tolist() == SQUARES
        assert data.attrs[ATTRIBUTE] == checksum(data)


def test_a_checksum_is_the_same_after_writing_and_reading(tmp_path):
    data = xr.Dataset(
        {
            "number": ("x", [1.0, np.nan, -np.nan, np.inf, -0.0]),
            "whole": ("x", np.arange(5), {"flag_values": np.arange(5, dtype=np.int8)}),
            "small": ("x", np.arange(5, dtype=np.int8)),
            "single": ("x", np.arange(5, dtype=np.float32)),
            "yes": ("x", [True, False, True, False, True]),
            "word": ("x", ["a", "bc", "", "é", "e"]),
            "alone": ((), 3.0, {"units": "m", "long_name": "é", "one": [1.5], "none": ""}),
            "empty": ("nothing", np.zeros(0)),
        },
        coords={"x": ("x", np.linspace(0.0, 1.0, 5), {"units": "s"}), "label": "up"},
        attrs={"size": 3, "flag": np.int64(4), "list": [1, 2], "single": [2.5], "text": "t"},
    )
    path = write_netcdf(data, tmp_path / "data.nc")
    assert load(path).equals(xr.load_dataset(path))  # or it would be told to be damaged
    moved = data.assign(number=("x", data.number.values[::-1]))
    assert len({checksum(part) for part in (data, moved, data.drop_vars("yes"))}) == 3


def test_arrays_of_a_row_come_back(interrupted):
    index, data = rows(journal_path(interrupted))[2]
    assert arrays(data)["square"].tolist() == SQUARES[3 * index : 3 * index + 3]
