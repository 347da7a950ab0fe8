"""Run a command in a child process; the parent passes on signals and reports crashes.

An FMU and a library may hang, spin, abort or call ``exit``, and Python hears no signal then. So the
command runs in a child; this process waits, hands signals on, and ends the child where it does not
end by itself: at a second signal, or some seconds after the first one.
"""

from __future__ import annotations

import contextlib
import os
import select
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

FAILURE = 1
HEARD = 0.3  # s in which a signal that went to all processes has reached the child too
DEAF = 5.0  # s after which a child that has not heard a signal is ended
GRACE = 20.0  # s that one that has heard it has for ending
POLL = 0.25  # s
DYING = 3.0  # s that workers, once killed, may take to end on a busy machine
KEPT = "what was stored before is kept"
UNPACKED = "vibroimpact-fmu-"  # temporary folders begin so (`temporary`), then comes the process
TOLD, HEEDED = b"D", b"S"  # what the child says: it has done its work; it has heard a signal
PR_SET_PDEATHSIG = 1  # of Linux

_child: int | None = None  # in the child: where it says so


def run_supervised(work: Callable[[], int]) -> int:
    """Fork, run ``work()`` in the child, wait for it; return its exit code, report a crash.

    Where there is no fork, and where there is no room for another process, it is computed here.
    """
    pipes: list[int] = []
    parent = os.getpid()
    try:
        open_missing_streams()
        pipes += os.pipe()
        pipes += os.pipe()
        child = os.fork()
    except (AttributeError, OSError):  # a system without fork, or no room for more
        for number in pipes:
            os.close(number)
        return work()
    reader, writer, wake_reader, wake_writer = pipes
    if child == 0:
        for number in (reader, wake_reader, wake_writer):
            os.close(number)
        return run_in_child(work, writer, parent)
    os.close(writer)
    return Supervisor(child, reader).run(wake_reader, wake_writer)


def run_in_child(work: Callable[[], int], writer: int, parent: int) -> int:
    """Run ``work()`` in the forked child; tell the parent at the end; return the exit code."""
    global _child
    _child = writer
    die_with_parent(parent)
    try:
        return work()
    finally:
        send_to_parent(TOLD)


def confirm_signal() -> None:
    """Tell the supervising parent that this child has got its signal and is ending."""
    send_to_parent(HEEDED)


def send_to_parent(word: bytes) -> None:
    """Write a byte message to the supervising parent's pipe, if there is one."""
    if _child is not None:
        with contextlib.suppress(OSError):
            os.write(_child, word)


def open_missing_streams() -> None:
    """Open closed ones of the standard streams (descriptors 0 to 2) on ``/dev/null``."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)
    os.close(number)


def die_with_parent(parent: int) -> None:
    """Make this process end itself as soon as its parent process has ended."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(FAILURE)
        return

    def watch() -> None:
        """Wait until the parent process has changed, then exit."""
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(FAILURE)

    threading.Thread(target=watch, daemon=True).start()


class Supervisor:
    """Parent's side of a child process: waits, passes signals on, returns the exit code."""

    def __init__(self, child: int, reader: int) -> None:
        self.child, self.reader = child, reader
        self.words = b""
        self.signals: list[tuple[int, float]] = []  # number and time
        self.handed_on = self.forced = False
        self.interrupted: list[int] = []  # processes that a signal has found at work

    def run(self, wake_reader: int, wake_writer: int) -> int:
        """Wait for the child, passing signals on through a pipe; return its exit code."""
        os.set_blocking(wake_writer, False)
        signal.set_wakeup_fd(wake_writer, warn_on_full_buffer=False)
        for heard, usual in (
            (signal.SIGINT, signal.default_int_handler),
            (signal.SIGTERM, signal.SIG_DFL),
        ):
            if signal.getsignal(heard) == usual:  # not ignored, as behind nohup
                signal.signal(heard, self.note_signal)
        listened = [self.reader, wake_reader]
        while (status := self.poll_status()) is None:
            for number in select.select(listened, [], [], POLL)[0]:
                message = os.read(number, 64)
                if number == self.reader:
                    self.words += message
                    if not message:
                        listened.remove(number)
            self.handle_signals()
        with contextlib.suppress(BlockingIOError):  # what it said at last
            os.set_blocking(self.reader, False)
            self.words += os.read(self.reader, 64)
        return self.exit_code(status)

    def note_signal(self, number: int, _: object) -> None:
        """Handle a signal: append its number and time of arrival for the waiting loop."""
        self.signals.append((number, time.monotonic()))

    def poll_status(self) -> int | None:
        """Return the child's raw wait status if it has ended, or None while it runs."""
        pid, status = os.waitpid(self.child, os.WNOHANG)
        return status if pid else None

    def handle_signals(self) -> None:
        """Send a received signal on to a child that has not got it; kill one that is late."""
        if not self.signals:
            return
        asked, first = self.signals[0]
        self.interrupted = self.interrupted or [self.child, *descendants(self.child)]
        waited, heard = time.monotonic() - first, HEEDED in self.words
        if waited > HEARD and not heard and not self.handed_on:
            self.handed_on = True
            os.kill(self.child, asked)
        again = any(when - first > HEARD for _, when in self.signals)
        if again or waited > (GRACE if heard else DEAF):
            self.kill_all()

    def kill_all(self) -> None:
        """Kill the child and all its descendant processes with SIGKILL, and set ``forced``."""
        pids = [self.child, *descendants(self.child)]
        for pid in pids:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        self.forced = True

    def exit_code(self, status: int) -> int:
        """Return the exit code for a wait status; print why, unless the child ended by itself."""
        code = os.waitstatus_to_exitcode(status)
        remove_unpacked_of_ended(self.interrupted)
        if TOLD in self.words and code >= 0:
            return code
        remove_unpacked(self.child)
        if self.signals:
            asked = self.signals[0][0]
            word = "terminated" if asked == signal.SIGTERM else "interrupted"
            why = "; what ran did not answer and was ended by force" if self.forced else ""
            print_line(f"{word}{why}; {KEPT}")
            return 128 + asked
        if code < 0:
            name = signal.Signals(-code).name
            why = (
                "by somebody, or for want of memory"
                if -code == signal.SIGKILL
                else ("an FMU or a library has crashed")
            )
            print_line(f"error: the command was ended by {name}: {why}; {KEPT}")
        else:
            ended = f"an FMU or a library has ended the command, with exit code {code}"
            print_line(f"error: {ended}; expected an answer; {KEPT}")
        return FAILURE


def print_line(line: str) -> None:
    """Print a line on standard error, below the line of a progress bar that may stand there."""
    with contextlib.suppress(OSError):
        os.write(2, f"\n{line}\n".encode())


def descendants(pid: int) -> Iterator[int]:
    """Yield the process ids of all descendants of a process (Linux only, else none)."""
    for path in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            for child in map(int, path.read_text().split()):
                yield child
                yield from descendants(child)


def unpacked_folders(pid: int) -> list[Path]:
    """Return the temporary folders of unpacked FMUs that a process has made."""
    return list(Path(tempfile.gettempdir()).glob(f"{UNPACKED}{pid}-*"))


def remove_unpacked(pid: int) -> None:
    """Delete the temporary folders of unpacked FMUs that a process has left behind."""
    for folder in unpacked_folders(pid):
        shutil.rmtree(folder, ignore_errors=True)


def remove_unpacked_of_ended(pids: list[int]) -> None:
    """Delete what interrupted processes have left behind; wait some seconds for late ones to end.

    A killed worker may still be ending when the command itself has looked for leftovers.
    """
    end = time.monotonic() + DYING
    for pid in pids:  # those of `descendants`, which has none where there is no /proc
        while unpacked_folders(pid) and is_running(pid) and time.monotonic() < end:
            time.sleep(0.01)
        if not is_running(pid):
            remove_unpacked(pid)


def is_running(pid: int) -> bool:
    """Return whether a process runs still: one that has ended may wait for its parent to see it."""
    try:
        state = Path(f"/proc/{pid}/stat").read_bytes().rpartition(b")")[2].split()[:1]
    except OSError:
        return False
    return state not in ([b"Z"], [b"X"])
