"""Faults to inject: damaged files, rows somebody changed, hostile surroundings of a command.

Each takes its randomness from outside, so that a campaign is repeated by its seed.
"""

import hashlib
import os
import random
import resource
import sqlite3
import subprocess
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from orchestrate.running.journal import table_from_bytes, table_to_bytes

Damage = Callable[[Path, random.Random], None]

# -- files ----------------------------------------------------------------------------------------


def flip_a_bit(path: Path, draw: random.Random) -> None:
    data = bytearray(path.read_bytes())
    data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    path.write_bytes(data)


def truncate(path: Path, draw: random.Random) -> None:
    os.truncate(path, draw.randrange(path.stat().st_size))


def zero_a_block(path: Path, draw: random.Random) -> None:
    """A block of the disk is lost."""
    size = path.stat().st_size
    begin = draw.randrange(size) // 512 * 512
    with path.open("r+b") as file:
        file.seek(begin)
        file.write(bytes(min(512, size - begin)))


def fill_with_noise(path: Path, draw: random.Random) -> None:
    """Another file of the same length in its place."""
    path.write_bytes(draw.randbytes(path.stat().st_size))


FILE_DAMAGE: Mapping[str, Damage] = {
    "a flipped bit": flip_a_bit,
    "truncated": truncate,
    "a lost block": zero_a_block,
    "noise": fill_with_noise,
}

# -- rows of a journal, each with a checksum that fits its content ---------------------------------


def rows(path: Path) -> list[tuple[int, bytes]]:
    with closing(sqlite3.connect(path)) as database:
        return list(database.execute("SELECT i, CAST(data AS BLOB) FROM chunks ORDER BY i"))


def put_row(path: Path, index: int, data: bytes) -> None:
    """A chunk with the checksum of its content, as who knows no more would put it there."""
    digest = hashlib.sha256(data).hexdigest()
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("INSERT OR REPLACE INTO chunks VALUES (?, ?, ?)", (index, digest, data))


def a_shorter_row(path: Path, draw: random.Random) -> None:
    change_row(path, draw, lambda array: array[:-1])


def change_row(path: Path, draw: random.Random, change: Callable[[np.ndarray], np.ndarray]) -> None:
    index, data = draw.choice(rows(path))
    table = {name: change(array) for name, array in table_from_bytes(data).items()}
    put_row(path, index, table_to_bytes(table))


def too_many_rows(path: Path, draw: random.Random) -> None:
    """Rows that the job does not have."""
    for index in (draw.randrange(1000, 2000), -1, 2**62):
        put_row(path, index, draw.choice(rows(path))[1])


def a_moved_row(path: Path, draw: random.Random) -> None:
    (one, _), (other, _) = draw.sample(rows(path), 2)
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        for old, new in ((one, -7), (other, one), (-7, other)):
            database.execute("UPDATE chunks SET i = ? WHERE i = ?", (new, old))


def another_identity(path: Path, draw: random.Random) -> None:
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        text = draw.choice(["", "[]", "null", "{}", "{", '{"question": 1}'])
        database.execute("UPDATE about SET text = ? WHERE name = 'identity'", (text,))


ROW_DAMAGE: Mapping[str, Damage] = {
    "rows of NaN": lambda path, draw: change_row(path, draw, lambda array: array * np.nan),
    "a shorter row": a_shorter_row,
    "an empty row": lambda path, draw: put_row(path, draw.choice(rows(path))[0], b""),
    "too many rows": too_many_rows,
    "a moved row": a_moved_row,
    "another identity": another_identity,
}

# -- surroundings ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Surroundings:
    """What a command finds itself in.

    Attributes
    ----------
    stdout, stderr : str
        ``pipe``, ``closed``, or a path such as ``/dev/full``.
    open_files, memory : int
        Limits of the process; bytes of address space. 0: as they are.
    """

    stdout: str = "pipe"
    stderr: str = "pipe"
    open_files: int = 0
    memory: int = 0

    def shell(self, command: Sequence[str | Path]) -> list[str]:
        ends = {"pipe": "", "closed": "&-"}
        text = 'exec "$@"'
        for number, where in ((1, self.stdout), (2, self.stderr)):
            end = ends.get(where, where)
            text += f" {number}>{end}" if end else ""
        return ["sh", "-c", text, "sh", *map(str, command)]

    def limit(self) -> None:
        if self.open_files:
            resource.setrlimit(resource.RLIMIT_NOFILE, (self.open_files, self.open_files))
        if self.memory:
            resource.setrlimit(resource.RLIMIT_AS, (self.memory, self.memory))

    def run(
        self, command: Sequence[str | Path], folder: Path, seconds: float = 120.0, **more: str
    ) -> subprocess.CompletedProcess[str]:
        """Run a command to its end; ``more`` is for its environment."""
        where: Any = {"cwd": folder, "env": {**os.environ, **more}, "preexec_fn": self.limit}
        pipes: Any = {"capture_output": True, "text": True, "timeout": seconds}
        return subprocess.run(self.shell(command), **where, **pipes)
