"""What a command's process is in: an output that nobody reads or takes, signals that end it.

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
    """Somebody asked the process to end, not by Ctrl-C."""


class Unfailing:
    """A text stream that takes everything, also where the one below does not any more.

    Attributes
    ----------
    error : Exception or None
        Why the stream below failed.
    """

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self.error: Exception | None = None

    def write(self, text: str) -> int:
        """Write, or drop."""
        self._try("write", text)
        return len(text)

    def flush(self) -> None:
        """Write what waits, or drop it."""
        self._try("flush")

    def _try(self, name: str, *arguments: object) -> None:
        if self.error is None:
            try:
                getattr(self._stream, name)(*arguments)
            except (OSError, ValueError) as error:  # full, nobody reads, or closed
                self.error = error

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def let_go(self) -> None:
        """Write what waits; where that fails, what is left must not fail once more at the end."""
        self.flush()
        if self.error is not None:
            with suppress(OSError, ValueError):
                nowhere = os.open(os.devnull, os.O_WRONLY)
                os.dup2(nowhere, self._stream.fileno())
                os.close(nowhere)

    def complaint(self) -> str:
        """Why what was told is lost; an empty string where it is not, or nobody wanted to read."""
        if self.error is None or isinstance(self.error, BrokenPipeError):
            return ""
        return str(getattr(self.error, "strerror", None) or self.error)


@contextmanager
def outputs() -> Iterator[Unfailing]:
    """Standard output and error output that cannot end a run; gives the first."""
    fill_descriptors()
    before = sys.stdout, sys.stderr
    nowhere = io.StringIO()  # in place of one that was closed
    streams = [Unfailing(stream or nowhere) for stream in before]
    sys.stdout, sys.stderr = streams  # type: ignore[assignment]
    try:
        yield streams[0]
    finally:
        for stream in streams:
            stream.let_go()
        sys.stdout, sys.stderr = before


@contextmanager
def signals() -> Iterator[None]:
    """SIGTERM ends the process as Ctrl-C does; one that hangs on its way out is ended anyway."""
    usual: dict[int, Any] = {
        signal.SIGINT: signal.default_int_handler,
        signal.SIGTERM: signal.SIG_DFL,
    }
    global _ending
    _ending = False
    ours = threading.current_thread() is threading.main_thread()
    taken = [
        number for number, given in usual.items() if ours and signal.getsignal(number) == given
    ]
    for number in taken:
        signal.signal(number, end_soon)
    before = sys.unraisablehook
    sys.unraisablehook = functools.partial(send_again, before)
    try:
        yield
    finally:
        sys.unraisablehook = before
        for number in taken:
            signal.signal(number, usual[number])


def send_again(otherwise: Callable[[Any], object], lost: sys.UnraisableHookArgs) -> None:
    """A signal that came in a callback, where Python drops its exception, comes once more.

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
    """End by an exception, and see that it does; at once where it comes once more."""
    global _ending
    if _ending:
        os._exit(128 + number)
    _ending = True
    heeded()
    threading.Thread(target=end_anyway, args=(number,), daemon=True).start()
    raise Terminated if number == signal.SIGTERM else KeyboardInterrupt


def end_anyway(number: int) -> None:
    """End without a word; workers end with the process they work for."""
    time.sleep(GRACE)
    os._exit(128 + number)
