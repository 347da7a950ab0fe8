"""The journal by itself: a sweep resumed at any row gives the same rows; a damaged journal is refused in one line."""

import os
import sqlite3

import numpy as np
import pytest

from orchestrate.commands.sweep_command import parse_etas
from orchestrate.errors import UserError
from orchestrate.fmu import describe
from orchestrate.store import Journal
from orchestrate.sweep import Case, Plan, Response, run

SHORT = ("--eta", "1.2:1.24:0.01", "--transient", "7", "--samples", "6")


@pytest.fixture(scope="module")
def plan(fmu):
    """Plan of SHORT: chaotic, so that a resumed sweep shows any wrong start."""
    return Plan(Case(), parse_etas(SHORT[1])[0], 7, 6, 1e-2, describe(fmu).guid)


@pytest.fixture(scope="module")
def rows(plan, fmu, tmp_path_factory):
    """Rows of the uninterrupted sweep."""
    journal = Journal(tmp_path_factory.mktemp("rows") / "journal", plan.identity())
    run(plan, fmu, journal)
    yield journal.rows()
    journal.close()


@pytest.mark.parametrize("done", range(6))
def test_resumed_at_any_row(plan, rows, fmu, tmp_path, done):
    journal = Journal(tmp_path / "journal", plan.identity())
    for index in range(done):
        journal.append(index, rows[index])
    run(plan, fmu, journal)
    np.testing.assert_array_equal(journal.rows(), rows)
    journal.close()


def test_rows_come_back_as_they_were(rows):
    assert rows.shape == (5, 8 + 6)
    for row in rows:
        response = Response.from_row(row)
        assert len(response.xi_rel) == 6
        np.testing.assert_array_equal(response.row(), row)
    assert len({tuple(Response.from_row(row).end) for row in rows}) == 5


def test_a_row_is_entered_once(plan, tmp_path):
    journal = Journal(tmp_path / "journal", plan.identity())
    journal.append(0, [1.0, 2.0])
    with pytest.raises(UserError, match="journal"):
        journal.append(0, [3.0, 4.0])
    np.testing.assert_array_equal(journal.rows(), [[1.0, 2.0]])
    journal.remove()
    assert list(tmp_path.iterdir()) == []


CREATED = (
    "CREATE TABLE identity (text TEXT)",
    "CREATE TABLE rows (i INTEGER PRIMARY KEY, data BLOB)",
)


@pytest.mark.parametrize("statements", range(3))
def test_killed_while_the_journal_is_made(plan, tmp_path, statements):
    path = tmp_path / "journal"
    path.touch()
    with sqlite3.connect(path) as database:
        for statement in CREATED[:statements]:
            database.execute(statement)
    database.close()
    journal = Journal(path, plan.identity())
    assert journal.length() == 0
    journal.close()
    Journal(path, plan.identity()).close()


@pytest.fixture
def damaged(sweeps, plan):
    """Journal of an interrupted sweep, long enough for several pages, to be damaged."""
    sweeps.output.mkdir()
    path = sweeps.journal()
    journal = Journal(path, plan.identity())
    for index in range(3):
        journal.append(index, np.ones(4000))
    journal.close()
    assert path.stat().st_size > 12 * 4096
    return path


TRUNCATED = [
    lambda data: data[: len(data) // 2],
    lambda data: data[:4096],
    lambda data: data[:1000],
    lambda _: os.urandom(5000),
]


@pytest.mark.parametrize(
    "damage", TRUNCATED, ids=["half", "first page", "part of a page", "random"]
)
def test_truncated_or_foreign_journal(sweeps, damaged, damage):
    damaged.write_bytes(damage(damaged.read_bytes()))
    sweeps.run(*SHORT).complaint(damaged, "journal", "allowed")
    assert not sweeps.result().exists()


def overwritten(path):
    """Random bytes in the place of the rows' pages; the header is whole."""
    data = path.read_bytes()
    path.write_bytes(data[:8192] + os.urandom(len(data) - 8192))


def shortened(path):
    """One row that has lost its end."""
    change(path, "UPDATE rows SET data = x'00' WHERE i = 2")


def other_tables(path):
    """Make a database that is not a journal."""
    change(
        path, "DROP TABLE rows", "CREATE TABLE rows (name TEXT)", "INSERT INTO rows VALUES ('x')"
    )


def no_identity(path):
    """Make the identity unreadable."""
    change(path, "UPDATE identity SET text = 'hello'")


def change(path, *statements):
    """Statements on a database."""
    with sqlite3.connect(path) as database:
        for statement in statements:
            database.execute(statement)
    database.close()


@pytest.mark.parametrize("damage", [overwritten, shortened, other_tables, no_identity])
def test_journal_with_damaged_contents(sweeps, damaged, damage):
    damage(damaged)
    sweeps.run(*SHORT).complaint(damaged.name)


def test_journal_of_another_run_names_the_difference(tmp_path, plan):
    Journal(tmp_path / "journal", plan.identity()).close()
    other = Plan(plan.case, plan.etas, plan.transient, 7, plan.tolerance, plan.fmu_guid)
    with pytest.raises(UserError) as error:
        Journal(tmp_path / "journal", other.identity())
    assert "samples = 6 there, 7 here" in str(error.value)
