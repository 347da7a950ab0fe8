"""A command in a hostile place: outputs that are closed, full or not read, few files, signals."""

import io
import subprocess
import sys
import time
from importlib.metadata import entry_points
from unittest.mock import Mock

import pytest

from orchestrate import __main__, cli
from orchestrate.__main__ import run
from orchestrate.cli import main, responses
from orchestrate.cli.safe_output import SafeStream
from tests.faults import Surroundings

from .commands import ROOT

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/dev/full, limits, /proc")
ASKED = ("sweep", "--eta", "1.2", "--transient", "5", "--samples", "2", "--plot", "none")


def ask(folder, **where):
    """A short command, and its result's name where there is one."""
    command = [sys.executable, "-m", "orchestrate", *ASKED, "--output", "results"]
    done = Surroundings(**where).run(command, folder, PYTHONPATH=str(ROOT))
    assert "Traceback" not in done.stderr, done.stderr
    assert "Broken pipe" not in done.stderr
    return done, [path.suffix for path in (folder / "results").glob("*")]


@pytest.mark.slow
@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize(
    "where",
    [
        {"stderr": "closed"},
        {"stderr": "/dev/full"},
        {"stdout": "closed"},
        {"stdout": "closed", "stderr": "closed"},
        {"open_files": 12},
    ],
)
def test_the_run_goes_on(tmp_path, where):
    done, results = ask(tmp_path, **where)
    assert done.returncode == 0, done.stderr
    assert results == [".nc"]


@pytest.mark.slow
@pytest.mark.usefixtures("exported")
def test_a_full_output_is_told_and_the_result_kept(tmp_path):
    done, results = ask(tmp_path, stdout="/dev/full")
    assert done.returncode == 1
    assert "standard output: No space left on device" in done.stderr
    assert results == [".nc"]


@pytest.mark.slow
@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("open_files", [5, 6, 7, 8])
def test_too_few_files_are_told(tmp_path, open_files):
    done, _ = ask(tmp_path, open_files=open_files)
    assert done.returncode in (0, 1)
    assert "another process" not in done.stderr


class Broken(io.StringIO):
    """A stream that nobody reads any more."""

    def write(self, text: str) -> int:
        raise BrokenPipeError


def test_an_output_that_nobody_reads_ends_nothing(monkeypatch):
    monkeypatch.setattr(sys, "stdout", Broken())
    monkeypatch.setattr(sys, "stderr", Broken())
    assert main(["--help"]) == 0
    assert main(["sweep", "--eta", "nothing"]) == 2


def test_what_is_lost_is_known():
    stream = SafeStream(Broken())
    stream.write("told")
    assert stream.failure() == ""
    closed = io.StringIO()
    closed.close()
    stream = SafeStream(closed)
    assert stream.write("told") == 4
    assert "closed file" in stream.failure()


@pytest.mark.parametrize("error", [MemoryError, ImportError("libx.so: cannot map\nmore")])
def test_too_little_memory_is_a_line(monkeypatch, capsys, error):
    def fail(_):
        raise error

    monkeypatch.setattr(responses.Sweep, "__call__", fail)
    assert main(["sweep"]) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "out of memory, or the installation is incomplete" in told


IN_A_CALLBACK = """
import signal, sys, time, weakref
from orchestrate.__main__ import main
from orchestrate.cli import responses

class Thing:
    pass

def run(_):
    thing = Thing()
    kept = weakref.ref(thing, lambda _: signal.raise_signal(signal.{signal}))
    del thing
    time.sleep(60)

signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
responses.Sweep.__call__ = run
sys.argv = ["vibroimpact", "sweep"]
sys.exit(main())
"""


def test_a_command_loads_nothing_of_dask(tmp_path):
    """It takes as long to load as the rest of a small sweep."""
    pytest.importorskip("dask.array")
    words = ["sweep", "--eta", "0.9,1.0", "--transient", "5", "--output", str(tmp_path)]
    script = (
        f"import sys; from orchestrate.__main__ import main; sys.argv[1:] = {words}; main(); "
        "print([name for name in sys.modules if name.startswith(('dask.', 'scipy.'))])"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "[]")


@pytest.mark.parametrize(
    ("name", "code", "word"), [("SIGINT", 130, "interrupted"), ("SIGTERM", 143, "terminated")]
)
def test_a_signal_in_a_callback_ends_the_command(name, code, word):
    """There Python drops what a signal raises, and goes on."""
    script = IN_A_CALLBACK.format(signal=name)
    begun = time.monotonic()
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True)
    assert time.monotonic() - begun < 50.0
    assert (done.returncode, done.stdout) == (code, "")
    assert done.stderr.startswith(f"{word}: ")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("place", ["make_app", "set_up_logging"])
def test_an_interrupt_before_the_command_has_begun(monkeypatch, capfd, place):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, place, interrupt)
    assert cli.main(["sweep", "--eta", "1"]) == 130
    assert capfd.readouterr().err.startswith("interrupted: ")


def test_an_interrupt_while_modules_are_read(monkeypatch, capfd):
    monkeypatch.setattr(sys.modules["orchestrate.cli"], "main", Mock(side_effect=KeyboardInterrupt))
    assert run() == 130
    assert capfd.readouterr().err == "interrupted\n"


def test_the_installed_command_is_the_same():
    (point,) = entry_points(group="console_scripts", name="vibroimpact")
    assert point.load() is __main__.main


@pytest.mark.parametrize("encoding", ["ascii", "cp1251", "cp932"])
def test_a_console_without_some_letters_gets_the_others(encoding):
    """It had got nothing at all, because of one accent."""
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    safe = SafeStream(stream)
    safe.write("Poincaré \u2192 map\n")
    safe.write("sweep\n")
    safe.flush()
    assert safe.error is None
    lines = stream.buffer.getvalue().decode(encoding).splitlines()
    assert lines[0].startswith("Poincar") and lines[0].endswith("map") and lines[1] == "sweep"
