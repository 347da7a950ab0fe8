"""Malicious input: refused in one line, without harm, in little time and memory."""

from __future__ import annotations

import random
import shutil
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

import orchestrate
from orchestrate.access import MODELS
from orchestrate.access.webassembly import web_kernel
from orchestrate.running.store import load

from . import archives, documents, forged_results
from .children import ChildCommand, FinishedCommand, import_all, limit_memory
from .findings import expect_none
from .forged_results import BrowserWindow

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")

SLOW = 30.0  # s
WRONG = 0.2  # of the forged results have numbers that make no sense too
LONG = 2000  # letters of a line that a person reads


def make_good_results(folder: Path) -> tuple[Path, Path]:
    """Compute a sweep and a branch, to be damaged and forged; return their paths."""
    places = folder / "good.nc", folder / "branch.nc"
    structure, usual = orchestrate.Structure.nondimensional(), {"jobs": 1, "progress": False}
    orchestrate.sweep(structure, eta=[1.0, 1.1], transient=2, samples=4, store=places[0], **usual)
    start = orchestrate.orbit(structure, eta=2.6, **usual)
    orchestrate.branch(structure, start=start, limits=(2.45, 2.62), store=places[1], **usual)
    return places


def open_forged_page(
    folder: Path, good: Path, branch: Path, chance: random.Random, seen: BrowserWindow
) -> tuple[FinishedCommand, str]:
    """Forge a result, make a page of it and open that; return the end, and what is wrong."""
    result, branches, page = (folder / name for name in ("f.nc", "b.nc", "page.html"))
    forged_results.write_forged_sweep(result, chance, load(good), seen.address)
    wrong = chance.random() < WRONG
    if wrong:
        forged_results.write_wrong_number(result, chance)
    command = ["explore", str(result), "--no-open", "--output", str(page)]
    if chance.random() < 0.3:
        forged_results.write_forged_branch(branches, chance, load(branch), seen.address)
        command += ["--branches", str(branches)]
    ended = ChildCommand(command, folder / "temporary", limit_memory).wait(2.0 * SLOW)
    reason = find_problem(ended, [])
    if not reason:
        fragment = forged_results.hostile_fragment(chance, seen.address)
        made = ended.code == 0
        lost = "" if wrong else f"no page: {' / '.join(ended.lines)[:200]}"
        reason = seen.check_page(page, fragment) if made else lost
    forged_results.delete_files(result, branches, page)
    return ended, reason


def write_attack(
    folder: Path, fmu: Path, good: Path, chance: random.Random, number: int
) -> tuple[str, list[str]]:
    """Write a hostile input; return its kind, and the command that reads it."""
    turn = number % 4
    if turn in (0, 1):
        kind = list(archives.KINDS)[(number // 2) % len(archives.KINDS)]
        path = folder / "input.fmu"
        path.unlink(missing_ok=True)
        archives.KINDS[kind](fmu, path, chance)
        command = ["simulate", "--eta", "1", "--periods", "2", "--plot", "none"]
        return kind, [*command, "--output", str(folder / "results"), "--fmu", str(path)]
    if turn == 2 and number % 8 == 2:
        path = folder / "input.csv"
        documents.write_course(path, chance)
        command = ["couple", "--only", "delaminated", "--one-way", "--plot", "none"]
        return "CSV", [*command, "--output", str(folder / "results"), "--course", str(path)]
    if turn == 2:
        path = folder / "input.toml"
        documents.write_toml(path, chance)
        command = ["simulate", "--eta", "1", "--periods", "2", "--plot", "none"]
        return "TOML", [*command, "--output", str(folder / "results"), "--structure", str(path)]
    reader = chance.choice(list(documents.READERS))
    path = folder / "input.nc"
    path.unlink(missing_ok=True)
    documents.write_result(path, chance, good)
    output = folder / ("page.html" if reader in ("explore", "branches") else "results")
    command = [*documents.READERS[reader](path), "--output", str(output)]
    return f"NetCDF for {reader}", command


def run_on_attack(arguments: list[str], folder: Path) -> tuple[FinishedCommand, list[str]]:
    """Run a command on hostile input; return its exit, and files written outside its folder."""
    temporary = folder / "temporary"
    before = {path for path in escaped_paths(folder) if path.exists()}
    ended = ChildCommand(arguments, temporary, limit_memory).wait(2.0 * SLOW)
    strays = [str(path) for path in escaped_paths(folder) if path.exists() and path not in before]
    left = [path.name for path in temporary.iterdir()] if temporary.exists() else []
    forged_results.delete_files(folder / "page.html")
    shutil.rmtree(temporary, ignore_errors=True)
    shutil.rmtree(folder / "results", ignore_errors=True)
    return ended, strays + left


def escaped_paths(folder: Path) -> list[Path]:
    """Return the paths where an escaped file of the attacks would be."""
    places = (Path("/"), Path("/tmp"), *folder.parents, folder, Path.cwd(), *Path.cwd().parents)
    return [folder_above / "escaped" for folder_above in dict.fromkeys(places)]


def find_problem(ended: FinishedCommand, strays: list[str]) -> str:
    """Return what is wrong with how a command ended; empty where nothing is."""
    if strays:
        return f"left {', '.join(strays)}"
    if ended.seconds > SLOW:
        return f"took {ended.seconds:.0f} s"
    if ended.code < 0:
        return f"ended by signal {-ended.code}"
    if any(line.startswith("Traceback") for line in ended.lines):
        return f"a traceback: {ended.lines[-1][:200]}"
    if ended.code == 0:
        return ""
    errors = [line for line in ended.lines if line.startswith("error: ")]
    if len(errors) != 1:  # beside it may stand what the command has to say of itself
        return f"{len(ended.lines)} lines: {' / '.join(ended.lines)[:300]}"
    if len(errors[0]) > LONG or not errors[0].isprintable():
        return f"not a line that people read: {errors[0][:200]!r}"
    return ""


@pytest.fixture(scope="module")
def browser() -> Iterator[BrowserWindow]:
    """Headless Chromium, with a server that no page may request anything from."""
    if not (shutil.which("chromium") and shutil.which("chromedriver")):
        pytest.skip("no chromium with chromedriver here")
    with forged_results.open_browser() as window:
        yield window


@pytest.mark.slow
@pytest.mark.budget(16)  # inputs
def test_malicious_input_is_refused_in_one_line_or_does_no_harm(
    fmu, browser, seed, budget, tmp_path
):
    """FMU archives, TOML, CSV, NetCDF; every second input is a result whose texts are markup.

    Refused within 30 s and 2 GiB without a traceback, and nothing is written elsewhere; a page that
    is made of a file works in Chromium, runs no script of the file and asks no address in it.
    """
    import_all()
    for model in MODELS:
        web_kernel(model)  # or the first page would compile it
    chance, findings, counts = random.Random(seed), [], Counter[str]()
    good, branch = make_good_results(tmp_path)
    for number in range(budget):
        if number % 2:
            kind = "page"
            ended, reason = open_forged_page(tmp_path, good, branch, chance, browser)
        else:
            kind, arguments = write_attack(tmp_path, fmu, good, chance, number // 2)
            ended, strays = run_on_attack(arguments, tmp_path)
            reason = find_problem(ended, strays)
        counts[f"{kind} {'refused' if ended.code else 'taken'}"] += 1
        findings += [f"input {number} ({kind}): {reason}"] if reason else []
    expect_none(findings, counts)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("<script>window.explorer = {}</script>", ""),
        ("<script>window.explorer = {}; window.canary = 1</script>", "a script of the file ran"),
        ("<script>window.explorer = {}; alert(1)</script>", "the browser: unexpected alert"),
        ("<script>window.explorer = {}</script><img src=ADDRESS>", "the page asked /canary"),
    ],
)
def test_a_script_that_ran_would_be_seen(browser, tmp_path, body, expected):
    page = tmp_path / "page.html"
    page.write_text(f"<!doctype html>{body}".replace("ADDRESS", browser.address))
    verdict = browser.check_page(page)
    assert verdict.startswith(expected) and bool(verdict) == bool(expected)
