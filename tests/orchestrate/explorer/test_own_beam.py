"""A beam of one's own on the page: its numbers, what is wrong with them, commands."""

import json
import shlex

import pytest
import xarray as xr

import orchestrate
from orchestrate import cli

from ...sparing import ordinary
from .conftest import READY, typed

DIAGRAM = "explorer.regions.diagram"


@pytest.fixture
def pasted(tmp_path, monkeypatch):
    """The results that commands write when they are pasted into a shell, in order of their names;
    the shell is this process.
    """

    def run(commands, name):
        folder = tmp_path / name
        folder.mkdir()
        monkeypatch.chdir(folder)
        for line in commands.splitlines():
            words = shlex.shlex(line, posix=True, punctuation_chars=True)
            words.whitespace_split = True
            python, flag, what, *options = words
            if (python, flag) == ("python", "-c"):
                exec(what)
            else:
                assert (python, flag, what) == ("python", "-m", "orchestrate"), line
                assert cli.main(options) == 0
        return [xr.load_dataset(file) for file in sorted(folder.rglob("*.nc"))]

    return run


SHOWN = {  # states of the page: a link's words, and what is done then
    "first": ("", ""),
    "both directions": ("#from=1.2&to=1.25&direction=both&eta=1.22", ""),
    "dragged region": (
        "#from=1.2&to=1.3&direction=both",
        "explorer.open(1.21, 1.24); explorer.choose(1.22)",
    ),
    "other beam": ("#from=2.8&to=2.9&direction=down&e=0.55&k2=1.3&eta=2.85", ""),
    "bonded": ("#from=1&to=1.05&bonded=1&eta=1.02", ""),
    "tour": ("#tour=two-answers-other", ""),
    "play and force": ("#from=1.1&to=1.11&clearance=0.3&stroke=1.5&force1=0.4&eta=1.1", ""),
    "wall": ("#from=1.1&to=1.11&wall=1&clearance=-0.3&eta=1.1", ""),
    "wall, pushed": ("#from=1.1&to=1.11&wall=1&stroke=2&box_acceleration=-0.1&eta=1.1", ""),
    "in mm": ("#from=1&to=1.05&mm=0.3&k1=9000&k2=10000&eta=1.01", ""),
}


@pytest.mark.parametrize("name", ordinary(SHOWN, ["in mm"]))
def test_every_command_that_the_page_shows_runs_when_it_is_pasted(chromium, page, pasted, name):
    browser, (fragment, done) = chromium, SHOWN[name]
    browser.open(page, fragment)
    browser.until(READY)
    browser.run(done)
    browser.until(READY)
    (motion,) = pasted(browser.text("motion-command"), "motion")
    states = browser.numbers("explorer.inspector.found.motion.states").reshape(-1, 4)
    for column, variable in zip(states.T, ("x1", "x2", "v1", "v2"), strict=True):
        assert column.tobytes() == motion[variable].values.tobytes()
    times = browser.numbers("explorer.inspector.found.motion.impactTime")
    assert times.tobytes() == motion.impact_time.values.tobytes()
    results = pasted(browser.text("command"), "sweep")
    lanes = browser.run(f"return {DIAGRAM}.lanes.map((lane) => lane.direction)")
    for number, way in enumerate(lanes):
        found = f"{DIAGRAM}.lanes[{number}].found.flatMap((one) => Array.from(one.gaps))"
        mine = browser.numbers(found).tobytes()
        theirs = [
            one.sel(direction=way) if "direction" in one.dims else one
            for one in results
            if one.attrs["direction"] in (way, "both")
        ]
        assert [one.xi_rel.values.tobytes() for one in theirs] == [mine]
    assert browser.console() == []


def test_a_wall_a_play_and_forces_are_chosen_by_hand(browser):
    """The motion is Python's; what half 2 would be is gone, and back in the paper's it is as it
    was; a play is not narrower than the gap at rest.
    """
    browser.run("explorer.open(1.2, 1.3); explorer.choose(1.25, true)")
    browser.run("document.getElementById('loads').open = true")
    browser.click("wall")
    typed(browser, "xi0-number", "0.5")
    typed(browser, "play-number", "0.4")
    assert "not below that at rest" in browser.text("play-number-wrong")
    typed(browser, "play-number", "1.25")
    typed(browser, "push1-number", "0.3")
    typed(browser, "push-number", "-0.1")
    browser.until(READY)
    hidden = "return document.getElementById('{}-number').checkVisibility()"
    assert not any(browser.run(hidden.format(name)) for name in ("mu", "kappa", "push2"))
    structure = orchestrate.Structure(wall=True, clearance=0.5, stroke=1.25)
    choice = browser.run("return explorer.inspector.choice")
    expected = orchestrate.sweep(
        structure,
        frequency=[choice["point"]["frequency"]],
        amplitude=choice["point"]["amplitude"],
        start=choice["start"],
        **{"force1": 0.3, "box_acceleration": -0.1, "progress": False},
    )
    found = browser.numbers("explorer.inspector.found.response.gaps")
    assert found.tobytes() == expected.xi_rel.values.tobytes()
    assert float(expected.impacts_per_period[0]) > 0.0
    browser.run(
        "const units = document.getElementById('units'); units.value = 'own';"
        "units.dispatchEvent(new Event('change'))"
    )
    browser.until(READY)
    assert float(browser.get("force1", "value")) != 0.3  # 1 g is another unit of length
    assert browser.run("return explorer.inspector.found.response.impacts") == pytest.approx(
        float(expected.impacts_per_period[0]), abs=0.05
    )


WRONG = {  # a field, what is typed, and what is said beside it
    "e-number": ("1.7", "expected 0 to 1"),
    "mu-number": ("0", "expected 0.2 to 5"),
    "eta-number": ("-1", "expected 0.001 to 1000"),
    "periods": ("1000", "expected 1 to 200"),
    "pitch": ("0", "expected 0.2 to 500"),
}
STATE = "return JSON.stringify([explorer.structure, explorer.level, explorer.eta, location.hash])"


def test_what_is_wrong_with_a_number_stands_beside_its_field_and_nothing_changes(browser, page):
    browser.chosen()
    before = browser.run(STATE)
    wrong = "#e=7&m1=-1&eta=1e9&from=-3&to=0&g=1e99&start=1,2&direction=sideways"
    browser.open(page, wrong, whole=False)  # a link opens the usual view
    browser.chosen()
    assert json.loads(browser.run(STATE))[:3] == json.loads(before)[:3]
    before = browser.run(STATE)
    for name, (text, words) in WRONG.items():
        typed(browser, name, text)
        assert browser.text(f"{name}-wrong") == words
        assert not browser.get(f"{name}-wrong", "hidden")
        assert browser.run(
            "const [field, note] = [arguments[0], `${arguments[0]}-wrong`].map((id) =>"
            " document.getElementById(id)); return field.nextElementSibling === note &&"
            " field.getAttribute('aria-describedby') === note.id",
            name,
        )
        assert browser.run(STATE) == before
    typed(browser, "e-number", "0.6")
    assert browser.run("return explorer.structure.e") == 0.6
    assert browser.text("e-number-wrong") == ""
