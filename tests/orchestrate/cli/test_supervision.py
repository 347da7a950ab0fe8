"""A command ends whatever an FMU or a library does in it, with a line and its exit code."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from orchestrate import supervisor
from orchestrate.access import OSCILLATOR, find
from tests.orchestrate.access.misbehaving import misbehaving

from .commands import ROOT, all_end, below, end, wait_for

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="binaries of Linux, /proc")
SLOW = pytest.mark.slow
KEPT = "what was stored before is kept"
SWEEP = ("sweep", "--eta", "1,1.1", "--transient", "5", "--samples", "3", "--plot", "none")
ENDS = {  # the line of a command whose FMU does this
    "aborts": f"error: the command was ended by SIGABRT: an FMU or a library has crashed; {KEPT}",
    "crashes": f"error: the command was ended by SIGSEGV: an FMU or a library has crashed; {KEPT}",
    "exits": "error: an FMU or a library has ended the command, with exit code 0; expected an "
    f"answer; {KEPT}",
    "exits with 3": "error: an FMU or a library has ended the command, with exit code 3; expected "
    f"an answer; {KEPT}",
    "NaN": "error: the FMU TwoMassImpactOscillator answers x1_sample = nan; expected a finite "
    "number",
}


@pytest.fixture(scope="module")
def bad(exported, tmp_path_factory):
    """FMUs by what they do wrong, made once."""
    folder = tmp_path_factory.mktemp("bad")

    def made(kind, function="fmi3DoStep"):
        path = folder / f"{kind}-{function}.fmu".replace(" ", "-")
        return path if path.exists() else misbehaving(find(OSCILLATOR).path, path, kind, function)

    return made


OFTEN = ("aborts", "exits", "NaN")


@pytest.mark.parametrize(
    "kind", [kind if kind in OFTEN else pytest.param(kind, marks=SLOW) for kind in ENDS]
)
def test_an_fmu_that_ends_the_command_is_told(commands, bad, kind):
    done = commands.run(*SWEEP, "--fmu", bad(kind))
    assert done.complaint(code=1) == ENDS[kind]
    assert done.out == "" and not list(commands.output.glob("*.nc"))
    assert list(commands.temporary.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["aborts", "exits"])
def test_an_fmu_that_ends_a_worker_is_told(commands, bad, kind):
    long = ("sweep", "--eta", "1:1.2:0.0001", "--transient", "20", "--samples", "3")
    script = (
        "import sys, orchestrate.running.runner as runner; runner.Runner.little_left = "
        "lambda self: False; from orchestrate.__main__ import main; sys.exit(main())"
    )
    command = [sys.executable, "-c", script, *long, "--plot", "none", "--jobs", "2"]
    command += ["--fmu", bad(kind), "--output", commands.output]
    done = subprocess.run(list(map(str, command)), cwd=ROOT, capture_output=True, text=True)
    lines = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert len(lines) == 1 and "an FMU has crashed or ended it" in lines[0]


def under_way(commands, fmu):
    """A command that is in a call of its FMU which does not return."""
    process = commands.start(*SWEEP, "--fmu", fmu)

    def loaded():
        maps = [Path(f"/proc/{pid}/maps") for pid in below(process.pid)]
        return any("good.so" in place.read_text() for place in maps if place.exists())

    wait_for(loaded, process, "the FMU was loaded", pause=0.05)
    time.sleep(0.3)
    return process


@pytest.mark.parametrize(
    ("kind", "function", "number", "line"),
    [
        ("hangs", "fmi3DoStep", signal.SIGINT, "interrupted"),
        pytest.param(
            *("hangs", "fmi3InstantiateCoSimulation", signal.SIGTERM, "terminated"), marks=SLOW
        ),
        pytest.param("spins", "fmi3DoStep", signal.SIGTERM, "terminated", marks=SLOW),
    ],
)
def test_a_second_signal_ends_a_command_whose_fmu_hangs(
    commands, bad, kind, function, number, line
):
    process = under_way(commands, bad(kind, function))
    started = list(below(process.pid))
    begun = time.monotonic()
    os.killpg(process.pid, number)  # as a terminal does
    time.sleep(2.0 * supervisor.HEARD)
    assert process.poll() is None
    os.killpg(process.pid, number)
    done = end(process)
    assert time.monotonic() - begun < supervisor.DEAF  # which one signal alone takes
    assert done.complaint(code=128 + number).startswith(f"{line}; what ran did not answer")
    assert all_end(started) and list(commands.temporary.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["hangs", "spins"])
def test_a_while_after_one_signal_a_command_whose_fmu_hangs_is_ended(commands, bad, kind):
    process = under_way(commands, bad(kind))
    begun = time.monotonic()
    os.kill(process.pid, signal.SIGTERM)
    done = end(process)
    assert supervisor.DEAF - 0.5 < time.monotonic() - begun < supervisor.DEAF + 3.0
    assert done.complaint(code=143).startswith("terminated; what ran did not answer")


SPINS = "import collections, itertools; collections.deque(itertools.repeat(0), maxlen=0)"


def test_a_command_whose_import_spins_is_ended(tmp_path):
    """In C, with Python's lock in hand: no signal handler of Python's runs, and no thread."""
    (tmp_path / "numpy.py").write_text(SPINS)
    process = subprocess.Popen(
        [sys.executable, "-m", "orchestrate", "sweep"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler) and None,
    )
    wait_for(lambda: list(below(process.pid)), process, "the child was there")
    time.sleep(2.0)
    started = list(below(process.pid))
    for _ in range(2):
        assert process.poll() is None
        os.killpg(process.pid, signal.SIGINT)
        time.sleep(2.0 * supervisor.HEARD)
    done = end(process, 5.0)
    assert done.complaint(code=130).startswith("interrupted; what ran did not answer")
    assert all_end(started)


def test_a_command_that_hangs_ends_with_its_supervisor(commands, bad):
    process = under_way(commands, bad("spins"))
    started = list(below(process.pid))
    os.kill(process.pid, signal.SIGKILL)
    assert all_end(started, patience=3.0)
    end(process)


@pytest.mark.slow
def test_a_command_killed_by_somebody_is_told(commands, bad):
    process = under_way(commands, bad("hangs"))
    child = next(below(process.pid))
    os.kill(child, signal.SIGKILL)
    line = end(process).complaint(code=1)
    assert line == (
        f"error: the command was ended by SIGKILL: by somebody, or for want of memory; {KEPT}"
    )


def test_exit_codes_and_outputs_are_those_of_the_command(commands):
    commands.run("sweep", "--eta", "nothing").complaint("--eta nothing", code=2)
    assert commands.run("sweep", "--help").out.startswith("usage: ")


def test_the_installed_command_is_the_same():
    from importlib.metadata import entry_points

    from orchestrate import __main__

    (point,) = entry_points(group="console_scripts", name="vibroimpact")
    assert point.load() is __main__.main


def test_what_a_late_worker_leaves_behind_is_removed_after_an_interrupt(tmp_path):
    """A worker that was killed may end after the command itself, on a busy machine."""
    script = """
import os, signal, subprocess, sys, tempfile, time
from orchestrate.supervisor import confirm_signal, run_supervised
signal.signal(signal.SIGINT, signal.default_int_handler)  # it may be ignored where tests run
def work():
    late = subprocess.Popen(["sleep", "60"])
    folder = os.path.join(tempfile.gettempdir(), f"vibroimpact-fmu-{late.pid}-late")
    os.mkdir(folder)
    print("works", flush=True)
    try:
        time.sleep(60)
    except KeyboardInterrupt:
        confirm_signal()
        subprocess.Popen(["sh", "-c", f"sleep 0.5; kill -9 {late.pid}"])
        return 130
sys.exit(run_supervised(work))
"""
    surroundings = {**os.environ, "TMPDIR": str(tmp_path)}
    process = subprocess.Popen(
        [sys.executable, "-c", script], cwd=ROOT, env=surroundings, stdout=subprocess.PIPE
    )
    assert process.stdout.readline() == b"works\n"
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 130
    assert list(tmp_path.iterdir()) == []
