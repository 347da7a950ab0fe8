"""Standard streams and signals of a command: lost output and SIGTERM end it in order.

What is computed is stored, so nothing that happens to the output may end a run.
"""

from __future__ import annotations

import functools
import io
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

from ..supervisor import confirm_signal, open_missing_streams

GRACE = 15.0  # s that a process has for ending on its own
_ending = False  # whether a signal was heard


class Terminated(KeyboardInterrupt):
    """``KeyboardInterrupt`` for SIGTERM, to tell it from Ctrl-C."""


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
        """Flush the stream; do nothing if it has failed."""
        self._call_unless_failed("flush")

    def _call_unless_failed(self, name: str, *arguments: object) -> None:
        """Call a method of the stream below unless it has failed; keep its error."""
        if self.error is None:
            try:
                getattr(self._stream, name)(*arguments)
            except (OSError, ValueError) as error:  # full, nobody reads, or closed
                self.error = error

    def __getattr__(self, name: str) -> Any:
        """Return all other attributes of the wrapped stream."""
        return getattr(self._stream, name)

    def detach(self) -> None:
        """Flush; if the stream has failed, redirect its descriptor to ``/dev/null``."""
        self.flush()
        if self.error is not None:
            with suppress(OSError, ValueError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, self._stream.fileno())
                os.close(nowhere)

    def failure(self) -> str:
        """Return why output was lost; empty if none was, or the reader closed the pipe."""
        if self.error is None or isinstance(self.error, BrokenPipeError):
            return ""
        return str(getattr(self.error, "strerror", None) or self.error)


@contextmanager
def safe_outputs() -> Iterator[SafeStream]:
    """Replace stdout and stderr by ``SafeStream`` in a ``with`` block; yield that of stdout."""
    open_missing_streams()
    before = sys.stdout, sys.stderr
    nowhere = io.StringIO()  # in place of one that was closed
    streams = [SafeStream(stream or nowhere) for stream in before]
    sys.stdout, sys.stderr = streams  # type: ignore[assignment]
    try:
        yield streams[0]
    finally:
        for stream in streams:
            stream.detach()
        sys.stdout, sys.stderr = before


@contextmanager
def handled_signals() -> Iterator[None]:
    """Turn SIGINT and SIGTERM into exceptions in a ``with`` block; exit if ending hangs."""
    usual: dict[int, Any] = {
        signal.SIGINT: signal.default_int_handler,
        signal.SIGTERM: signal.SIG_DFL,
    }
    global _ending
    _ending = False
    ours = threading.current_thread() is threading.main_thread()
    handled = [
        number
        for number, usual_handler in usual.items()
        if ours and signal.getsignal(number) == usual_handler
    ]
    for number in handled:
        signal.signal(number, raise_for_signal)
    before = sys.unraisablehook
    sys.unraisablehook = functools.partial(resend_signal, before)
    try:
        yield
    finally:
        sys.unraisablehook = before
        for number in handled:
            signal.signal(number, usual[number])


def resend_signal(otherwise: Callable[[Any], object], lost: sys.UnraisableHookArgs) -> None:
    """Send a signal again whose exception Python dropped in a callback (an unraisable hook)."""
    global _ending
    if issubclass(lost.exc_type, KeyboardInterrupt):
        _ending = False
        number = signal.SIGTERM if issubclass(lost.exc_type, Terminated) else signal.SIGINT
        threading.Timer(0.05, os.kill, (os.getpid(), number)).start()
    else:
        otherwise(lost)


def raise_for_signal(number: int, _: FrameType | None) -> None:
    """Handle a signal: raise ``KeyboardInterrupt``; at a second signal exit at once."""
    global _ending
    if _ending:
        os._exit(128 + number)
    _ending = True
    confirm_signal()
    threading.Thread(target=exit_after_grace, args=(number,), daemon=True).start()
    raise Terminated if number == signal.SIGTERM else KeyboardInterrupt


def exit_after_grace(number: int) -> None:
    """Sleep for ``GRACE`` seconds, then exit the process with 128 + the signal's number."""
    time.sleep(GRACE)
    os._exit(128 + number)
