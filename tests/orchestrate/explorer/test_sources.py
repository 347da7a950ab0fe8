"""The page under closer inspection: accessibility, types of its sources."""

import json
import shutil
import subprocess
import tarfile

import pytest

from orchestrate.explorer.page import SOURCES, explore


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
def test_axe_finds_nothing_serious(browser, tmp_path, scheme):
    axe = (packed("axe-core", tmp_path) / "axe.min.js").read_text(encoding="utf-8")
    feature = {"name": "prefers-color-scheme", "value": scheme}
    browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
    browser.run(
        "explorer.choose(1.3); document.querySelectorAll('details').forEach((d) => d.open = true)"
    )
    browser.chosen()
    browser.run(axe)
    found = browser.driver.execute_async_script("axe.run().then(arguments[arguments.length - 1])")
    browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
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
