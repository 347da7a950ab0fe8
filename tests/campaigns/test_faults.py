"""Commands killed, starved, damaged: run again, they give the bytes of one left in peace."""

import ctypes
import random
import resource
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from tests.faults import FILE_DAMAGE
from tests.orchestrate.cli.commands import Commands, Done, end, kill

from .findings import expect_none

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")
GIVEN = "given.nc"  # beside the folder of a trial: the orbit that a command starts from
STEPS = "--eta 1.1:1.16:0.002"
FROM = "border --limits 2.4:2.9,0.65:0.75 --most 3 --start"
RAMP = "--only delaminated --eta0 1.4:1.402"
QUICK = "paper --quick --figures 6 --jobs 1"  # with pictures
TEXTS = (
    f"sweep {STEPS} --transient 200 --samples 8",
    "map --eta 1.1,1.2 --over e --values 0.3,0.5,0.7 --transient 100",
    f"resonance {STEPS} --transient 100 --samples 8",
    "lyapunov --eta 1.1:1.16:0.02 --transient 100 --periods 200",
    "attractors --eta 1.1,1.2 --starts 5 --transient 100",
    "basin --eta 1.2 --x x_rel,0,1,6 --y v_rel,-1,1,6 --transient 60",
    "spectra --eta 1.1,1.2,1.3 --transient 300 --periods 8 --points 128",
    "shake --structure beam --random 5:0.1,100:0.1 --duration 150 --seed 1",
    "branch --eta 2.5 --limits 2.45:2.55",
    f"{FROM} {GIVEN}",
    f"couple {RAMP} --rate 2e-5 --one-way",
    "capture --only delaminated --count 3 --time 4 --tolerance 0.1",
    f"passage {RAMP} --rate 1e-4 --settle 20 --one-way",
    "jump-voltages --eta0 1.4:1.402 --rate 2e-4,1e-4 --settle 5 --one-way",
    "drive-branch --most 2 --steps 16 --settle 2",
)
COMMANDS = {text.split()[0]: f"{text} --plot none --jobs 1" for text in TEXTS}
DRAWN = (*COMMANDS, *COMMANDS, *COMMANDS, "paper")


@dataclass
class Trial:
    """One fault during one command."""

    options: list[str]
    folder: Path
    chance: random.Random
    expected: dict[str, bytes] = field(default_factory=dict)  # results where nothing happens
    seconds: float = 0.0  # that it takes then

    def __post_init__(self) -> None:
        """Make the folders of results and of temporary files."""
        self.commands = Commands(self.folder)

    def start(self, prepare: Callable[[], None] | None = None) -> Any:
        """Start the command; return its process."""
        return self.commands.start(*self.options, prepare=prepare)

    def run(self, prepare: Callable[[], None] | None = None) -> Done:
        """Run the command to its end."""
        return end(self.start(prepare))

    def disturb(self, number: int) -> Done:
        """Send a signal at a random moment of the command; return how it ends."""
        process = self.start()
        time.sleep(self.chance.uniform(0.0, self.seconds))
        return kill(process, number)

    def again(self) -> str:
        """Run the command again; return what is wrong with its end and its results ("")."""
        done = self.run()
        return format_end(done) if done.code else self.wrong_result()

    def wrong_result(self) -> str:
        """Return what is wrong with the results of a command that has ended well ("")."""
        if self.commands.results() != self.expected:
            return "other bytes"
        kinds = (".nc", ".png", ".pdf", ".html")
        left = [name for name in self.commands.files() if not name.endswith(kinds)]
        return f"left behind: {left}" if left else ""


def format_end(done: Done) -> str:
    """Format how a command ended, as one line."""
    return f"exit code {done.code}: {' / '.join(done.complaints)[:300]}"


def wrong_message(done: Done) -> str:
    """Return what is wrong with how a command gave up; empty if it said one line, or did not."""
    fine = done.code == 0 or (done.code > 0 and len(done.complaints) == 1)
    return "" if fine and "Traceback" not in done.err else format_end(done)


def kill_often(trial: Trial) -> str:
    """Kill it up to three times."""
    for _ in range(trial.chance.randint(1, 3)):
        trial.disturb(signal.SIGKILL)
    return trial.again()


def terminate(trial: Trial) -> str:
    """Send SIGTERM."""
    trial.disturb(signal.SIGTERM)
    return trial.again()


def interrupt(trial: Trial) -> str:
    """Send Ctrl-C: it ends with exit code 130 and at most one line."""
    done = trial.disturb(signal.SIGINT)
    if done.code not in (0, 130, -signal.SIGINT) or (done.code == 130 and len(done.complaints) > 1):
        return format_end(done)
    return trial.again()


def fill_disk(trial: Trial) -> str:
    """Limit the size of files as a quota does, to what the FMU needs or more."""
    most = trial.chance.randrange(900_000, 1_500_000)
    if trial.chance.random() < 0.5:  # not even that
        most = trial.chance.randrange(200_000)
    done = trial.run(lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
    return wrong_message(done) or trial.again()


def forbid_writing(trial: Trial) -> str:
    """Run where the results' folder is a file, or cannot be written."""
    output = trial.commands.output
    is_file = trial.chance.random() < 0.5
    if is_file:
        output.write_text("mine")
    else:
        output.mkdir(mode=0o555)
    done = trial.run(drop_capabilities)
    if done.code == 0 or wrong_message(done) or (is_file and output.read_text() != "mine"):
        return format_end(done)
    if is_file:
        output.unlink()
    else:
        output.chmod(0o755)
    return trial.again()


def drop_capabilities() -> None:
    """Drop root's right to write everywhere (capabilities 1 and 2 of Linux)."""
    for capability in (1, 2):
        ctypes.CDLL(None).prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP


def run_twice_at_once(trial: Trial) -> str:
    """Run the same command twice at once: one of them ends well."""
    first = trial.start()
    time.sleep(trial.chance.uniform(0.0, 0.5 * trial.seconds))
    ends = [end(process) for process in (trial.start(), first)]
    if 0 not in [done.code for done in ends]:
        return " and ".join(map(format_end, ends))
    return "".join(map(wrong_message, ends)) or trial.again()


def damage_files(trial: Trial, pattern: str) -> None:
    """Damage what a command has left: a bit, the end, a block, or all."""
    for path in sorted(trial.commands.output.glob(pattern)):
        if path.stat().st_size:
            trial.chance.choice(list(FILE_DAMAGE.values()))(path, trial.chance)


def damage_journal(trial: Trial) -> str:
    """Damage the journal of a killed command: it goes on, or says that it is to be removed."""
    trial.disturb(signal.SIGKILL)
    damage_files(trial, "*.journal*")
    done = trial.run()
    if done.code and not wrong_message(done):
        for path in trial.commands.output.glob("*.journal*"):
            path.unlink()  # the remedy
    return wrong_message(done) or trial.again()


def damage_result(trial: Trial) -> str:
    """Damage a finished result: it is never taken with other numbers."""
    trial.run()
    damage_files(trial, "*.nc")
    done = trial.run()
    if wrong_message(done):
        return format_end(done)
    if done.code == 0 and not has_same_numbers(trial):
        return "a damaged result is taken as it is"
    for path in trial.commands.output.glob("*.nc"):
        path.unlink()
    return trial.again()


def has_same_numbers(trial: Trial) -> bool:
    """Return whether results on disk hold the expected numbers."""
    other = trial.folder / "expected.nc"
    for name, data in trial.expected.items():
        other.write_bytes(data)
        with xr.open_dataset(trial.commands.output / name) as here, xr.open_dataset(other) as there:
            if not here.identical(there):
                return False
    return True


FAULTS: dict[str, Callable[[Trial], str]] = {
    "kill -9": kill_often,
    "SIGTERM": terminate,
    "Ctrl-C": interrupt,
    "full disk": fill_disk,
    "read-only": forbid_writing,
    "two at once": run_twice_at_once,
    "damaged journal": damage_journal,
    "damaged NetCDF": damage_result,
}


def attack(
    faults: Mapping[str, Callable[[Trial], str]],
    names: Sequence[str],
    chance: random.Random,
    holder: Path,
    count: int,
) -> Iterator[str]:
    """Do faults in turn, each to a command drawn at random; yield what was wrong."""
    undisturbed: dict[str, Trial] = {}
    start = Trial(["branch", "--eta", "2.6", "--limits", "2.6:2.7"], holder / "start", chance)
    if "border" in names:
        start.options += ["--plot", "none", "--store", str(holder / GIVEN)]
        start.run().success()
    for number in range(count):
        name, fault = chance.choice(names), list(faults)[number % len(faults)]
        options = COMMANDS.get(name, QUICK).replace(GIVEN, str(holder / GIVEN)).split()
        if name not in undisturbed:
            begun = time.monotonic()
            undisturbed[name] = Trial(options, holder / name, chance)
            undisturbed[name].run().success()
            undisturbed[name].seconds = time.monotonic() - begun
        whole = undisturbed[name]
        results = whole.commands.results()
        trial = Trial(options, holder / "trial", chance, results, whole.seconds)
        if wrong := faults[fault](trial):
            yield f"fault {number} ({fault}, {name}): {wrong}"
        shutil.rmtree(trial.folder)


@pytest.mark.slow
@pytest.mark.budget(8)  # faults
def test_a_command_that_is_disturbed_gives_the_same_bytes_when_it_is_run_again(
    exported, seed, budget, tmp_path
):
    """It ends, gives up in one line, or says what to remove; nothing else is left behind."""
    names = DRAWN if budget > len(FAULTS) else ("sweep",)
    findings = attack(FAULTS, names, random.Random(seed), tmp_path, budget)
    expect_none(findings, {"faults": budget})
