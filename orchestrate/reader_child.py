"""The process in which files from anybody are read, as :mod:`.reader_process` starts it.

A request is a line of JSON. An answer is the length of a text of JSON in eight bytes, that text,
and the arrays that it describes, byte by byte. Nothing else comes out: the standard streams lead
nowhere.
"""

from __future__ import annotations

import json
import logging
import os
import signal
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from importlib import import_module
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError, first_line

MOST_NOTES = 100  # lines of the log that are passed on
PAGES = Path("/proc/self/statm")  # of the address space in use; only Linux limits it

Arrays = list[NDArray[Any]]


def serve_requests() -> None:
    """Answer one request after the other, until the parent process closes the pipe."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's, which ends this process
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in range(3):  # what libraries print
        os.dup2(nowhere, number)
    for line in requests:
        header, arrays = run_reader(json.loads(line))
        text = json.dumps(header).encode()
        answers.write(len(text).to_bytes(8, "little") + text)
        for array in (one for one in arrays if one.nbytes):
            answers.write(array.view(np.uint8).data)
        answers.flush()


def run_reader(request: dict[str, Any]) -> tuple[dict[str, Any], Arrays]:
    """Run a reader; return what it returned or why it failed, and the arrays of that."""
    log = LogCollector()
    arrays: Arrays = []
    try:
        module, _, name = request["reader"].partition(":")
        reader: Callable[..., Any] = getattr(import_module(module), name)
        set_limits(request["seconds"], request["memory"])
        value = pack_for_json(reader(Path(request["path"]), *request["arguments"]), arrays)
        size, room = sum(array.nbytes for array in arrays), request["room"]
        if size > room:
            text = f"its numbers take {size} bytes, from a file of its size expected at most {room}"
            return {"failed": text}, []
        return {"value": value, "notes": log.lines}, arrays
    except InputError as error:
        return {"refused": str(error)}, []
    except MemoryError as error:
        return {"failed": str(error) or "more memory than a file of its size needs"}, []
    except BaseException as error:  # what damaged files raise in libraries is stated nowhere
        return {"failed": first_line(error)}, []
    finally:
        log.close()


class LogCollector(logging.Handler):
    """Collect what our own readers log: the parent process logs it again."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.lines: list[str] = []
        self.logger = logging.getLogger(__package__)
        self.logger.setLevel(logging.INFO)
        self.logger.propagate = False
        self.logger.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a line, one of the first."""
        if len(self.lines) < MOST_NOTES:
            self.lines.append(record.getMessage())

    def close(self) -> None:
        self.logger.removeHandler(self)
        super().close()


def set_limits(seconds: float, memory: int) -> None:
    """Limit what this process may use from now on: processor time and bytes of memory."""
    try:
        import resource
    except ImportError:  # Windows: there is only the parent's deadline
        return

    def limit(kind: int, value: int) -> None:
        hard = resource.getrlimit(kind)[1]
        limited = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(kind, (limited, hard))

    limit(resource.RLIMIT_CORE, 0)
    limit(resource.RLIMIT_CPU, ceil(sum(os.times()[:2]) + seconds))
    if PAGES.exists():
        pages = int(PAGES.read_text().split()[0])
        limit(resource.RLIMIT_AS, pages * resource.getpagesize() + memory)


def pack_for_json(value: Any, arrays: Arrays) -> Any:
    """Return a value as plain data for JSON; its arrays are appended to ``arrays``."""
    if isinstance(value, np.ndarray) and value.dtype.kind == "O":
        return {"texts": [str(one) for one in value.ravel()], "shape": value.shape}
    if isinstance(value, (np.ndarray, np.generic)):
        array = np.asarray(value)
        if array.dtype.kind not in "biufcSU":
            raise ValueError(f"numbers of the type {array.dtype}")
        arrays.append(np.ascontiguousarray(array).reshape(-1))
        kind = "array" if isinstance(value, np.ndarray) else "scalar"
        return {kind: array.dtype.str, "shape": array.shape}
    if is_dataclass(value):
        value = {one.name: getattr(value, one.name) for one in fields(value)}
    if isinstance(value, dict):
        return {"pairs": [[str(key), pack_for_json(one, arrays)] for key, one in value.items()]}
    if isinstance(value, (list, tuple)):
        return [pack_for_json(one, arrays) for one in value]
    if value is None or isinstance(value, (str, int, float)):
        return value
    raise ValueError(f"data of the type {type(value).__name__}")
