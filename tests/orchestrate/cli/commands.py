"""The command line as its users run it: processes to be killed with all their children."""

import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from tests import ROOT

PATIENCE = 300.0  # s; a machine may be busy


@dataclass
class Done:
    """How a command ended."""

    code: int
    out: str
    err: str

    @property
    def complaints(self) -> list[str]:
        """Lines of the error output without the progress bar."""
        lines = re.split(r"[\r\n]+", self.err)
        return [line.strip() for line in lines if line.strip() and not re.search(r"\d+%\|", line)]

    def complaint(self, *words: object, code: int = 2) -> str:
        """The one line of a command that failed as it should, with ``words`` in it."""
        assert "Traceback" not in self.err, self.err
        assert len(self.complaints) == 1, self.err
        assert self.code == code, (self.code, self.err)
        line = self.complaints[0]
        assert all(str(word) in line for word in words), line
        return line

    def success(self) -> "Done":
        """See that the command ended well and has nothing to complain of."""
        assert (self.code, self.complaints) == (0, []), (self.code, self.err)
        return self


class Commands:
    """Commands with one folder of results and one for temporary files."""

    def __init__(self, folder: Path) -> None:
        self.output, self.temporary = folder / "results", folder / "temporary"
        self.temporary.mkdir(parents=True, exist_ok=True)
        self.started: list[subprocess.Popen[str]] = []

    def start(
        self, *options: object, prepare: Callable[[], None] | None = None
    ) -> subprocess.Popen[str]:
        """Start a command; returns the process, which leads its process group."""

        def before() -> None:
            # where the tests run in the background Ctrl-C is ignored, and that is inherited
            signal.signal(signal.SIGINT, signal.default_int_handler)
            if prepare:
                prepare()

        command = [sys.executable, "-m", "orchestrate", *options, "--output", self.output]
        surroundings = {"TMPDIR": str(self.temporary), "SOURCE_DATE_EPOCH": "0"}
        process = subprocess.Popen(
            list(map(str, command)),
            cwd=ROOT,
            env={**os.environ, **surroundings},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            preexec_fn=before,
        )
        self.started.append(process)
        return process

    def run(self, *options: object, prepare: Callable[[], None] | None = None) -> Done:
        """Run a command from its start to its end."""
        return end(self.start(*options, prepare=prepare))

    def clean_up(self) -> None:
        """End what a failed test left running."""
        for process in self.started:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            for stream in (process.stdout, process.stderr):
                if stream:
                    stream.close()

    def files(self) -> list[str]:
        """Names in the folder of the results."""
        return sorted(p.name for p in self.output.iterdir()) if self.output.is_dir() else []

    def results(self) -> dict[str, bytes]:
        """Bytes of the NetCDF files, by name."""
        return {path.name: path.read_bytes() for path in sorted(self.output.glob("*.nc"))}


def end(process: subprocess.Popen[str], patience: float = PATIENCE) -> Done:
    """Wait for the end of a process, ``patience`` seconds at most."""
    out, err = process.communicate(timeout=patience)
    return Done(process.returncode, out, err)


def kill(process: subprocess.Popen[str], number: int = signal.SIGKILL) -> Done:
    """Send a signal to a command and all its children, as a terminal does."""
    os.killpg(process.pid, number)
    return end(process)


def chunks_in(journal: Path) -> int:
    """Chunks in a journal; 0 where it cannot be read just now."""
    try:
        with closing(sqlite3.connect(f"file:{journal}?mode=ro", uri=True, timeout=5.0)) as found:
            return int(found.execute("SELECT COUNT(*) FROM chunks").fetchone()[0])
    except sqlite3.Error:
        return 0


def wait_for(
    condition: Callable[[], bool], process: subprocess.Popen[str], what: str, pause: float = 0.005
) -> None:
    """Wait until a condition holds while a command runs."""
    stop = time.monotonic() + PATIENCE
    while not condition():
        if process.poll() is not None:
            raise AssertionError(f"the command ended before {what}: {process.communicate()}")
        assert time.monotonic() < stop, f"{what}: not within {PATIENCE} s"
        time.sleep(pause)


def below(pid: int) -> Iterator[int]:
    """Process ids of all that a process has started, and what those have."""
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and status(entry.name)[1] == str(pid):
            yield int(entry.name)
            yield from below(int(entry.name))


def status(pid: int | str) -> list[str]:
    """State of a process and its parent, from Linux's /proc; as dead where it has ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[:2]
    except OSError:
        return ["X", ""]


def is_alive(pid: int) -> bool:
    return status(pid)[0] not in "ZX"


def all_end(pids: list[int], patience: float = 20.0) -> bool:
    """Whether all processes end within a while."""
    stop = time.monotonic() + patience
    while any(map(is_alive, pids)) and time.monotonic() < stop:
        time.sleep(0.05)
    return not any(map(is_alive, pids))
