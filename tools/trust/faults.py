"""Commands that are interrupted, starved and damaged: asked again, they give the same bytes."""

from __future__ import annotations

import ctypes
import os
import random
import resource
import shutil
import signal
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .campaign import Campaign, Outcome
from .children import Child, Ended, import_all

PLAIN = ("--plot", "none", "--jobs", "1")
ALONG = ("--eta", "1.1:1.16:0.002")
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
    "branch": ("branch", "--eta", "2.5", "--limits", "2.45:2.55", *PLAIN),
    "couple": (
        *("couple", "--only", "delaminated", "--eta0", "1.4:1.404", "--rate", "2e-5"),
        *("--one-way", *PLAIN),
    ),
}
EXTRA = (".png", ".nc")


@dataclass
class Trial:
    """One fault of one command.

    Attributes
    ----------
    name : str
        Of the command.
    folder : Path
        Its results are in ``results`` below it.
    expected : dict of str to bytes
        Results of the command where nothing happens.
    seconds : float
        That it takes then.
    chance : random.Random
    """

    name: str
    folder: Path
    expected: dict[str, bytes]
    seconds: float
    chance: random.Random

    @property
    def output(self) -> Path:
        """Where the results go."""
        return self.folder / "results"

    def start(self, prepare: Callable[[], object] | None = None) -> Child:
        """The command under way."""
        arguments = [*COMMANDS[self.name], "--output", str(self.output)]
        return Child(arguments, self.folder / "temporary", prepare)

    def wait_a_moment(self) -> None:
        """Any moment of the command."""
        time.sleep(self.chance.uniform(0.0, self.seconds))

    def goes_on(self) -> str:
        """See that the same command ends well with the same bytes; else what is wrong."""
        ended = self.start().wait()
        if ended.code:
            return f"the same command again: {told(ended)}"
        if results(self.output) != self.expected:
            return "other bytes"
        left = [p.name for p in self.output.iterdir() if not p.name.endswith(EXTRA)]
        return f"left behind: {', '.join(left)}" if left else ""


def told(ended: Ended) -> str:
    """How a command ended, in a line."""
    return f"exit code {ended.code}: {' / '.join(ended.lines)[:300]}"


def results(folder: Path) -> dict[str, bytes]:
    """Bytes of the NetCDF files by name."""
    return {path.name: path.read_bytes() for path in sorted(folder.glob("*.nc"))}


def in_a_line(ended: Ended) -> str:
    """What is wrong with how a command gave up; empty where it did not, or in one line."""
    if ended.code == 0 or (ended.code > 0 and len(ended.lines) == 1):
        return ""
    return told(ended)


# -- faults ---------------------------------------------------------------------------------------


def killed(trial: Trial) -> str:
    """kill -9 at any moment, up to three times."""
    for _ in range(trial.chance.randint(1, 3)):
        child = trial.start()
        trial.wait_a_moment()
        child.send(signal.SIGKILL)
        child.wait()
    return trial.goes_on()


def terminated(trial: Trial) -> str:
    """SIGTERM at any moment."""
    child = trial.start()
    trial.wait_a_moment()
    child.send(signal.SIGTERM)
    child.wait()
    return trial.goes_on()


def interrupted(trial: Trial) -> str:
    """Ctrl-C at any moment: a line, and exit code 130."""
    child = trial.start()
    trial.wait_a_moment()
    child.send(signal.SIGINT)
    ended = child.wait()
    if ended.code not in (0, 130, -signal.SIGINT) or (ended.code == 130 and len(ended.lines) > 1):
        return told(ended)
    return trial.goes_on()


def full(trial: Trial) -> str:
    """No file may grow beyond a size: a disk that is full."""
    largest = max(map(len, trial.expected.values()))
    most = trial.chance.randrange(max(largest, 40_000))

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        import orchestrate.access as access

        for model in access.MODELS:  # the FMU is unpacked elsewhere
            access.unpacked.unpacked(access.find(model))
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    wrong = in_a_line(trial.start(limit).wait())
    return wrong or trial.goes_on()


def read_only(trial: Trial) -> str:
    """A folder that cannot be written: one line; a place that is a file where no folder can be."""
    if trial.chance.random() < 0.5:
        trial.output.write_text("mine")
        ended = trial.start().wait()
        if ended.code == 0 or in_a_line(ended) or trial.output.read_text() != "mine":
            return told(ended)
        trial.output.unlink()
        return trial.goes_on()
    trial.output.mkdir()
    trial.output.chmod(0o555)
    ended = trial.start(as_nobody).wait()
    trial.output.chmod(0o755)
    if ended.code == 0 or in_a_line(ended):
        return told(ended)
    return trial.goes_on()


def as_nobody() -> None:
    """Root may write everywhere: give up that right (Linux's capabilities 1 and 2)."""
    if os.geteuid() != 0:
        return
    libc = ctypes.CDLL(None, use_errno=True)
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    held = (ctypes.c_uint32 * 6)()
    if libc.capget(header, held) == 0:
        held[0] &= ~0b110
        libc.capset(header, held)


def twice(trial: Trial) -> str:
    """The same command two times at once: one computes; the other does too, or says why not."""
    first = trial.start()
    time.sleep(trial.chance.uniform(0.0, 0.5 * trial.seconds))
    second = trial.start()
    ends = first.wait(), second.wait()
    if 0 not in [end.code for end in ends]:
        return " and ".join(map(told, ends))
    return in_a_line(ends[0]) or in_a_line(ends[1]) or trial.goes_on()


def damaged_journal(trial: Trial) -> str:
    """Bytes of what was kept are changed: it is computed anew, or named with its remedy."""
    child = trial.start()
    trial.wait_a_moment()
    child.send(signal.SIGKILL)
    child.wait()
    journals = sorted(trial.output.glob("*.journal*")) if trial.output.exists() else []
    for path in journals:
        spoil(path, trial.chance)
    ended = trial.start().wait()
    if ended.code:
        if in_a_line(ended):
            return told(ended)
        for path in trial.output.glob("*.journal*"):
            path.unlink()  # the remedy
    return trial.goes_on()


def damaged_result(trial: Trial) -> str:
    """Bytes of a finished result are changed: it is the same still, or named with its remedy."""
    trial.start().wait()
    for path in trial.output.glob("*.nc"):
        spoil(path, trial.chance)
    ended = trial.start().wait()
    if in_a_line(ended):
        return told(ended)
    if ended.code == 0 and not same_content(trial):
        return "a damaged result is taken as it is"
    for path in trial.output.glob("*.nc"):
        path.unlink()
    return trial.goes_on()


def same_content(trial: Trial) -> bool:
    """Whether results on disk hold the numbers that they should."""
    import xarray as xr

    other = trial.folder / "expected.nc"
    for name, data in trial.expected.items():
        other.write_bytes(data)
        with xr.open_dataset(trial.output / name) as here, xr.open_dataset(other) as there:
            if not here.identical(there):
                return False
    return True


def spoil(path: Path, chance: random.Random) -> None:
    """Flip a bit, cut off the end, or write noise over a part."""
    data = bytearray(path.read_bytes())
    if not data:
        return
    kind, place = chance.randrange(3), chance.randrange(len(data))
    if kind == 0:
        data[place] ^= 1 << chance.randrange(8)
    elif kind == 1:
        del data[place:]
    else:
        noise = chance.randbytes(chance.randint(1, 500))
        data[place : place + len(noise)] = noise
    path.write_bytes(data)


FAULTS: dict[str, Callable[[Trial], str]] = {
    "kill -9": killed,
    "SIGTERM": terminated,
    "Ctrl-C": interrupted,
    "full disk": full,
    "read-only": read_only,
    "two at once": twice,
    "damaged journal": damaged_journal,
    "damaged NetCDF": damaged_result,
}


class Faults(Campaign):
    """Everything that may happen to a command."""

    name = "faults"
    title = "Faults"
    asks = (
        "kill -9 (up to three times), SIGTERM, Ctrl-C at any moment, a disk that is full at any "
        "byte, a folder that cannot be written, the same command twice at once, journals and "
        f"NetCDF files with bits flipped, cut off or overwritten; in turn for "
        f"{', '.join(COMMANDS)}. The command ends, gives up in one line, or says what to remove; "
        "and the same command then ends well, with the bytes of one that nothing happened to, and "
        "leaves nothing else behind. A damaged NetCDF file is named, or its numbers are the same."
    )
    unit, target, batch = "faults", 1000, 72
    package = True

    def run(self, fmu: Path, seed: int, count: int) -> Outcome:
        """One fault after the other."""
        import_all()
        chance, counts, notes = random.Random(seed), dict.fromkeys(FAULTS, 0), []
        known: dict[str, tuple[dict[str, bytes], float]] = {}
        with tempfile.TemporaryDirectory(prefix="vibroimpact-trust-") as holder:
            for number in range(count):
                name = chance.choice(list(COMMANDS))
                fault = list(FAULTS)[number % len(FAULTS)]
                folder = Path(holder) / "trial"
                if name not in known:
                    known[name] = undisturbed(name, Path(holder) / "undisturbed")
                folder.mkdir()
                wrong = FAULTS[fault](Trial(name, folder, *known[name], chance))
                counts[fault] += 1
                if wrong:
                    notes.append(f"seed {seed}, fault {number} ({fault}, {name}): {wrong}")
                shutil.rmtree(folder, ignore_errors=True)
        named = {f"{name}:": value for name, value in counts.items()}
        return Outcome(count, len(notes), counts=named, notes=tuple(notes))


def undisturbed(name: str, folder: Path) -> tuple[dict[str, bytes], float]:
    """Results of a command to which nothing happens, and how long it takes."""
    ended = Trial(name, folder, {}, 0.0, random.Random()).start().wait(600.0)
    found = results(folder / "results")
    assert ended.code == 0 and found, f"{name}: {told(ended)}"
    shutil.rmtree(folder)
    return found, ended.seconds
