"""FMUs of somebody else that crash, exit or hang end a command in a line and an exit code."""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path

import pytest

from orchestrate import Structure, cosimulate, sweep
from orchestrate.errors import FmuError, WorkerError
from orchestrate.fmu import ELECTRODYNAMIC_SHAKER, OSCILLATOR, find
from tests.orchestrate.fmu.misbehaving import misbehaving

from .commands import all_end, below, end, kill, wait_for

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="binaries of Linux, /proc")
SLOW = pytest.mark.slow
SWEEP = ("sweep", "--eta", "1,1.1", "--transient", "5", "--samples", "3", "--plot", "none")
BEGINS_ANEW = "nothing was stored; repeat the command to start again"


@pytest.fixture(scope="module")
def bad(exported, tmp_path_factory):
    """FMUs by what they do wrong, made once."""
    folder = tmp_path_factory.mktemp("bad")

    def made(kind, model=OSCILLATOR):
        path = folder / f"{kind}-{model}.fmu".replace(" ", "-")
        return path if path.exists() else misbehaving(find(model).path, path, kind)

    return made


def test_a_drive_that_ends_its_process_is_told(bad):
    drive, connect = bad("crashes", ELECTRODYNAMIC_SHAKER), ("box_acceleration", "box_force")
    motion = {"connect": {name: name for name in connect}, "duration": 0.1, "step": 0.01}
    with pytest.raises(WorkerError, match="by SIGSEGV"):
        cosimulate(Structure(), drive, inputs={"command": 1.0}, **motion)


def test_numbers_that_are_none_are_told(bad):
    with pytest.raises(FmuError, match="TwoMassImpactOscillator answers x1_sample = nan; expected"):
        sweep(Structure(), eta=[1.0], transient=5, samples=3, fmu=bad("NaN"))


@pytest.mark.parametrize("kind", ["crashes", pytest.param("exits", marks=SLOW)])
def test_a_command_ends_in_a_line_and_leaves_nothing_behind(commands, bad, kind):
    done = commands.run(*SWEEP, "--fmu", bad(kind))
    done.complaint("error: a worker process ended without a word", code=1)
    assert done.out == "" and commands.files() == []
    assert list(commands.temporary.iterdir()) == []


def under_way(commands, fmu):
    """A command that is in a call of its FMU which does not return, and its processes."""
    process = commands.start(*SWEEP, "--fmu", fmu)

    def loaded():
        maps = [Path(f"/proc/{pid}/maps") for pid in below(process.pid)]
        return any("good.so" in place.read_text() for place in maps if place.exists())

    wait_for(loaded, process, "the FMU was loaded", pause=0.05)
    time.sleep(0.3)
    return process, list(below(process.pid))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "number", "word"),
    [
        ("hangs", signal.SIGINT, "interrupted"),
        pytest.param("spins", signal.SIGTERM, "terminated", marks=SLOW),
    ],
)
def test_a_signal_ends_a_command_whose_fmu_hangs(commands, bad, kind, number, word):
    process, started = under_way(commands, bad(kind))
    done = kill(process, number)  # sent to all processes, as a terminal does
    assert done.complaint(code=128 + number) == f"{word}: {BEGINS_ANEW}"
    assert all_end(started) and list(commands.temporary.iterdir()) == []


@pytest.mark.slow
def test_an_fmu_that_hangs_ends_with_its_command(commands, bad):
    process, started = under_way(commands, bad("spins"))
    process.kill()
    assert all_end(started, patience=3.0)
    end(process)
