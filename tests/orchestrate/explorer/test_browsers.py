"""The page under closer inspection: speed, accessibility, types of its sources."""

import json
import shutil
import subprocess
import tarfile

import pytest

from orchestrate.explorer.page import SOURCES, explore

from .traced import Traced

ONE_WORKER = """
explorer.regions.pool.workers.splice(1);
Object.defineProperty(explorer.regions, "count", { get: () => 300 });
"""
REGIONS = ((0.3, 0.6), (1.1, 1.4), (2.8, 3.1))


@pytest.mark.slow
def test_a_dragged_region_comes_at_once_and_is_soon_complete(opened):
    opened.run(ONE_WORKER)
    for low, high in REGIONS:
        opened.run("explorer.open(arguments[0], arguments[1])", low, high)
        opened.until("return explorer.regions.complete")
        assert opened.run("return explorer.regions.diagram.points.length") >= 300
        took = opened.run("return explorer.regions.took")
        assert took["first"] < 300 and took["all"] < 2000, (low, high, took)


@pytest.mark.slow
def test_all_of_figure_6_is_one_branch_to_the_last_bit(chromium, tmp_path, exported):
    page = explore(output=tmp_path / "figure6.html")
    assert page.stat().st_size < 1_500_000
    chromium.open(page)
    lane = "explorer.regions.diagram.lanes[0]"
    starts = chromium.numbers(f"{lane}.starts").reshape(-1, 4)
    ends = chromium.numbers(f"{lane}.found.flatMap((one) => one.end)").reshape(-1, 4)
    assert ends.shape == starts.shape == (7901, 4)
    assert ends[:-1].tobytes() == starts[1:].tobytes()
    assert chromium.console() == []


COMPLETE = "explorer.regions.complete && !explorer.regions.quick"
CHOSEN = "explorer.inspector.found && explorer.inspector.exponent !== undefined"
BUSY = "let sum = 0; for (let i = 0; i < 3e8; i++) sum += i;"
SLIDER = "{ const at = document.getElementById('e'); at.value = 0.6; "
WAYS = {  # what is done, until when
    "irregular": ("explorer.choose(2.95)", CHOSEN),
    "many impacts": ("explorer.choose(0.4)", CHOSEN),
    "sound": ("explorer.player.listen()", "explorer.inspector.sound.playing"),
    "region": ("explorer.open(1.1, 1.4)", COMPLETE),
    "back": ("document.getElementById('back').click()", COMPLETE),
    "slider": (f"{SLIDER} at.dispatchEvent(new Event('input')); }}", COMPLETE),
    "as it was": ("document.getElementById('reset').click()", COMPLETE),
    "tour": ("document.querySelector('#tour a').click()", CHOSEN),
    "basin": (
        "document.getElementById('others').click()",
        "document.getElementById('basins').dataset.complete === 'true'",
    ),
    "run on": (
        "document.getElementById('run-on').click()",
        "explorer.inspector.section.length > 4000",
    ),
    "motor": ("document.getElementById('ramp-up').click()", "explorer.drive.rows.length > 50"),
    "nothing but a long task": (
        f"setTimeout(() => {{ {BUSY} window.busy = true; }})",
        "window.busy",
    ),
}


@pytest.mark.slow
def test_no_task_of_the_page_takes_50_ms(tmp_path, exported):
    """Of the processor: what other programs do to a task's time by the clock is not the page's."""
    pytest.importorskip("websocket", reason="websocket-client talks to Chromium")
    program = shutil.which("chromium") or pytest.skip("no chromium here")
    page = explore(output=tmp_path / "figure6.html")
    browser = Traced(program, tmp_path / "profile")
    try:
        browser.start(page.as_uri())
        browser.until(f"window.explorer && {CHOSEN}")
        for name, (done, until) in WAYS.items():
            browser.do(name, done, until)
        longest = browser.longest()
    finally:
        browser.quit()
    assert longest.pop("nothing but a long task") > 50.0  # it is seen
    assert {name: took for name, took in longest.items() if took >= 50.0} == {}, longest


@pytest.mark.slow
def test_the_page_is_there_within_a_second(opened, page):
    times = []
    for _ in range(3):
        opened.open(page)
        load = opened.run("return performance.getEntriesByType('navigation')[0].loadEventEnd")
        times.append(load + opened.run("return explorer.regions.first"))
    assert min(times) < 1000


def packed(name, folder):
    """A package of npm, unpacked; its tests are skipped where it cannot be had."""
    if not shutil.which("npm"):
        pytest.skip(f"no npm here, which brings {name}")
    done = subprocess.run(
        ["npm", "pack", "--silent", name], cwd=folder, capture_output=True, text=True
    )
    if done.returncode != 0:
        pytest.skip(f"npm cannot bring {name}: {done.stderr.strip()[:200]}")
    with tarfile.open(next(folder.glob("*.tgz"))) as archive:
        archive.extractall(folder, filter="data")
    return folder / "package"


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(opened, tmp_path, scheme):
    axe = (packed("axe-core", tmp_path) / "axe.min.js").read_text(encoding="utf-8")
    feature = {"name": "prefers-color-scheme", "value": scheme}
    opened.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
    opened.run(
        "explorer.choose(1.3); document.querySelectorAll('details').forEach((d) => d.open = true)"
    )
    opened.chosen()
    opened.run(axe)
    found = opened.driver.execute_async_script("axe.run().then(arguments[arguments.length - 1])")
    opened.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    told = [
        (one["id"], one["impact"], [node["html"][:90] for node in one["nodes"]])
        for one in found["violations"]
    ]
    assert [one for one in told if one[1] in ("serious", "critical")] == [], told


@pytest.mark.slow
def test_typescript_finds_no_wrong_type(tmp_path):
    subprocess.run(
        ["npm", "install", "--silent", "typescript@5"], cwd=tmp_path, capture_output=True
    ) if shutil.which("npm") else pytest.skip("no npm here, which brings typescript")
    if not (tmp_path / "node_modules" / "typescript").exists():
        pytest.skip("npm cannot bring typescript")
    options = {
        **{"checkJs": True, "allowJs": True, "noEmit": True, "strict": True, "types": []},
        **{"target": "es2022", "module": "es2022", "moduleResolution": "bundler"},
        "lib": ["es2022", "dom", "dom.iterable"],
    }
    given = {"compilerOptions": options, "include": [f"{SOURCES}/*.js"]}
    (tmp_path / "tsconfig.json").write_text(json.dumps(given))
    done = subprocess.run(
        ["node", "node_modules/typescript/bin/tsc", "-p", "."],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
