"""Chunks on disk while a job is under way.

An SQLite database, one chunk a row, one transaction a row: a process killed at any moment loses the
chunks that were being computed, a full disk the one that was being written. Each row is sealed: its
checksum, verified on reading, covers the job, the chunk's number and its content, so a row that was
damaged, moved or brought from elsewhere is computed anew.
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
from .identity import Identity
from .job import Table

log = logging.getLogger(__name__)
ENDINGS = ("", "-wal", "-shm")  # files of a database
ANEW = "remove it to begin anew"


def journal_path(result: Path, anew: bool = False) -> Path:
    """Where the journal of a result lies; another one where a finished result is computed anew."""
    return result.with_name(f"{result.name}{'.anew' * anew}.journal")


def discard(path: Path) -> None:
    """Delete a journal's files."""
    for ending in ENDINGS:
        Path(f"{path}{ending}").unlink(missing_ok=True)


def pack(table: Table) -> bytes:
    """Arrays as bytes."""
    stream = io.BytesIO()
    np.savez(stream, **table)  # type: ignore[arg-type]
    return stream.getvalue()


def unpack(data: bytes) -> Table:
    """The inverse of :func:`pack`."""
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        return dict(arrays)


def seal(*parts: bytes) -> str:
    """A checksum of several texts, and of where one ends and the next begins."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


class Journal:
    """Chunks of one job.

    Parameters
    ----------
    path : Path
    identity : dict
        What the chunks answer; entered where the journal is new.
    begun : str
        When the job was begun; entered where the journal is new.

    Attributes
    ----------
    identity : dict
        What the chunks on disk answer.
    begun : str
    """

    def __init__(self, path: Path, identity: Identity, begun: str) -> None:
        self.path = path
        self._about = b""  # what each row's seal covers, beside the row
        try:
            self._db = sqlite3.connect(path, timeout=30.0, isolation_level=None)
            self._prepare()
            self._begin(json.dumps(identity), begun)
            self.identity, self.begun = self._read()
        except (sqlite3.Error, OSError, ValueError, KeyError, TypeError) as error:
            self.close()
            raise StoreError(
                f"{path}: not usable as a journal ({error}); expected a writable place or a "
                f"journal of this job: {ANEW}"
            ) from error

    def _prepare(self) -> None:
        """The tables, where they are not there yet."""
        self._db.execute("PRAGMA journal_mode=WAL")
        self._db.execute("PRAGMA synchronous=NORMAL")  # a power cut may cost the last chunks
        self._db.execute("CREATE TABLE IF NOT EXISTS about (name TEXT PRIMARY KEY, text TEXT)")
        self._db.execute(
            "CREATE TABLE IF NOT EXISTS chunks (i INTEGER PRIMARY KEY, sha256 TEXT, data BLOB)"
        )

    def _begin(self, identity: str, begun: str) -> None:
        """Say of a new journal what it is of."""
        self._db.execute("BEGIN IMMEDIATE")
        if not self._db.execute("SELECT 1 FROM about LIMIT 1").fetchall():
            about = {"identity": identity, "begun": begun}
            about["sha256"] = seal(identity.encode(), begun.encode())
            self._db.executemany("INSERT INTO about VALUES (?, ?)", about.items())
        self._db.execute("COMMIT")

    def _read(self) -> tuple[Identity, str]:
        """What the journal is of, and when it was begun."""
        if self._db.execute("PRAGMA quick_check(1)").fetchall() != [("ok",)]:
            raise ValueError("damaged")
        about = dict(self._db.execute("SELECT name, text FROM about").fetchall())
        identity, begun = about.get("identity"), about.get("begun")
        if not (isinstance(identity, str) and isinstance(begun, str)):
            raise ValueError("it does not say of what job")
        if about.get("sha256") != seal(identity.encode(), begun.encode()):
            raise ValueError("damaged, or of an earlier version")
        self._about = identity.encode()
        found: Identity = json.loads(identity)
        return found, begun

    def _seal(self, index: int, data: bytes) -> str:
        """The checksum of a row."""
        return seal(self._about, str(index).encode(), data)

    def indices(self) -> set[int]:
        """Which chunks are there and undamaged; damaged ones are dropped."""
        found = set()
        for index, digest, data in self._query("SELECT i, sha256, CAST(data AS BLOB) FROM chunks"):
            if isinstance(data, bytes) and self._seal(index, data) == digest:
                found.add(index)
            else:
                self.drop(index, "damaged")
        return found

    def drop(self, index: int, reason: str) -> None:
        """Forget a chunk, so that it is computed anew."""
        log.warning("%s: chunk %s is %s, it is computed anew", self.path, index, reason)
        self._query("DELETE FROM chunks WHERE i = ?", index)

    def is_empty(self) -> bool:
        """Whether there is no chunk at all."""
        return not self._query("SELECT 1 FROM chunks LIMIT 1")

    def get(self, index: int) -> Table:
        """One chunk."""
        rows = self._query("SELECT sha256, CAST(data AS BLOB) FROM chunks WHERE i = ?", index)
        for digest, data in rows:
            if isinstance(data, bytes) and self._seal(index, data) == digest:
                return unpack(data)
        raise StoreError(f"{self.path}: chunk {index} is damaged; the same call goes on from it")

    def put(self, index: int, table: Table) -> None:
        """Enter a chunk."""
        data = pack(table)
        self._query(
            "INSERT OR REPLACE INTO chunks VALUES (?, ?, ?)", index, self._seal(index, data), data
        )

    def _query(self, statement: str, *values: object) -> list[tuple]:  # type: ignore[type-arg]
        """All answers to a statement."""
        try:
            return self._db.execute(statement, values).fetchall()
        except (sqlite3.Error, OverflowError) as error:
            kept = "what was computed before is kept, the same call goes on from there"
            if any(word in str(error) for word in ("malformed", "not a database", "decode")):
                kept = ANEW
            raise StoreError(f"{self.path}: {error}; {kept}") from error

    def close(self) -> None:
        """Close the database."""
        if hasattr(self, "_db"):
            self._db.close()

    def remove(self) -> None:
        """Delete the journal, once its contents are in a result."""
        self.close()
        discard(self.path)


def reason(error: Exception) -> str:
    """Why a file cannot be opened."""
    return str(getattr(error, "strerror", None) or error)


class Lock:
    """Keeps a second process off a result that is being computed; it ends with the process.

    Parameters
    ----------
    path : Path
        Of what is locked.

    Raises
    ------
    InputError
        Where another process holds it.
    StoreError
        Where it cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path.with_name(f"{path.name}.lock")
        try:
            self.path.open("ab").close()  # says why not, where it cannot be opened
            self._db = sqlite3.connect(self.path, timeout=0.0, isolation_level=None)
            self._db.execute("BEGIN EXCLUSIVE")
        except (sqlite3.Error, OSError) as error:
            if hasattr(self, "_db"):
                self._db.close()
            if isinstance(error, sqlite3.Error) and "locked" in str(error):
                raise InputError(
                    f"{path}: another process is computing it; wait for it, or choose another place"
                ) from None
            raise StoreError(
                f"{self.path}: cannot be made ({reason(error)}); expected a writable "
                "place where no folder or other file of this name is: remove that"
            ) from error

    def release(self) -> None:
        """Let others at it."""
        self.path.unlink(missing_ok=True)
        self._db.close()
