"""Files that may come from anybody are read in a process of its own.

- It is an isolated Python (``-I``), which finds packages neither in the current folder nor next to
  the file, and imports what one format needs.
- Processor time and memory are limited by the size of the file, a deadline ends what hangs.
- What comes back are plain numbers and texts, not more than the memory that was allowed.
- All else (a crash, an exception of any library, too much of anything) is one line.
- A process that did not end reads the next file, unless a compiled reader was at work.
"""

from __future__ import annotations

import atexit
import json
import logging
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from .errors import InputError, first_line, printable_line

log = logging.getLogger(__name__)
SECONDS, BYTES_A_SECOND = 10.0, 1e6  # processor time: some, and more for a large file
WAITING = 3.0  # times the processor time: the deadline, of a processor that others use too
MEMORY, MEMORY_PER_BYTE = 1 << 30, 32  # bytes, and more for a large file
NUMBERS, NUMBERS_PER_BYTE = 1 << 26, 8  # bytes of a file's numbers: what is made of them takes more
START = """
import json, sys, types
root, paths, excluded = json.loads(sys.argv[1])
sys.path[:] = [one for one in dict.fromkeys([*sys.path, *paths]) if one not in excluded]
for name in ("orchestrate", "fmu_src"):
    sys.modules[name] = types.ModuleType(name)
    sys.modules[name].__path__ = [f"{root}/{name}"]
import numpy
numpy.f2py = sys.modules["numpy.f2py"] = types.ModuleType("numpy.f2py")
from orchestrate.reader_child import serve_requests
serve_requests()
"""  # SciPy imports all of NumPy, its compiler of Fortran too: 0.1 s

Reader = Callable[..., Any]


def max_reader_memory(file_size: int) -> int:
    """Return how many bytes of memory the reader of a file may use, by the file's size."""
    return MEMORY + MEMORY_PER_BYTE * file_size


def read_in_process(
    reader: Reader,
    path: Path,
    *arguments: object,
    expected: str,
    keep_process: bool = True,
    array_bytes: int | None = None,
) -> Any:
    """Return what a reader, a function of a module, returns for a path and plain arguments.

    Dataclasses come back as dicts. ``expected`` ends the line on a file that cannot be read;
    without ``keep_process`` the process is not used again. ``array_bytes`` is what arrays may take
    whatever the file's size, NUMBERS by default.
    """
    whole, size = path.absolute(), path.stat().st_size
    seconds = SECONDS + size / BYTES_A_SECOND
    request = {
        **{"reader": f"{reader.__module__}:{reader.__qualname__}", "path": str(whole)},
        **{"arguments": arguments, "seconds": seconds, "memory": max_reader_memory(size)},
        "room": (NUMBERS if array_bytes is None else array_bytes) + NUMBERS_PER_BYTE * size,
    }
    child = IDLE.pop(os.getpid(), None) if keep_process else None
    answer = child.ask(request) if child else {}
    if child is None or not (answer or child.timed_out()):  # it may suffer from files before
        child = start_reader_process(path, whole.parent)
        answer = child.ask(request)
    if not keep_process or not answer or IDLE.setdefault(os.getpid(), child) is not child:
        child.close()
    late = f"not read within {seconds:.3g} s"
    answer = answer or {"failed": late if child.timed_out() else "its reader broke down"}
    for note in answer.get("notes", ()):
        log.info("%s", printable_line(note.replace(str(whole), str(path))))
    if "value" in answer:
        return answer["value"]
    text = answer.get("refused") or f"{path}: {printable_line(answer['failed'], 200)}; {expected}"
    raise InputError(text.replace(str(whole), str(path)))


def start_reader_process(path: Path, folder: Path) -> ReaderProcess:
    try:
        return ReaderProcess(folder)
    except OSError as error:
        text = f"the process that reads files cannot be started ({first_line(error)})"
        raise InputError(f"{path}: {text}; expected room for a process") from None


class ReaderProcess:
    """A process that reads files, one after the other."""

    def __init__(self, folder: Path) -> None:
        """Start it; packages are found neither in the current folder nor in the given one."""
        excluded = {str(folder), str(folder.resolve()), str(Path.cwd())}
        paths = [one for one in sys.path if Path(one).is_absolute()]
        root = Path(__file__).parents[1]
        start = json.dumps([str(root), paths, [*excluded]])
        self.process = subprocess.Popen(
            [sys.executable, "-I", "-W", "ignore", "-c", START, start],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=root / "orchestrate",  # no library finds files next to the user's
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
        )
        self.is_late = False

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Return the answer to a request; an empty one where the process has ended without it."""
        timer = threading.Timer(WAITING * request["seconds"], self.mark_late_and_kill)
        timer.start()
        answer: dict[str, Any] = {}
        try:
            assert self.process.stdin is not None
            self.process.stdin.write(json.dumps(request).encode() + b"\n")
            self.process.stdin.flush()
            answer = self.receive(request["room"])
        except (OSError, EOFError, ValueError, KeyError, TypeError, MemoryError, RecursionError):
            pass  # it ended, or what it sent is no answer
        finally:
            timer.cancel()
            if not answer:
                self.close()
        return answer

    def receive(self, max_bytes: int) -> dict[str, Any]:
        length = int.from_bytes(self.read_exactly(8), "little")
        if length > max_bytes:
            raise ValueError
        answer: dict[str, Any] = json.loads(self.read_exactly(length))
        return {name: self.unpack_value(value, [max_bytes]) for name, value in answer.items()}

    def read_exactly(self, count: int) -> bytearray:
        """Read a number of bytes."""
        assert self.process.stdout is not None
        data = bytearray(count)
        if count and self.process.stdout.readinto(data) != count:  # type: ignore[attr-defined]
            raise EOFError
        return data

    def unpack_value(self, value: Any, room: list[int]) -> Any:
        if isinstance(value, list):
            return [self.unpack_value(one, room) for one in value]
        if not isinstance(value, dict):
            return value
        if "pairs" in value:
            return {name: self.unpack_value(one, room) for name, one in value["pairs"]}
        if "texts" in value:
            texts = value["texts"]
            reserve_bytes(room, 4 * len(texts) * max(map(len, texts), default=0))
            return np.array(texts, str).reshape(value["shape"])
        kind = np.dtype(value.get("array") or value["scalar"])
        if kind.kind not in "biufcSU":
            raise ValueError
        size = prod(value["shape"]) * kind.itemsize
        reserve_bytes(room, size)
        array = np.ndarray(value["shape"], kind, self.read_exactly(size))
        return array if "array" in value else array[()]

    def mark_late_and_kill(self) -> None:
        self.is_late = True
        self.process.kill()

    def timed_out(self) -> bool:
        """Return whether the deadline or the limit on the processor time ended the process."""
        worn_out = -getattr(signal, "SIGXCPU", 0)
        return self.is_late or bool(worn_out and self.process.returncode == worn_out)

    def close(self) -> None:
        self.process.kill()
        for stream in (self.process.stdin, self.process.stdout):
            with suppress(OSError):
                stream and stream.close()  # type: ignore[func-returns-value]
        self.process.wait()


def reserve_bytes(room: list[int], size: int) -> None:
    """Take bytes of the room that is left; raise if there is less."""
    room[0] -= size
    if size < 0 or room[0] < 0:
        raise ValueError


IDLE: dict[int, ReaderProcess] = {}  # by process id: a fork must not ask its parent's


def close_idle_process() -> None:
    if child := IDLE.pop(os.getpid(), None):
        child.close()


atexit.register(close_idle_process)
