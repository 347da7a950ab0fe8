"""Malicious input: refused in one line, without harm, in little time and memory."""

import http.server
import random
import shutil
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

import orchestrate
from orchestrate.running.store import load
from tests.chromium import start_chromium
from tests.faults import Surroundings
from tests.orchestrate.cli.commands import ROOT, Done

from . import archives, documents
from .findings import expect_none

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")
SLOW, MEMORY = 30.0, 4 << 30  # s, bytes
WRONG = 0.2  # of the forged results have numbers that make no sense too
LONG = 2000  # letters of a line that a person reads
CALM = 0.15  # s that a script has for running
READY = "return Boolean(window.explorer)"
SIMULATE = ("simulate", "--eta", "1", "--periods", "2", "--plot", "none")
COUPLE = ("couple", "--only", "delaminated", "--one-way", "--plot", "none")
READERS = (
    "sweep --eta 1 --store {}",
    "explore {} --no-open",
    "explore --branches {} --no-open",
    "branch --start {} --limits 0.9:1.1",
    "border --start {} --limits 1:2,0.1:0.9",
)


class BrowserWindow:
    """Headless Chromium with a server that no page may request anything from."""

    def __init__(self, driver: Any, address: str, asked: list[str]) -> None:
        """Store the browser's driver and the record of requests."""
        self.driver, self.address, self.asked = driver, address, asked

    def check_page(self, page: Path, fragment: str = "") -> str:
        """Open a page; return what is wrong with it, empty if no script of the file ran."""
        from selenium.common.exceptions import WebDriverException
        from selenium.webdriver.support.ui import WebDriverWait

        self.asked.clear()
        try:
            self.driver.get("about:blank")
            self.driver.get(page.as_uri() + fragment)
            WebDriverWait(self.driver, 30.0, 0.02).until(lambda one: one.execute_script(READY))
            time.sleep(CALM)
            ran = "return window.canary || document.title === 'canary'"
            if self.driver.execute_script(ran):
                return "a script of the file ran"
        except WebDriverException as error:  # a dialog of the canary, or a page that is broken
            return f"the browser: {(error.msg or type(error).__name__).splitlines()[0]}"
        return f"the page asked {self.asked[0]}" if self.asked else ""


@pytest.fixture(scope="module")
def browser(tmp_path_factory) -> Iterator[BrowserWindow]:
    """Chromium, and the server at the address that hostile texts name."""
    programs = shutil.which("chromium"), shutil.which("chromedriver")
    if None in programs:
        pytest.skip("no chromium with chromedriver here")
    asked: list[str] = []

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked.append(self.path)
            self.send_response(204)
            self.end_headers()

        def log_message(self, *arguments: object) -> None:
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        driver = start_chromium(*programs, tmp_path_factory.mktemp("chromium"))
        yield BrowserWindow(driver, f"http://127.0.0.1:{server.server_port}/canary", asked)
        driver.quit()
        server.shutdown()


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


def attack_page(
    folder: Path, good: tuple[Path, Path], chance: random.Random, browser: BrowserWindow
) -> tuple[str, str]:
    """Forge a result, make a page of it and open that; return the input's fate and problem."""
    result, branches, page = (folder / name for name in ("f.nc", "b.nc", "page.html"))
    wrong, sweep, branch = chance.random() < WRONG, *map(load, good)
    documents.write_forged_sweep(result, chance, sweep, browser.address, wrong)
    command = ["explore", result, "--no-open", "--output", page]
    if chance.random() < 0.3:
        documents.write_forged_branch(branches, chance, branch, browser.address)
        command += ["--branches", branches]
    done, problem = run_limited(command, folder)
    if not problem and done.code == 0:
        fragment = documents.hostile_fragment(chance, browser.address)
        problem = browser.check_page(page, fragment)
    if done.code and not wrong:
        problem = problem or f"no page: {' / '.join(done.complaints)[:200]}"
    return f"page {'refused' if done.code else 'made'}", problem


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
    elif number % 8 == 1:
        kind = "CSV"
        documents.write_course(place, chance)
        command = [*COUPLE, "--course", place]
    elif number % 8 == 5:
        kind = "TOML"
        documents.write_toml(place, chance)
        command = [*SIMULATE, "--structure", place]
    else:
        reader = chance.choice(READERS)
        kind = f"NetCDF for {reader.split()[0]}"
        documents.write_result(place, chance, good)
        command = reader.format(place).split()
        output[1] = folder / ("page.html" if "explore" in reader else "results")
    done, problem = run_limited([*command, *output], folder)
    return f"{kind} {'refused' if done.code else 'taken'}", problem


@pytest.mark.slow
@pytest.mark.budget(16)  # inputs
def test_malicious_input_is_refused_in_one_line_or_does_no_harm(
    fmu, browser, seed, budget, tmp_path
):
    """FMU archives, TOML, CSV, NetCDF; every second input is a result whose texts are markup.

    Refused within 30 s and 4 GiB without a traceback, and nothing is written elsewhere; a page that
    is made of a file works in Chromium, runs no script of the file and asks no address in it.
    """
    chance, findings, counts = random.Random(seed), [], Counter[str]()
    good = tmp_path / "good.nc", tmp_path / "branch.nc"
    structure, usual = orchestrate.Structure.nondimensional(), {"jobs": 1, "progress": False}
    orchestrate.sweep(structure, eta=[1.0, 1.1], transient=2, samples=4, store=good[0], **usual)
    start = orchestrate.orbit(structure, eta=2.6, **usual)
    orchestrate.branch(structure, start=start, limits=(2.45, 2.62), store=good[1], **usual)
    for number in range(budget):
        folder = tmp_path / "trial"
        folder.mkdir()
        if number % 2:
            fate, problem = attack_page(folder, good, chance, browser)
        else:
            fate, problem = attack_reader(folder, fmu, good[0], chance, number // 2)
        shutil.rmtree(folder)
        counts[fate] += 1
        findings += [f"input {number} ({fate}): {problem}"] if problem else []
    expect_none(findings, counts)
