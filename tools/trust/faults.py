"""Commands that are interrupted, starved and damaged: asked again, they give the same bytes."""

from __future__ import annotations

import ctypes
import os
import random
import resource
import signal
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from .trials import COMMANDS, Disturbances, Trial, format_end, in_a_line

# -- faults ---------------------------------------------------------------------------------------


def killed(trial: Trial) -> str:
    """Kill the command by SIGKILL at random moments, up to three times."""
    for _ in range(trial.chance.randint(1, 3)):
        trial.struck(signal.SIGKILL)
    return trial.goes_on()


def terminated(trial: Trial) -> str:
    """Send SIGTERM at a random moment, go on by the same command; return what is wrong ("")."""
    trial.struck(signal.SIGTERM)
    return trial.goes_on()


def interrupted(trial: Trial) -> str:
    """Press Ctrl-C at a random moment: expect one line and exit code 130."""
    ended = trial.struck(signal.SIGINT)
    if ended.code not in (0, 130, -signal.SIGINT) or (ended.code == 130 and len(ended.lines) > 1):
        return format_end(ended)
    return trial.goes_on()


def full(trial: Trial) -> str:
    """Limit the size of files, as a full disk does."""
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
    """Run in a folder that cannot be written, or is a file: expect one line."""
    if trial.chance.random() < 0.5:
        trial.output.write_text("mine")
        ended = trial.start().wait()
        if ended.code == 0 or in_a_line(ended) or trial.output.read_text() != "mine":
            return format_end(ended)
        trial.output.unlink()
        return trial.goes_on()
    trial.output.mkdir()
    trial.output.chmod(0o555)
    ended = trial.start(as_nobody).wait()
    trial.output.chmod(0o755)
    if ended.code == 0 or in_a_line(ended):
        return format_end(ended)
    return trial.goes_on()


def as_nobody() -> None:
    """Drop root's right to write everywhere (Linux's capabilities 1 and 2)."""
    if os.geteuid() != 0:
        return
    libc = ctypes.CDLL(None, use_errno=True)
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    held = (ctypes.c_uint32 * 6)()
    if libc.capget(header, held) == 0:
        held[0] &= ~0b110
        libc.capset(header, held)


def twice(trial: Trial) -> str:
    """Run the same command twice at once: one computes; the other does too, or says why not."""
    first = trial.start()
    time.sleep(trial.chance.uniform(0.0, 0.5 * trial.seconds))
    second = trial.start()
    ends = first.wait(), second.wait()
    if 0 not in [end.code for end in ends]:
        return " and ".join(map(format_end, ends))
    return in_a_line(ends[0]) or in_a_line(ends[1]) or trial.goes_on()


def damaged_journal(trial: Trial) -> str:
    """Change bytes of the journal: expect a new computation, or an error with its remedy."""
    trial.struck(signal.SIGKILL)
    journals = sorted(trial.output.glob("*.journal*")) if trial.output.exists() else []
    for path in journals:
        spoil(path, trial.chance)
    ended = trial.start().wait()
    if ended.code:
        if in_a_line(ended):
            return format_end(ended)
        for path in trial.output.glob("*.journal*"):
            path.unlink()  # the remedy
    return trial.goes_on()


def damaged_result(trial: Trial) -> str:
    """Change bytes of a finished result: expect the same numbers, or an error with its remedy."""
    trial.start().wait()
    for path in trial.output.glob("*.nc"):
        spoil(path, trial.chance)
    ended = trial.start().wait()
    if in_a_line(ended):
        return format_end(ended)
    if ended.code == 0 and not same_content(trial):
        return "a damaged result is taken as it is"
    for path in trial.output.glob("*.nc"):
        path.unlink()
    return trial.goes_on()


def same_content(trial: Trial) -> bool:
    """Return whether results on disk hold the expected numbers."""
    import xarray as xr

    other = trial.folder / "expected.nc"
    for name, data in trial.expected.items():
        other.write_bytes(data)
        with xr.open_dataset(trial.output / name) as here, xr.open_dataset(other) as there:
            if not here.identical(there):
                return False
    return True


def spoil(path: Path, chance: random.Random) -> None:
    """Damage a file: flip a bit, cut off the end, or write noise over a part."""
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


class Faults(Disturbances):
    """Campaign: faults of a single command."""

    name = "faults"
    title = "Faults"
    asks = (
        "kill -9 (up to three times), SIGTERM, Ctrl-C at any moment, a disk that is full at any "
        "byte, a folder that cannot be written, the same command twice at once, journals and "
        "NetCDF files with bits flipped, cut off or overwritten; in turn for "
        f"{', '.join(COMMANDS)}, each at random and paper, which takes longest, less often. The "
        "command ends, gives up in one line, or says what to remove; and the same command then "
        "ends well, with the bytes of one that nothing happened to, and leaves nothing else "
        "behind. A damaged NetCDF file is named, or its numbers are the same."
    )
    target, batch = 1000, 72
    faults = FAULTS
    commands = (*(name for name in COMMANDS for _ in range(3) if name != "paper"), "paper")

    def trials(self, holder: Path) -> AbstractContextManager[Callable[..., Trial]]:
        """Return what makes trials; nothing is needed around them."""
        return nullcontext(Trial)
