"""Results on disk: a journal while a run is under way, a NetCDF file when it is complete.

The journal is an SQLite database, one row an eta, one transaction a row: a process killed at any moment loses the row it was computing, a
full disk the row it was writing. The NetCDF file appears whole or not at all.
"""

import json
import shutil
import sqlite3
from pathlib import Path

import numpy as np

from . import __version__
from .errors import UserError


class Journal:
    """Rows of floats that belong to one run.

    Parameters
    ----------
    path : Path
    identity : dict
        What decides the numbers; a journal of another identity is refused.
    """

    def __init__(self, path, identity):
        self.path = Path(path)
        text = json.dumps(identity, sort_keys=True)
        try:
            self._db = sqlite3.connect(self.path, timeout=30.0, isolation_level=None)
            self._db.execute("PRAGMA journal_mode=WAL")
            self._db.execute("PRAGMA synchronous=NORMAL")  # a killed process loses nothing written, a power cut perhaps the last rows
            self._db.execute("CREATE TABLE IF NOT EXISTS identity (text TEXT)")
            self._db.execute("CREATE TABLE IF NOT EXISTS rows (i INTEGER PRIMARY KEY, data BLOB)")
            self._db.execute("INSERT INTO identity SELECT ? WHERE NOT EXISTS (SELECT * FROM identity)", (text,))
            found = self._db.execute("SELECT text FROM identity").fetchone()[0]
        except sqlite3.Error as error:
            raise UserError(f"{self.path}: not usable as a journal ({error}); allowed is a writable place, or a journal of this run") from None
        if found != text:
            self.close()
            found = identity_of(found, self.path)
            raise UserError(f"{self.path}: the journal of another run ({difference(found, identity)}); remove it or choose another --output")

    @staticmethod
    def normal(identity):
        """An identity as it comes back from disk."""
        return json.loads(json.dumps(identity))

    def close(self):
        """Close the database."""
        self._db.close()

    def _query(self, statement, *values):
        """All answers to a question."""
        try:
            return self._db.execute(statement, values).fetchall()
        except sqlite3.Error as error:
            raise UserError(f"{self.path}: damaged ({error}); remove it to begin anew") from None

    def length(self):
        """Number of rows; they are entered in order, so this is the next index."""
        return self._query("SELECT COUNT(*) FROM rows")[0][0]

    def row(self, index):
        """One row, as an ndarray of floats."""
        return self._numbers(self._query("SELECT data FROM rows WHERE i = ?", index)[0][0])

    def rows(self):
        """All rows, shape (length, row length)."""
        return np.array([self._numbers(data) for (data,) in self._query("SELECT data FROM rows ORDER BY i")])

    def _numbers(self, data):
        """A row's floats."""
        if not isinstance(data, bytes) or len(data) % 8 or not data:
            raise UserError(f"{self.path}: damaged (a row of {len(data)} bytes); remove it to begin anew")
        return np.frombuffer(data)

    def append(self, index, row):
        """Enter a row."""
        try:
            self._db.execute("INSERT INTO rows VALUES (?, ?)", (index, np.asarray(row, dtype=float).tobytes()))
        except sqlite3.Error as error:
            raise UserError(
                f"{self.path}: cannot be written ({error}); what was computed before is kept, the same command goes on from there"
            ) from None

    def remove(self):
        """Delete the journal, once its contents are in a result file."""
        self.close()
        self.discard(self.path)

    @staticmethod
    def discard(path):
        """Delete a journal's files."""
        for suffix in ("", "-wal", "-shm"):
            Path(f"{path}{suffix}").unlink(missing_ok=True)


class Lock:
    """Keeps a second command off a run that is under way; released when the process ends, however it ends."""

    def __init__(self, path):
        self.path = Path(f"{path}.lock")
        self._db = sqlite3.connect(self.path, timeout=0.0, isolation_level=None)
        try:
            self._db.execute("BEGIN EXCLUSIVE")
        except sqlite3.Error:
            self._db.close()
            raise UserError(f"{path}: another process is computing this run; wait for it, or choose another --output") from None

    def release(self):
        """Let others at it."""
        self._db.close()
        self.path.unlink(missing_ok=True)


def identity_of(text, path):
    """An identity from disk."""
    try:
        return json.loads(text)
    except ValueError:
        raise UserError(f"{path}: damaged (it does not say which run it belongs to); remove it to begin anew") from None


def difference(found, wanted):
    """Where two identities differ, for a message."""
    found, wanted = Journal.normal(found), Journal.normal(wanted)
    for key in sorted(set(found) | set(wanted)):
        a, b = found.get(key), wanted.get(key)
        if a != b:
            if isinstance(a, dict) and isinstance(b, dict):
                return difference(a, b)
            return f"{key} = {shorten(a)} there, {shorten(b)} here"
    return "no difference"


def shorten(value):
    """A value for a message: long lists by their ends."""
    if isinstance(value, (list, tuple)) and len(value) > 4:
        return f"[{value[0]}, {value[1]}, ... {value[-1]}] ({len(value)} values)"
    return json.dumps(value)


def read_identity(path):
    """Identity of a complete result file.

    Raises
    ------
    UserError
        Where the file is not a result of this project.
    """
    import xarray

    try:
        with xarray.open_dataset(path, engine="netcdf4") as dataset:
            return json.loads(dataset.attrs["identity"])
    except Exception:
        raise UserError(f"{path}: not a result of this project; allowed is a path that is free, or holds one") from None


def write_netcdf(dataset, path, identity):
    """Write a result file, whole or not at all.

    Parameters
    ----------
    dataset : xarray.Dataset
    path : Path
    identity : dict
    """
    path = Path(path)
    dataset.attrs.update(Conventions="CF-1.10", source=f"vibroimpact {__version__}", identity=json.dumps(identity, sort_keys=True))
    temporary = path.with_name(path.name + ".tmp")
    compression = {name: {"zlib": True, "complevel": 4} for name, variable in dataset.data_vars.items() if variable.size > 10000}
    try:
        dataset.to_netcdf(temporary, engine="netcdf4", encoding=compression)
        temporary.replace(path)
    except (OSError, RuntimeError) as error:
        free = shutil.disk_usage(path.parent).free
        cause = f"{error}, {free} bytes free on the disk"
        raise UserError(f"{path}: cannot be written ({cause}); what was computed is kept, the same command goes on from there") from None
    finally:
        temporary.unlink(missing_ok=True)


def write_whole(path, content):
    """Write bytes into a file, whole or not at all."""
    temporary = Path(path).with_name(Path(path).name + ".tmp")
    try:
        temporary.write_bytes(content)
        temporary.replace(path)
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror or error}); the same command goes on from there") from None
    finally:
        temporary.unlink(missing_ok=True)
