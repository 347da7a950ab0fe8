"""Surroundings of a command's process: outputs that may fail, signals that end it.

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

from ..supervisor import fill_descriptors, heeded

GRACE = 15.0  # s that a process has for ending on its own
_ending = False  # whether a signal was heard


class Terminated(KeyboardInterrupt):
    """Raised when somebody asked the process to end, not by Ctrl-C."""


class SafeStream:
    """Text stream that accepts everything, also when the stream below fails.

    Attributes
    ----------
    error : Exception or None
        Why the stream below failed.
    """

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self.error: Exception | None = None

    def write(self, text: str) -> int:
        """Write a text, or drop it where the reader is gone; return its length."""
        self._try("write", text)
        return len(text)

    def flush(self) -> None:
        """Flush the stream, or drop what waits."""
        self._try("flush")

    def _try(self, name: str, *arguments: object) -> None:
        if self.error is None:
            try:
                getattr(self._stream, name)(*arguments)
            except (OSError, ValueError) as error:  # full, nobody reads, or closed
                self.error = error

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def detach(self) -> None:
        """Flush; redirect the stream if that fails, so that it does not fail again at the end."""
        self.flush()
        if self.error is not None:
            with suppress(OSError, ValueError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, self._stream.fileno())
                os.close(nowhere)

    def failure(self) -> str:
        """Return why output is lost; an empty string if none is, or nobody wanted to read."""
        if self.error is None or isinstance(self.error, BrokenPipeError):
            return ""
        return str(getattr(self.error, "strerror", None) or self.error)


@contextmanager
def outputs() -> Iterator[SafeStream]:
    """Replace standard output and error output by ones that cannot end a run; yield the first."""
    fill_descriptors()
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
def signals() -> Iterator[None]:
    """Handle SIGTERM like Ctrl-C; end a process that hangs on its way out."""
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
        signal.signal(number, end_soon)
    before = sys.unraisablehook
    sys.unraisablehook = functools.partial(send_again, before)
    try:
        yield
    finally:
        sys.unraisablehook = before
        for number in handled:
            signal.signal(number, usual[number])


def send_again(otherwise: Callable[[Any], object], lost: sys.UnraisableHookArgs) -> None:
    """Send a signal again that came in a callback, where Python drops its exception.

    Parameters
    ----------
    otherwise : callable
        The hook for all other exceptions.
    lost : sys.UnraisableHookArgs
    """
    global _ending
    if issubclass(lost.exc_type, KeyboardInterrupt):
        _ending = False
        number = signal.SIGTERM if issubclass(lost.exc_type, Terminated) else signal.SIGINT
        threading.Timer(0.05, os.kill, (os.getpid(), number)).start()
    else:
        otherwise(lost)


def end_soon(number: int, _: FrameType | None) -> None:
    """Raise an exception that ends the program soon; exit at once at a second signal."""
    global _ending
    if _ending:
        os._exit(128 + number)
    _ending = True
    heeded()
    threading.Thread(target=end_anyway, args=(number,), daemon=True).start()
    raise Terminated if number == signal.SIGTERM else KeyboardInterrupt


def end_anyway(number: int) -> None:
    """Wait for a while, then exit without a message; workers end with this process."""
    time.sleep(GRACE)
    os._exit(128 + number)
