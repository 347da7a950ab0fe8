"""Commands killed, starved, damaged: run again, they give the bytes of one left in peace."""

from __future__ import annotations

import ctypes
import os
import random
import resource
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

from .findings import expect_none
from .trials import COMMANDS, Trial, attack, format_end, message_problem

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")


def kill_often(trial: Trial) -> str:
    """Kill the command by SIGKILL up to three times; return what is wrong at the end ("")."""
    for _ in range(trial.chance.randint(1, 3)):
        trial.signal_and_wait(signal.SIGKILL)
    return trial.run_again()


def terminate(trial: Trial) -> str:
    """Send SIGTERM at a random moment, run the command again; return what is wrong ("")."""
    trial.signal_and_wait(signal.SIGTERM)
    return trial.run_again()


def interrupt(trial: Trial) -> str:
    """Send Ctrl-C at a random moment, expect exit code 130; return what is wrong ("")."""
    ended = trial.signal_and_wait(signal.SIGINT)
    if ended.code not in (0, 130, -signal.SIGINT) or (ended.code == 130 and len(ended.lines) > 1):
        return format_end(ended)
    return trial.run_again()


def fill_disk(trial: Trial) -> str:
    """Limit the size of files, as a full disk does; return what is wrong ("")."""
    largest = max(map(len, trial.expected.values()))
    most = trial.chance.randrange(max(largest, 40_000))

    def limit() -> None:
        """Limit the size of files that this process may write."""
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        import orchestrate.access as access

        for model in access.MODELS:  # the FMU is unpacked elsewhere
            access.unpacked.unpacked(access.find(model))
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    wrong = message_problem(trial.start(limit).wait())
    return wrong or trial.run_again()


def forbid_writing(trial: Trial) -> str:
    """Run in a folder that cannot be written, or is a file; return what is wrong ("")."""
    if trial.chance.random() < 0.5:
        trial.output.write_text("mine")
        ended = trial.start().wait()
        if ended.code == 0 or message_problem(ended) or trial.output.read_text() != "mine":
            return format_end(ended)
        trial.output.unlink()
        return trial.run_again()
    trial.output.mkdir()
    trial.output.chmod(0o555)
    ended = trial.start(drop_capabilities).wait()
    trial.output.chmod(0o755)
    if ended.code == 0 or message_problem(ended):
        return format_end(ended)
    return trial.run_again()


def drop_capabilities() -> None:
    """Drop root's right to write everywhere (Linux's capabilities 1 and 2)."""
    if os.geteuid() != 0:
        return
    libc = ctypes.CDLL(None, use_errno=True)
    header = (ctypes.c_uint32 * 2)(0x20080522, 0)
    held = (ctypes.c_uint32 * 6)()
    if libc.capget(header, held) == 0:
        held[0] &= ~0b110
        libc.capset(header, held)


def run_twice_at_once(trial: Trial) -> str:
    """Run the same command twice at once; return what is wrong ("")."""
    first = trial.start()
    time.sleep(trial.chance.uniform(0.0, 0.5 * trial.seconds))
    second = trial.start()
    ends = first.wait(), second.wait()
    if 0 not in [end.code for end in ends]:
        return " and ".join(map(format_end, ends))
    return message_problem(ends[0]) or message_problem(ends[1]) or trial.run_again()


def damage_journal(trial: Trial) -> str:
    """Change bytes of the journal, run the command again; return what is wrong ("")."""
    trial.signal_and_wait(signal.SIGKILL)
    journals = sorted(trial.output.glob("*.journal*")) if trial.output.exists() else []
    for path in journals:
        spoil_file(path, trial.chance)
    ended = trial.start().wait()
    if ended.code:
        if message_problem(ended):
            return format_end(ended)
        for path in trial.output.glob("*.journal*"):
            path.unlink()  # the remedy
    return trial.run_again()


def damage_result(trial: Trial) -> str:
    """Change bytes of a finished result, run again; return what is wrong ("")."""
    trial.start().wait()
    for path in trial.output.glob("*.nc"):
        spoil_file(path, trial.chance)
    ended = trial.start().wait()
    if message_problem(ended):
        return format_end(ended)
    if ended.code == 0 and not has_same_numbers(trial):
        return "a damaged result is taken as it is"
    for path in trial.output.glob("*.nc"):
        path.unlink()
    return trial.run_again()


def has_same_numbers(trial: Trial) -> bool:
    """Return whether results on disk hold the expected numbers."""
    other = trial.folder / "expected.nc"
    for name, data in trial.expected.items():
        other.write_bytes(data)
        with xr.open_dataset(trial.output / name) as here, xr.open_dataset(other) as there:
            if not here.identical(there):
                return False
    return True


def spoil_file(path: Path, chance: random.Random) -> None:
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
    "kill -9": kill_often,
    "SIGTERM": terminate,
    "Ctrl-C": interrupt,
    "full disk": fill_disk,
    "read-only": forbid_writing,
    "two at once": run_twice_at_once,
    "damaged journal": damage_journal,
    "damaged NetCDF": damage_result,
}


COMMANDS_DRAWN = (*(name for name in COMMANDS for _ in range(3) if name != "paper"), "paper")


@pytest.mark.slow
@pytest.mark.budget(8)  # faults
def test_a_command_that_is_disturbed_gives_the_same_bytes_when_it_is_run_again(
    exported, seed, budget, tmp_path
):
    """It ends, gives up in one line, or says what to remove; nothing else is left behind."""
    commands = COMMANDS_DRAWN if budget > len(FAULTS) else ("sweep",)
    parts = (FAULTS, commands, Trial, random.Random(seed), tmp_path, budget)
    expect_none(attack(*parts), {"faults": budget})
