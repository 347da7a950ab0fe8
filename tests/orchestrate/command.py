"""``python -m orchestrate`` as its users run it: a process in a session of its own, to be killed with all its children."""

import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
import zipfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NAME = "orbit_e0.7_D0.005_up"  # result of a sweep upwards with the default case
PATIENCE = 120.0  # s; a machine may be busy


@dataclass
class Done:
    """How a command ended."""

    code: int
    out: str
    err: str

    @property
    def complaints(self):
        """Lines of the error output without the progress bar."""
        text = re.sub(r"(?:sweep|paper): [^\r\n]*?\[[^\]\r\n]*\]", "\n", self.err)
        return [line.strip() for line in re.split(r"[\r\n]+", text) if line.strip()]

    @property
    def counts(self):
        """Values of eta done, as the progress bar showed them."""
        return [int(count) for count in re.findall(r"\| (\d+)/\d+ \[", self.err)]

    def complaint(self, *words, code=2):
        """Return the one line of a command that failed as it should, with ``words`` in it."""
        assert "Traceback" not in self.err, self.err
        assert len(self.complaints) == 1, self.err
        assert self.code == code, (self.code, self.err)
        line = self.complaints[0]
        assert all(str(word) in line for word in words), line
        return line

    def success(self):
        """See that the command ended well and has nothing to complain of."""
        assert (self.code, self.complaints) == (0, []), (self.code, self.err)
        return self


class Sweeps:
    """Sweep commands with one results folder and one folder for temporary files.

    Parameters
    ----------
    folder : Path
        Where both lie.
    fmu : Path
    """

    COMMAND = "sweep"

    def __init__(self, folder, fmu):
        self.output = Path(folder) / "results"
        self.temporary = Path(folder) / "temporary"
        self.temporary.mkdir(parents=True, exist_ok=True)
        self.fmu = fmu
        self.started = []

    def start(self, *options, preexec_fn=None):
        """Start a sweep; returns the process, which leads its process group."""

        def prepare():
            signal.signal(signal.SIGINT, signal.default_int_handler)  # where the tests run in the background it is ignored, and that is inherited
            if preexec_fn:
                preexec_fn()

        command = [sys.executable, "-m", "orchestrate", self.COMMAND, "--fmu", self.fmu, "--output", self.output, *options]
        process = subprocess.Popen(
            list(map(str, command)),
            cwd=ROOT,
            env={**os.environ, "TMPDIR": str(self.temporary)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            preexec_fn=prepare,
        )
        self.started.append(process)
        return process

    def run(self, *options, preexec_fn=None):
        """Run a sweep from its start to its end."""
        return self.end(self.start(*options, preexec_fn=preexec_fn))

    @staticmethod
    def end(process):
        """Wait for the end of a process."""
        out, err = process.communicate(timeout=PATIENCE)
        return Done(process.returncode, out, err)

    def kill(self, process, number=signal.SIGKILL):
        """Send a signal to a command and all its children, as a terminal does."""
        os.killpg(process.pid, number)
        return self.end(process)

    def clean_up(self):
        """End what a failed test left running."""
        for process in self.started:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            process.stdout.close()
            process.stderr.close()

    def journal(self, name=NAME):
        """Path of a journal."""
        return self.output / f"{name}.nc.journal"

    def rows(self, name=NAME):
        """Rows in a journal on disk, 0 where there is none yet."""
        try:
            database = sqlite3.connect(f"file:{self.journal(name)}?mode=ro", uri=True, timeout=5.0)
            try:
                return database.execute("SELECT COUNT(*) FROM rows").fetchone()[0]
            finally:
                database.close()
        except sqlite3.Error:
            return 0

    def wait_for(self, condition, process, what):
        """Wait until a condition holds while a command runs."""
        stop = time.monotonic() + PATIENCE
        while not condition():
            if process.poll() is not None:
                raise AssertionError(f"the command ended before {what}: {process.communicate()}")
            assert time.monotonic() < stop, f"{what}: not within {PATIENCE} s"
            time.sleep(0.005)

    def wait_for_rows(self, process, least):
        """Wait until so many rows are on disk; returns their number."""
        self.wait_for(lambda: self.rows() >= least, process, f"row {least} was on disk")
        return self.rows()

    def files(self):
        """Names in the results folder."""
        return sorted(path.name for path in self.output.iterdir()) if self.output.is_dir() else []

    def result(self, name=NAME):
        """Path of a result file."""
        return self.output / f"{name}.nc"


def children(pid):
    """Process ids of a process's children with their command lines, from Linux's /proc."""
    found = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and int((entry / "stat").read_text().rpartition(")")[2].split()[1]) == pid:
                found[int(entry.name)] = (entry / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        except OSError:  # it ended while we looked
            continue
    return found


def is_alive(pid):
    """Whether a process runs."""
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def altered_fmu(source, target, **changes):
    """Copy an FMU with attributes of its model description replaced: ``altered_fmu(a, b, modelName=("Old", "New"))``."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "modelDescription.xml":
                for attribute, (before, after) in changes.items():
                    assert f'{attribute}="{before}"'.encode() in content
                    content = content.replace(f'{attribute}="{before}"'.encode(), f'{attribute}="{after}"'.encode())
            new.writestr(name, content)
    return target
