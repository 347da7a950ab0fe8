"""Malicious input: refused in one line, nothing written elsewhere, in little time and memory."""

from __future__ import annotations

import random
import shutil
import tempfile
from pathlib import Path

from . import archives, documents
from .campaign import Campaign, Outcome
from .children import Child, Ended, import_all, in_little_memory

SLOW = 30.0  # s
LONG = 2000  # letters of a line that a person reads


class Hostile(Campaign):
    """Input that somebody has made to do harm."""

    name = "hostile"
    title = "Malicious input"
    asks = (
        "FMU archives with paths that lead out, links, bombs, crowds of files, entities that grow "
        "or read other files, names that are paths or markup, two files of one name; TOML that is "
        "nested, huge or full of control characters; NetCDF cut short, forged, with dimensions of "
        "terabytes or attributes that are markup. Each is refused in one line that begins with "
        "`error:`, with an exit code, without a traceback, within 30 s and 2 GiB, and nothing is "
        "written outside of the temporary folder; or it is taken, where it does no harm. "
        "No command reads CSV."
    )
    unit, target, batch = "inputs", 1000, 50
    package = True

    def run(self, fmu: Path, seed: int, count: int) -> Outcome:
        """Hand it to the commands."""
        from orchestrate.access import MODELS
        from orchestrate.access.webassembly import web_kernel

        import_all()
        for model in MODELS:
            web_kernel(model)  # or the first page would compile it
        chance, counts, notes = random.Random(seed), {"refused:": 0, "taken:": 0}, []
        with tempfile.TemporaryDirectory(prefix="vibroimpact-trust-") as holder:
            folder = Path(holder)
            good = good_result(folder)
            for number in range(count):
                kind, arguments = prepare(folder, fmu, good, chance, number)
                ended, strays = hand(arguments, folder)
                reason = verdict(ended, strays)
                if reason:
                    notes.append(f"seed {seed}, input {number} ({kind}): {reason}")
                counts["taken:" if ended.code == 0 else "refused:"] += 1
        return Outcome(count, len(notes), counts=counts, notes=tuple(notes))


def good_result(folder: Path) -> Path:
    """A result to be damaged."""
    import orchestrate

    place = folder / "good.nc"
    structure = orchestrate.Structure.nondimensional()
    orchestrate.sweep(
        structure, eta=[1.0, 1.1], transient=2, samples=4, store=place, jobs=1, progress=False
    )
    return place


def prepare(
    folder: Path, fmu: Path, good: Path, chance: random.Random, number: int
) -> tuple[str, list[str]]:
    """An input's kind, and the command that reads it."""
    turn = number % 4
    if turn in (0, 1):
        kind = list(archives.KINDS)[(number // 2) % len(archives.KINDS)]
        place = folder / "input.fmu"
        place.unlink(missing_ok=True)
        archives.KINDS[kind](fmu, place, chance)
        command = ["simulate", "--eta", "1", "--periods", "2", "--plot", "none"]
        return kind, [*command, "--output", str(folder / "results"), "--fmu", str(place)]
    if turn == 2:
        place = folder / "input.toml"
        documents.toml(place, chance)
        command = ["simulate", "--eta", "1", "--periods", "2", "--plot", "none"]
        return "TOML", [*command, "--output", str(folder / "results"), "--structure", str(place)]
    reader = chance.choice(list(documents.READERS))
    place = folder / "input.nc"
    place.unlink(missing_ok=True)
    documents.result(place, chance, good)
    output = folder / ("page.html" if reader in ("explore", "branches") else "results")
    command = [*documents.READERS[reader](place), "--output", str(output)]
    return f"NetCDF for {reader}", command


def hand(arguments: list[str], folder: Path) -> tuple[Ended, list[str]]:
    """Run the command; how it ended, and what it wrote where it should not."""
    temporary = folder / "temporary"
    before = {path for path in outside(folder) if path.exists()}
    ended = Child(arguments, temporary, in_little_memory).wait(2.0 * SLOW)
    strays = [str(path) for path in outside(folder) if path.exists() and path not in before]
    left = [path.name for path in temporary.iterdir()] if temporary.exists() else []
    page = folder / "page.html"
    if page.exists() and "<script>alert(1)" in page.read_text("utf-8", "replace"):
        left.append("markup in the page")
    page.unlink(missing_ok=True)
    shutil.rmtree(temporary, ignore_errors=True)
    shutil.rmtree(folder / "results", ignore_errors=True)
    return ended, strays + left


def outside(folder: Path) -> list[Path]:
    """Where a file of the attacks would show, had it escaped."""
    places = (Path("/"), Path("/tmp"), *folder.parents, folder, Path.cwd(), *Path.cwd().parents)
    return [place / "escaped" for place in dict.fromkeys(places)]


def verdict(ended: Ended, strays: list[str]) -> str:
    """What is wrong with how a command ended; empty where nothing is."""
    if strays:
        return f"left {', '.join(strays)}"
    if ended.seconds > SLOW:
        return f"took {ended.seconds:.0f} s"
    if ended.code < 0:
        return f"ended by signal {-ended.code}"
    if "Traceback" in "".join(line for line in ended.lines if line.startswith("Traceback")):
        return f"a traceback: {ended.lines[-1][:200]}"
    if ended.code == 0:
        return ""
    errors = [line for line in ended.lines if line.startswith("error: ")]
    if len(errors) != 1:  # beside it may stand what the command has to say of itself
        return f"{len(ended.lines)} lines: {' / '.join(ended.lines)[:300]}"
    if len(errors[0]) > LONG or not errors[0].isprintable():
        return f"not a line that people read: {errors[0][:200]!r}"
    return ""
