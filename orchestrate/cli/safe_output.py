"""Standard streams of a command that may be closed, full or not read.

What is computed is stored, so nothing that happens to the output may end a run.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any


class SafeStream:
    """Text stream that never raises: errors of the stream below are kept, not raised."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self.error: Exception | None = None

    def write(self, text: str) -> int:
        """Write a text, or drop it if the stream has failed; return its length."""
        self._call_unless_failed("write", text)
        return len(text)

    def flush(self) -> None:
        self._call_unless_failed("flush")

    def _call_unless_failed(self, name: str, *arguments: object) -> None:
        if self.error is None:
            try:
                getattr(self._stream, name)(*arguments)
            except UnicodeEncodeError:  # a console's letters: "?" stands for those it lacks
                coding = self._stream.encoding
                known = [str(one).encode(coding, "replace").decode(coding) for one in arguments]
                self._call_unless_failed(name, *known)
            except (OSError, ValueError) as error:  # full, nobody reads, or closed
                self.error = error

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def flush_or_redirect(self) -> None:
        """Flush; if the stream has failed, redirect its descriptor to ``/dev/null``."""
        self.flush()
        if self.error is not None:
            with suppress(OSError, ValueError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, self._stream.fileno())
                os.close(nowhere)

    def failure_reason(self) -> str:
        """Return why output was lost; empty if none was, or the reader closed the pipe."""
        if self.error is None or isinstance(self.error, BrokenPipeError):
            return ""
        return str(getattr(self.error, "strerror", None) or self.error)


@contextmanager
def safe_outputs() -> Iterator[SafeStream]:
    """Replace stdout and stderr by ``SafeStream`` in a ``with`` block; yield that of stdout."""
    before = sys.stdout, sys.stderr
    nowhere = io.StringIO()  # in place of one that was closed
    streams = [SafeStream(stream or nowhere) for stream in before]
    sys.stdout, sys.stderr = streams  # type: ignore[assignment]
    try:
        yield streams[0]
    finally:
        for stream in streams:
            stream.flush_or_redirect()
        sys.stdout, sys.stderr = before
