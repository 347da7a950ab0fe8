"""Journal: SQLite file with the computed chunks of an unfinished job, with checksums; lock.

An SQLite database, one chunk a row, one transaction a row: a process killed at any moment loses the
chunks that were being computed, a full disk the one that was being written. Each row is sealed: its
checksum, verified on reading, covers the job, the chunk's number and its content, so a row that was
damaged, moved or brought from elsewhere is recomputed.
"""

from __future__ import annotations

import hashlib
import io
import json
import logging
import sqlite3
from pathlib import Path

import numpy as np

from ..errors import InputError, StoreError
from ..files import HeldLock
from .identity import Identity
from .job import Table

log = logging.getLogger(__name__)
ENDINGS = ("", "-wal", "-shm")  # files of a database
ANEW = "remove it and compute it again"


def journal_path(result: Path, recomputing: bool = False) -> Path:
    """Return the path of a result file's journal; ``recomputing``: of the one for ``force``."""
    return result.with_name(f"{result.name}{'.anew' * recomputing}.journal")


def delete_journal_files(path: Path) -> None:
    for ending in ENDINGS:
        Path(f"{path}{ending}").unlink(missing_ok=True)


def table_to_bytes(table: Table) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **table)  # type: ignore[arg-type]
    return stream.getvalue()


def table_from_bytes(data: bytes) -> Table:
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        return dict(arrays)


def checksum_of_parts(*parts: bytes) -> str:
    """Return the SHA-256 of several byte strings, each preceded by its length."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


class Journal:
    """SQLite database of one job's computed chunks and its identity."""

    def __init__(self, path: Path, identity: Identity, begun: str) -> None:
        self.path = path
        self._identity_text = b""  # part of each row's checksum
        try:
            self._db = sqlite3.connect(path, timeout=30.0, isolation_level=None)
            self._db.execute("PRAGMA journal_mode=WAL")
            self._db.execute("PRAGMA synchronous=NORMAL")  # a power cut may cost the last chunks
            self._db.execute("CREATE TABLE IF NOT EXISTS about (name TEXT PRIMARY KEY, text TEXT)")
            columns = "i INTEGER PRIMARY KEY, sha256 TEXT, data BLOB"
            self._db.execute(f"CREATE TABLE IF NOT EXISTS chunks ({columns})")
            self._write_identity_if_new(json.dumps(identity), begun)
            self.identity, self.begun = self._read_identity()
        except (sqlite3.Error, OSError, ValueError, KeyError, TypeError) as error:
            self.close()
            expected = f"expected a writable place or a journal of this job: {ANEW}"
            raise StoreError(f"{path}: not usable as a journal ({error}); {expected}") from error

    def _write_identity_if_new(self, identity: str, begun: str) -> None:
        """Write identity, start time and their checksum into a new journal; keep an old one's."""
        self._db.execute("BEGIN IMMEDIATE")
        if not self._db.execute("SELECT 1 FROM about LIMIT 1").fetchall():
            entries = {"identity": identity, "begun": begun}
            entries["sha256"] = checksum_of_parts(identity.encode(), begun.encode())
            self._db.executemany("INSERT INTO about VALUES (?, ?)", entries.items())
        self._db.execute("COMMIT")

    def _read_identity(self) -> tuple[Identity, str]:
        """Return the journal's identity and start time; raise ValueError if it is damaged."""
        if self._db.execute("PRAGMA quick_check(1)").fetchall() != [("ok",)]:
            raise ValueError("damaged")
        entries = dict(self._db.execute("SELECT name, text FROM about").fetchall())
        identity, begun = entries.get("identity"), entries.get("begun")
        if not (isinstance(identity, str) and isinstance(begun, str)):
            raise ValueError("it does not say of what job")
        if entries.get("sha256") != checksum_of_parts(identity.encode(), begun.encode()):
            raise ValueError("damaged, or of an earlier version")
        self._identity_text = identity.encode()
        restored: Identity = json.loads(identity)
        return restored, begun

    def _row_checksum(self, index: int, data: bytes) -> str:
        return checksum_of_parts(self._identity_text, str(index).encode(), data)

    def keep_intact_chunks(self) -> set[int]:
        """Delete chunks with a wrong checksum; return the numbers of the others."""
        numbers = {index for (index,) in self._query("SELECT i FROM chunks")}
        for index in sorted(numbers):  # one after the other: together they may not fit in memory
            if not self._verified_data(index):
                self.drop(index, "damaged")
                numbers.remove(index)
        return numbers

    def _verified_data(self, index: int) -> bytes:
        rows = self._query("SELECT sha256, CAST(data AS BLOB) FROM chunks WHERE i = ?", index)
        for digest, data in rows:
            if isinstance(data, bytes) and self._row_checksum(index, data) == digest:
                return data
        return b""

    def drop(self, index: int, reason: str) -> None:
        if reason:
            log.warning("%s: chunk %s is %s, it is recomputed", self.path, index, reason)
        self._query("DELETE FROM chunks WHERE i = ?", index)

    def is_empty(self) -> bool:
        return not self._query("SELECT 1 FROM chunks LIMIT 1")

    def get(self, index: int) -> Table:
        if data := self._verified_data(index):
            return table_from_bytes(data)
        raise StoreError(f"{self.path}: chunk {index} is damaged; repeat the call to recompute it")

    def put(self, index: int, table: Table) -> None:
        data = table_to_bytes(table)
        values = index, self._row_checksum(index, data), data
        self._query("INSERT OR REPLACE INTO chunks VALUES (?, ?, ?)", *values)

    def _query(self, statement: str, *values: object) -> list[tuple]:  # type: ignore[type-arg]
        """Run an SQL statement; return all rows; SQLite's errors become ``StoreError``."""
        try:
            return self._db.execute(statement, values).fetchall()
        except (sqlite3.Error, OverflowError) as error:
            advice = "what was computed before is kept; repeat the call to resume (without force)"
            if any(word in str(error) for word in ("malformed", "not a database", "decode")):
                advice = ANEW
            raise StoreError(f"{self.path}: {error}; {advice}") from error

    def close(self) -> None:
        if hasattr(self, "_db"):
            self._db.close()

    def delete(self) -> None:
        self.close()
        delete_journal_files(self.path)


def lock_result(path: Path) -> HeldLock:
    place = path.with_name(f"{path.name}.lock")
    try:
        return HeldLock(place)
    except BlockingIOError:
        advice = "wait for it, or choose another place"
        raise InputError(f"{path}: another process is computing it; {advice}") from None
    except OSError as error:
        expected = "a writable place where no folder or other file of this name is: remove that"
        reason = error.strerror or error
        raise StoreError(f"{place}: cannot be made ({reason}); expected {expected}") from error
