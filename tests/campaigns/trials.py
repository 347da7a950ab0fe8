"""Trials of commands with one fault each."""

from __future__ import annotations

import random
import shutil
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .children import ChildCommand, FinishedCommand, import_all

PLAIN = ("--plot", "none", "--jobs", "1")
ALONG = ("--eta", "1.1:1.16:0.002")
GIVEN = "given.nc"  # beside the folder of a trial: what a command begins from
COMMANDS: dict[str, tuple[str, ...]] = {
    "sweep": ("sweep", *ALONG, "--transient", "200", "--samples", "8", *PLAIN),
    "map": (
        *("map", "--eta", "1.1,1.2", "--over", "e", "--values", "0.3,0.5,0.7"),
        *("--transient", "100", *PLAIN),
    ),
    "resonance": ("resonance", *ALONG, "--transient", "100", "--samples", "8", *PLAIN),
    "lyapunov": (
        *("lyapunov", "--eta", "1.1:1.16:0.02", "--transient", "100"),
        *("--periods", "200", *PLAIN),
    ),
    "attractors": (
        *("attractors", "--eta", "1.1,1.2", "--starts", "5", "--transient", "100", *PLAIN),
    ),
    "basin": (
        *("basin", "--eta", "1.2", "--x", "x_rel,0,1,6", "--y", "v_rel,-1,1,6"),
        *("--transient", "60", *PLAIN),
    ),
    "spectra": (
        *("spectra", "--eta", "1.1,1.2,1.3", "--transient", "300", "--periods", "8"),
        *("--points", "128", *PLAIN),
    ),
    "shake": (
        *("shake", "--structure", "beam", "--random", "5:0.1,100:0.1", "--duration", "150"),
        *("--seed", "1", *PLAIN),
    ),
    "branch": ("branch", "--eta", "2.5", "--limits", "2.45:2.55", *PLAIN),
    "couple": (
        *("couple", "--only", "delaminated", "--eta0", "1.4:1.404", "--rate", "2e-5"),
        *("--one-way", *PLAIN),
    ),
    "border": (
        *("border", "--start", GIVEN, "--limits", "2.4:2.9,0.65:0.75", "--most", "3", *PLAIN),
    ),
    "capture": (
        *("capture", "--only", "delaminated", "--count", "3", "--time", "4"),
        *("--tolerance", "0.1", *PLAIN),
    ),
    "passage": (
        *("passage", "--only", "delaminated", "--eta0", "1.4:1.402", "--rate", "1e-4"),
        *("--settle", "20", "--one-way", *PLAIN),
    ),
    "jump-voltages": (
        *("jump-voltages", "--eta0", "1.4:1.402", "--rate", "2e-4,1e-4"),
        *("--settle", "5", "--one-way", *PLAIN),
    ),
    "drive-branch": ("drive-branch", "--most", "2", "--steps", "16", "--settle", "2", *PLAIN),
    "paper": ("paper", "--quick", "--figures", "6", "--jobs", "1"),
}
BEFORE = {"border": ("branch", "--eta", "2.6", "--limits", "2.6:2.7", *PLAIN)}


@dataclass
class Trial:
    """One fault during one command."""

    name: str  # of the command
    folder: Path  # its results are in `results` below it
    expected: dict[str, bytes]  # results of the command where nothing happens
    seconds: float  # that it takes then
    chance: random.Random

    @property
    def output(self) -> Path:
        """Folder of the results."""
        return self.folder / "results"

    def arguments(self) -> list[str]:
        """Return the arguments of the command."""
        start_file = str(self.folder.parent / GIVEN)
        named = [start_file if text == GIVEN else text for text in COMMANDS[self.name]]
        return [*named, "--output", str(self.output)]

    def start(self, prepare: Callable[[], object] | None = None) -> ChildCommand:
        """Start the command in a child."""
        return ChildCommand(self.arguments(), self.folder / "temporary", prepare)

    def wait_a_moment(self) -> None:
        """Wait for a random moment of the command."""
        time.sleep(self.chance.uniform(0.0, self.seconds))

    def signal_and_wait(self, number: int) -> FinishedCommand:
        """Send a signal at a random moment; return how the command ends."""
        child = self.start()
        self.wait_a_moment()
        child.send_signal(number)
        return child.wait()

    def run_again(self) -> str:
        """Run the same command again; return empty if it ends with the same bytes, else why not."""
        ended = self.start().wait()
        return (
            f"the same command again: {format_end(ended)}" if ended.code else self.result_problem()
        )

    def result_problem(self) -> str:
        """Return what is wrong with the results of a command that ended well ("")."""
        if read_results(self.output) != self.expected:
            return "other bytes"
        left = [p.name for p in self.output.iterdir() if p.suffix not in KINDS]
        return f"left behind: {', '.join(left)}" if left else ""


KINDS = (".nc", ".png", ".pdf", ".html")  # of files that a command leaves


def format_end(ended: FinishedCommand) -> str:
    """Format how a command ended, as one line."""
    return f"exit code {ended.code}: {' / '.join(ended.lines)[:300]}"


def read_results(folder: Path) -> dict[str, bytes]:
    """Return a dict from name to bytes of a folder's NetCDF files."""
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.nc"))}


def message_problem(ended: FinishedCommand) -> str:
    """Return what is wrong with how a command gave up; empty if it said one line."""
    if ended.code == 0 and "Traceback" not in ended.err:
        return ""
    return "" if ended.code > 0 and len(ended.lines) == 1 else format_end(ended)


def run_undisturbed(name: str, holder: Path) -> tuple[dict[str, bytes], float]:
    """Run a command undisturbed; return its results and its duration, s."""
    folder = holder / "undisturbed"
    if name in BEFORE:
        before = [*BEFORE[name], "--store", str(holder / GIVEN), "--output", str(folder)]
        ended = ChildCommand(before, folder).wait(600.0)
        assert ended.code == 0, f"before {name}: {format_end(ended)}"
    ended = Trial(name, folder, {}, 0.0, random.Random()).start().wait(600.0)
    expected = read_results(folder / "results")
    assert ended.code == 0 and expected, f"{name}: {format_end(ended)}"
    shutil.rmtree(folder)
    return expected, ended.seconds


def attack(
    faults: Mapping[str, Callable[[Any], str]],
    commands: Sequence[str],
    make_trial: Callable[..., Trial],
    chance: random.Random,
    holder: Path,
    count: int,
) -> Iterator[str]:
    """Do faults in turn, each to a command drawn at random; yield what was wrong."""
    import_all()
    undisturbed: dict[str, tuple[dict[str, bytes], float]] = {}
    for number in range(count):
        name, fault = chance.choice(commands), list(faults)[number % len(faults)]
        if name not in undisturbed:
            undisturbed[name] = run_undisturbed(name, holder)
        folder = holder / "trial"
        folder.mkdir()
        if wrong := faults[fault](make_trial(name, folder, *undisturbed[name], chance)):
            yield f"fault {number} ({fault}, {name}): {wrong}"
        shutil.rmtree(folder, ignore_errors=True)
