"""Malicious input: refused in one line, without harm, in little time and memory."""

import json
import random
import shutil
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest

import orchestrate
from tests import ROOT
from tests.faults import FILE_DAMAGE, Surroundings
from tests.orchestrate.cli.commands import Done

from . import archives
from .findings import expect_none

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")
SLOW, MEMORY = 30.0, 4 << 30  # s, bytes
LONG = 2000  # letters of a line that a person reads
SIMULATE = ("simulate", "--eta", "1", "--periods", "2", "--plot", "none")
READERS = (
    "sweep --eta 1 --store {}",
    "explore {} --no-open",
    "explore --branches {} --no-open",
    "branch --start {} --limits 0.9:1.1",
    "border --start {} --limits 1:2,0.1:0.9",
)
MARKUP = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
LINES = "one\ntwo\r\nTraceback (most recent call last):\x1b[2J"


def write_result(place: Path, chance: random.Random, good: Path) -> None:
    """Write a result file that is damaged, or has content that no result has."""
    if chance.random() < 0.4:
        place.write_bytes(good.read_bytes())
        chance.choice(list(FILE_DAMAGE.values()))(place, chance)
        return
    import netCDF4

    kind = chance.randrange(7)
    identities = ("[" * 100_000, LINES, json.dumps({"question": LINES, "fmu": 5}))
    with netCDF4.Dataset(place, "w") as file:
        file.createDimension("n", 10**12 if kind == 0 else 3)
        if kind == 0:  # terabytes that are not there
            file.createVariable("xi_rel", "f8", ("n",), chunksizes=(1 << 16,), zlib=True)
            return
        file.createVariable("xi_rel", "f8", ("n",))[:] = 1.0
        if kind <= len(identities):
            file.setncattr("identity", identities[kind - 1])
        elif kind == 4:
            file.setncattr("over", chance.choice((LINES, "eta")))
        elif kind == 5:
            file.createVariable("x" + MARKUP.replace("/", "|"), "f8", ("n",))
            file.setncattr("call", MARKUP)
        else:
            file["xi_rel"].setncattr("scale_factor", "x")
            file["xi_rel"].setncattr("units", "days since 0000-99-99")


def run_limited(command: Sequence[object], folder: Path) -> tuple[Done, str]:
    """Run a command with little memory; return its end, and what is wrong with that ("")."""
    places = (Path("/"), Path("/tmp"), *folder.parents, folder, ROOT, *ROOT.parents)
    escaped = [place / "escaped" for place in dict.fromkeys(places)]
    assert not any(path.exists() for path in escaped)
    temporary, begun = folder / "temporary", time.monotonic()
    temporary.mkdir()
    words = [sys.executable, "-m", "orchestrate", *map(str, command)]
    ended = Surroundings(memory=MEMORY).run(words, ROOT, 20.0 * SLOW, TMPDIR=str(temporary))
    seconds = time.monotonic() - begun
    strays = [path for path in (*escaped, *temporary.iterdir()) if path.exists()]
    shutil.rmtree(temporary)
    done = Done(ended.returncode, ended.stdout, ended.stderr)
    if strays or seconds > SLOW:
        return done, f"left {strays}, took {seconds:.0f} s"
    return done, find_problem(done)


def find_problem(done: Done) -> str:
    """Return what is wrong with how a command ended; empty where nothing is."""
    if done.code < 0 or "Traceback (most recent call last):\n  File" in done.err:
        return f"exit code {done.code}, a traceback: {done.complaints[-1:]}"
    errors = [line for line in done.complaints if line.startswith("error: ")]
    if done.code and len(errors) != 1:  # beside it may stand what the command has to say of itself
        return f"{len(done.complaints)} lines: {' / '.join(done.complaints)[:300]}"
    if done.code and (len(errors[0]) > LONG or not errors[0].isprintable()):
        return f"not a line that people read: {errors[0][:200]!r}"
    return ""


def attack_reader(
    folder: Path, fmu: Path, good: Path, chance: random.Random, number: int
) -> tuple[str, str]:
    """Write a hostile file and run a command that reads it; return its fate and problem."""
    output = ["--output", folder / "results"]
    place = folder / "input"
    if number % 2 == 0:
        kind = archives.KINDS[number // 2 % len(archives.KINDS)]
        archives.write(kind, fmu, place, chance)
        command = [*SIMULATE, "--fmu", place]
    else:
        reader = chance.choice(READERS)
        kind = f"NetCDF for {reader.split()[0]}"
        write_result(place, chance, good)
        command = reader.format(place).split()
        output[1] = folder / ("page.html" if "explore" in reader else "results")
    done, problem = run_limited([*command, *output], folder)
    return f"{kind} {'refused' if done.code else 'taken'}", problem


@pytest.mark.slow
@pytest.mark.budget(16)  # inputs
def test_malicious_input_is_refused_in_one_line_or_does_no_harm(fmu, seed, budget, tmp_path):
    """FMU archives and NetCDF: refused within 30 s and 4 GiB without a traceback, and
    nothing is written elsewhere.
    """
    chance, findings, counts = random.Random(seed), [], Counter[str]()
    good, structure = tmp_path / "good.nc", orchestrate.Structure.nondimensional()
    usual = {"jobs": 1, "progress": False}
    orchestrate.sweep(structure, eta=[1.0, 1.1], transient=2, samples=4, store=good, **usual)
    for number in range(budget):
        folder = tmp_path / "trial"
        folder.mkdir()
        fate, problem = attack_reader(folder, fmu, good, chance, number)
        shutil.rmtree(folder)
        counts[fate] += 1
        findings += [f"input {number} ({fate}): {problem}"] if problem else []
    expect_none(findings, counts)
