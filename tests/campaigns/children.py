"""Run commands in forked children, which need no imports: a thousand take minutes."""

from __future__ import annotations

import atexit
import contextlib
import io
import os
import re
import resource
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

MEMORY = 2 << 30  # bytes that a command may ask for
PATIENCE = 60.0  # s


@dataclass(frozen=True)
class FinishedCommand:
    """Result of a command that has ended: exit code, output, error output, seconds."""

    code: int  # its exit code; minus the signal's number where one ended it
    out: str
    err: str
    seconds: float  # from its start

    @property
    def lines(self) -> list[str]:
        """Lines of the error output, without empty ones and progress bars."""
        parts = (part.strip() for part in re.split(r"[\r\n]+", self.err))
        return [part for part in parts if part and not re.search(r"\d+%\|", part)]


class ChildCommand:
    """A command that runs in a forked child."""

    def __init__(
        self,
        arguments: list[str],
        folder: Path,
        prepare: Callable[[], object] | None = None,
    ) -> None:
        """Start the command in a child process."""
        folder.mkdir(parents=True, exist_ok=True)
        self.begun = time.monotonic()
        self.files = [folder / f"{os.getpid()}-{time.monotonic_ns()}.{end}" for end in "oe"]
        sys.stdout.flush()
        self.pid = os.fork()
        if self.pid == 0:
            run_child(arguments, self.files, folder, prepare)
        self.finished: FinishedCommand | None = None

    def is_running(self) -> bool:
        """Return whether the command still runs."""
        if self.finished is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self._read_result(status)
        return self.finished is None

    def send_signal(self, number: int) -> None:
        """Send a signal to the child and to all processes that it has started."""
        if self.is_running():
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.pid, number)

    def wait(self, patience: float = PATIENCE) -> FinishedCommand:
        """Wait for the end and return it; kill the child after ``patience`` s."""
        stop = time.monotonic() + patience
        while self.is_running():
            if time.monotonic() > stop:
                self.send_signal(signal.SIGKILL)
                _, status = os.waitpid(self.pid, 0)
                self._read_result(status)
                break
            time.sleep(0.002)
        assert self.finished is not None
        return self.finished

    def _read_result(self, status: int) -> None:
        """Store the result of an ended child, from its wait status and output files."""
        code = os.waitstatus_to_exitcode(status)
        out, err = (path.read_text("utf-8", "replace") for path in self.files)
        for path in self.files:
            path.unlink()
        self.finished = FinishedCommand(code, out, err, time.monotonic() - self.begun)


def run_child(
    arguments: list[str],
    files: list[Path],
    folder: Path,
    prepare: Callable[[], object] | None,
) -> None:
    """Run the command in the forked child, and exit the process: never returns."""
    code = 70
    try:
        os.setsid()
        for path, number in zip(files, (1, 2), strict=True):
            os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        sys.stdout, sys.stderr = (io.TextIOWrapper(io.FileIO(n, "w")) for n in (1, 2))
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        os.environ.update({"TMPDIR": str(folder), "SOURCE_DATE_EPOCH": "0"})
        tempfile.tempdir = None
        # of its own: killed with the lock of all in hand it would stop every child after it
        tqdm.set_lock(threading.RLock())
        atexit._clear()  # type: ignore[attr-defined]
        if prepare:
            prepare()
        code = run_command(arguments)
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        atexit._run_exitfuncs()  # type: ignore[attr-defined]
        os._exit(code)


def run_command(arguments: list[str]) -> int:
    """Run a command; return its exit code, print uncaught errors as Python does."""
    from orchestrate.__main__ import main

    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)  # not before its own life begins
        sys.argv[1:] = arguments
        return main()
    except SystemExit as ended:
        return int(ended.code or 0)
    except BaseException:
        sys.excepthook(*sys.exc_info())  # type: ignore[arg-type]
        return 1
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def limit_memory() -> None:
    """Limit memory and file size of this process, for input that may exhaust them."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)


def import_all() -> None:
    """Import what every command needs before forking, once for all forked commands."""
    import matplotlib.pyplot
    import xarray

    import orchestrate.cli
    from orchestrate.access import MODELS, find

    for model in MODELS:
        find(model)
    assert matplotlib.pyplot and xarray and orchestrate.cli
