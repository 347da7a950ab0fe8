"""A command in a hostile place: outputs that are closed, full or not read, few files, signals."""

import io
import subprocess
import sys
import time
from importlib.metadata import entry_points
from unittest.mock import Mock

import pytest

from orchestrate import __main__, cli
from orchestrate.__main__ import run_command_line
from orchestrate.cli import main, responses
from orchestrate.cli.safe_output import SafeStream
from tests import ROOT
from tests.faults import Surroundings

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/dev/full, limits, /proc")
ASKED = ("sweep", "--eta", "1.2", "--transient", "5", "--samples", "2", "--plot", "none")
PLACES = [  # how it may end, and what is left
    ({"stderr": "closed"}, (0,), [".nc"]),
    ({"stderr": "/dev/full"}, (0,), [".nc"]),
    ({"stdout": "closed", "stderr": "closed"}, (0,), [".nc"]),
    ({"open_files": 12}, (0,), [".nc"]),
    ({"stdout": "/dev/full"}, (1,), [".nc"]),
    *(({"open_files": count}, (0, 1), None) for count in (5, 6, 7, 8)),
]


@pytest.mark.slow
@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize(("where", "codes", "left"), PLACES)
def test_a_run_goes_on_or_ends_in_a_line(tmp_path, where, codes, left):
    command = [sys.executable, "-m", "orchestrate", *ASKED, "--output", "results"]
    done = Surroundings(**where).run(command, tmp_path, PYTHONPATH=str(ROOT))
    for words in ("Traceback", "Broken pipe", "another process"):
        assert words not in done.stderr
    assert done.returncode in codes, done.stderr
    results = [path.suffix for path in (tmp_path / "results").glob("*")]
    assert left is None or results == left
    full = "standard output: No space left on device" in done.stderr
    assert full == (where.get("stdout") == "/dev/full")


class Broken(io.StringIO):
    """A stream that nobody reads any more."""

    def write(self, text: str) -> int:
        raise BrokenPipeError


def test_an_output_that_nobody_reads_ends_nothing_and_what_is_lost_is_known(monkeypatch):
    monkeypatch.setattr(sys, "stdout", Broken())
    monkeypatch.setattr(sys, "stderr", Broken())
    assert main(["--help"]) == 0
    assert main(["sweep", "--eta", "nothing"]) == 2
    closed = io.StringIO()
    closed.close()
    for stream, words in ((Broken(), ""), (closed, "closed file")):
        safe = SafeStream(stream)
        assert safe.write("told") == 4 and words in safe.failure_reason()
        assert bool(safe.failure_reason()) == bool(words)


@pytest.mark.parametrize("encoding", ["ascii", "cp1251", "cp932"])
def test_a_console_without_some_letters_gets_the_others(encoding):
    """It had got nothing at all, because of one accent."""
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    safe = SafeStream(stream)
    safe.write("Poincaré \u2192 map\nsweep\n")
    safe.flush()
    assert safe.error is None
    lines = stream.buffer.getvalue().decode(encoding).splitlines()
    assert lines[0].startswith("Poincar") and lines[0].endswith("map") and lines[1] == "sweep"


@pytest.mark.parametrize("error", [MemoryError, ImportError("libx.so: cannot map\nmore")])
def test_too_little_memory_is_a_line(monkeypatch, capsys, error):
    monkeypatch.setattr(responses.Sweep, "__call__", Mock(side_effect=error))
    assert main(["sweep"]) == 1
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and "out of memory" in told


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


IN_A_CALLBACK = """
import signal, sys, time, weakref
from orchestrate.__main__ import main
from orchestrate.cli import responses

class Thing:
    pass

def run(_):
    thing = Thing()
    kept = weakref.ref(thing, lambda _: signal.raise_signal(signal.SIGTERM))
    del thing
    time.sleep(60)

responses.Sweep.__call__ = run
sys.argv = ["vibroimpact", "sweep"]
sys.exit(main())
"""


def test_a_signal_in_a_callback_ends_the_command():
    """There Python drops what a signal raises, and goes on."""
    begun, how = time.monotonic(), {"cwd": ROOT, "capture_output": True, "text": True}
    done = subprocess.run([sys.executable, "-c", IN_A_CALLBACK], **how)
    assert time.monotonic() - begun < 50.0 and (done.returncode, done.stdout) == (143, "")
    assert done.stderr.startswith("terminated: ") and done.stderr.count("\n") == 1


def test_an_interrupt_before_the_command_has_begun(monkeypatch, capfd):
    for place in ("make_app", "safe_outputs"):
        with monkeypatch.context() as patch:
            patch.setattr(cli, place, Mock(side_effect=KeyboardInterrupt))
            assert cli.main(["sweep", "--eta", "1"]) == 130
        assert capfd.readouterr().err.startswith("interrupted: ")
    monkeypatch.setattr(sys.modules["orchestrate.cli"], "main", Mock(side_effect=KeyboardInterrupt))
    assert run_command_line() == 130 and capfd.readouterr().err == "interrupted\n"
    (point,) = entry_points(group="console_scripts", name="vibroimpact")
    assert point.load() is __main__.main
