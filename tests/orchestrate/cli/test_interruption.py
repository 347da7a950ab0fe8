"""A command ended by force goes on where it was: its results have the uninterrupted bytes."""

from __future__ import annotations

import os
import signal
import sys
import time

import pytest

from orchestrate.cli import main

from .commands import all_end, below, end, wait_for

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="process groups and /proc")
RESUME = "repeat the command (without --force) to resume"
INTERRUPTED = f"interrupted: what was stored is kept; {RESUME}"
BEGINS_ANEW = "interrupted: nothing was stored; repeat the command to start again"


GRID = ("--eta", "1.1:1.4:0.005", "--over", "e", "--values", "0.3:0.9:0.005")
MAP = ("map", *GRID, "--jobs", "2")
RECORD = ("docs/records/beam_a.csv", "--structure", "docs/records/beam.toml")
ALONE = ("sweep", "--eta", "1.1:1.2:0.001", "--transient", "1000000", "--jobs", "1")  # in one chunk


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "command", "processes"),
    [
        (signal.SIGINT, (*MAP, "--transient", "20000"), 4),
        (signal.SIGTERM, (*MAP, "--transient", "20000"), 4),
        (signal.SIGINT, ALONE, 0),
        (signal.SIGINT, ("diagnose", *RECORD), 0),
    ],
)
def test_a_signal_ends_a_command_whatever_computes(commands, number, command, processes):
    process = commands.start(*command, "--plot", "none")
    wait_for(lambda: commands.files(), process, "it computed", pause=0.05)
    wait_for(lambda: len(list(below(process.pid))) >= processes, process, "workers were there")
    time.sleep(1.0)
    started = list(below(process.pid))
    begun = time.monotonic()
    os.killpg(process.pid, number)
    word = "interrupted" if number == signal.SIGINT else "terminated"
    done = end(process)
    assert done.code == 128 + number and "Traceback" not in done.err, done.err
    assert done.err.splitlines()[-1].startswith(f"{word}: ")
    assert time.monotonic() - begun < 10.0
    assert all_end(started) and list(commands.temporary.iterdir()) == []


def interrupt(*_, **__):
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("place", "line"),
    [
        ("orchestrate.response.sweep.SweepJob.work", BEGINS_ANEW),
        ("orchestrate.running.store.Disk.finish", INTERRUPTED),
        (
            "orchestrate.cli.output.Files.write",
            f"interrupted: the result is stored; {RESUME}",
        ),
    ],
)
def test_an_interrupted_command_says_whether_there_is_anything_to_go_on_from(
    tmp_path, capsys, monkeypatch, place, line
):
    for _ in range(2):  # the second time in a process that has stored something
        asked = ["sweep", "--eta", "1:1.1:0.1", "--transient", "5", "--plot", "none"]
        with monkeypatch.context() as patch:
            patch.setattr(place, interrupt)
            assert main([*asked, "--output", str(tmp_path)]) == 130
        assert capsys.readouterr().err.splitlines()[-1] == line
        assert main([*asked, "--output", str(tmp_path / "other")]) == 0


def test_an_interrupted_command_without_a_store_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("orchestrate.explorer.page.render_page", interrupt)
    assert main(["explore", "--no-open", "--output", str(tmp_path / "page.html")]) == 130
    assert capsys.readouterr().err.splitlines() == [BEGINS_ANEW]
