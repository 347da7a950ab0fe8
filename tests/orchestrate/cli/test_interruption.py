"""A command ended by force, by Ctrl-C or by a drive that hangs, and what it says of going on."""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path

import pytest

from orchestrate import Structure, cosimulate, sweep
from orchestrate.cli import main
from orchestrate.errors import FmuError, WorkerError
from orchestrate.fmu import ELECTRODYNAMIC_SHAKER, OSCILLATOR, find_or_export
from tests.orchestrate.fmu.misbehaving import misbehaving

from .commands import all_end, below, end, kill, wait_for

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="process groups and /proc")
RESUME = "repeat the command (without --force) to resume"
INTERRUPTED = f"interrupted: what was stored is kept; {RESUME}"
BEGINS_ANEW = "interrupted: nothing was stored; repeat the command to start again"
NO_PLOT = ("--plot", "none")
SWEEP = ("sweep", "--eta", "1,1.1", "--transient", "5", "--samples", "3", *NO_PLOT)


def interrupt(*_, **__):
    raise KeyboardInterrupt


def test_an_interrupted_command_says_whether_there_is_anything_to_go_on_from(
    tmp_path, capsys, monkeypatch
):
    work = "orchestrate.response.sweep.SweepJob.work", BEGINS_ANEW
    ends = "orchestrate.running.store.DiskStore.finish", INTERRUPTED
    stored = f"interrupted: the result is stored; {RESUME}"
    shows = "orchestrate.cli.output.ResultFiles.write_tables", stored
    for number, (place, told) in enumerate((work, ends, shows, work, shows)):
        with monkeypatch.context() as patch:
            patch.setattr(place, interrupt)
            assert main([*SWEEP, "--output", str(tmp_path / str(number))]) == 130
        assert capsys.readouterr().err.splitlines()[-1] == told
        # what follows is told in a process that has stored something
        assert main([*SWEEP, "--output", str(tmp_path / "other")]) == 0
    capsys.readouterr()
    monkeypatch.setattr("orchestrate.explorer.page.render_page", interrupt)  # without a store
    assert main(["explore", "--no-open", "--output", str(tmp_path / "page.html")]) == 130
    assert capsys.readouterr().err.splitlines() == [BEGINS_ANEW]


@pytest.fixture(scope="module")
def bad(exported, tmp_path_factory):
    """FMUs by what they do wrong, made once."""
    folder = tmp_path_factory.mktemp("bad")

    def made(kind, model=OSCILLATOR):
        path = folder / f"{kind}-{model}.fmu".replace(" ", "-")
        return path if path.exists() else misbehaving(find_or_export(model).path, path, kind)

    return made


def test_a_drive_that_ends_its_process_and_numbers_that_are_none_are_told(bad):
    drive, connect = bad("crashes", ELECTRODYNAMIC_SHAKER), ("box_acceleration", "box_force")
    motion = {"connect": {name: name for name in connect}, "duration": 0.1, "step": 0.01}
    with pytest.raises(WorkerError, match="by SIGSEGV"):
        cosimulate(Structure(), drive, inputs={"command": 1.0}, **motion)
    with pytest.raises(FmuError, match="TwoMassImpactOscillator answers x1_sample = nan"):
        sweep(Structure(), eta=[1.0], transient=5, samples=3, fmu=bad("NaN"))


@pytest.mark.parametrize("kind", ["crashes", pytest.param("exits", marks=pytest.mark.slow)])
def test_a_command_ends_in_a_line_and_leaves_nothing_behind(commands, bad, kind):
    done = commands.run(*SWEEP, "--fmu", bad(kind))
    done.complaint("error: a worker process ended without a word", code=1)
    assert done.out == "" and commands.files() == []
    assert list(commands.temporary.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "number"),
    [("hangs", signal.SIGINT), ("spins", signal.SIGTERM), ("spins", signal.SIGKILL)],
)
def test_a_signal_ends_a_command_whose_fmu_hangs(commands, bad, kind, number):
    process = commands.start(*SWEEP, "--fmu", bad(kind))

    def loaded():
        maps = [Path(f"/proc/{pid}/maps") for pid in below(process.pid)]
        return any("good.so" in place.read_text() for place in maps if place.exists())

    wait_for(loaded, process, "the FMU was loaded", pause=0.05)
    time.sleep(0.3)
    started = list(below(process.pid))
    if number == signal.SIGKILL:  # of the command alone: the FMU ends with it
        process.kill()
        assert all_end(started, patience=3.0)
        end(process)
        return
    done = kill(process, number)  # sent to all processes, as a terminal does
    word = "interrupted" if number == signal.SIGINT else "terminated"
    assert done.complaint(code=128 + number) == BEGINS_ANEW.replace("interrupted", word)
    assert all_end(started) and list(commands.temporary.iterdir()) == []
