"""The page in the units that it was asked for: axes, fields, numbers, commands, what is saved."""

import pytest

import orchestrate
from orchestrate.constants import GRAVITY, TURN
from orchestrate.explorer.page import explore

from ...sparing import ordinary
from .conftest import typed

BEAM = orchestrate.Structure.from_halves(m1=1.5, m2=1.2, f1=42.0, f2=55.0, zeta1=0.007, zeta2=0.007)
SHOWN = """
const { charts } = explorer.inspector.pictures;
const { x, gaps } = explorer.regions.view.axes;
const names = ["history", "phase", "section", "spectrum"];
const axes = names.map((name) => [charts[name].x.label, charts[name].y.label]);
return [[x.label, gaps.label], ...axes, charts.history.x.high, charts.spectrum.x.high];
"""
ASKED = {  # the words of the frequency, the length, the acceleration, the time on axes; their sizes
    "rad/s, um, m/s2": ("rad/s", "µm", "m/s²", "s", 1.0, 1e-6, 1.0),
    "rpm, m, g": ("rpm", "m", "g", "s", TURN / 60.0, 1.0, GRAVITY),
    "Hz, mm, m/s2, periods": ("Hz", "mm", "m/s²", "shaking periods", TURN, 1e-3, 1.0),
}


def value(browser, name):
    """A number that stands in a field."""
    return float(browser.get(name, "value"))


@pytest.mark.usefixtures("exported")
@pytest.mark.parametrize("units", ordinary(ASKED))
def test_the_page_follows_the_units_asked_for(chromium, units, tmp_path):
    turns, lengths, pushes, times, turn, length, push = ASKED[units]
    browser = chromium
    browser.open(explore(BEAM, units=units, output=tmp_path / "page.html"), whole=False)
    browser.chosen()
    typed(browser, "hertz", f"{300.0 / turn:.9g}")
    typed(browser, "level", "5")
    typed(browser, "gap-number", f"{-2e-5 / length:g}")
    browser.chosen()
    browser.until("return explorer.inspector.spectra")
    point = browser.run("return explorer.inspector.choice.point")
    assert point["frequency"] == pytest.approx(300.0, rel=2e-9)
    assert point["amplitude"] * point["frequency"] ** 2 == pytest.approx(5.0 * push, rel=2e-9)
    assert point["structure"]["clearance"] == pytest.approx(-2e-5, rel=1e-12)
    assert value(browser, "hertz") == pytest.approx(300.0 / turn, rel=1e-8)
    assert value(browser, "level") == 5.0
    assert value(browser, "f1") == pytest.approx(42.0 * TURN / turn, rel=1e-6)
    diagram, history, phase, section, spectrum, last, highest = browser.run(SHOWN)
    place, speed = f"displacement from rest, {lengths}", f"velocity, {lengths}/s"
    assert diagram == [f"shaking frequency, {turns}", f"gap, {lengths}"]
    assert (history, phase) == ([f"time, {times}", place], [place, speed])
    assert section == [f"gap, {lengths}", f"gap velocity, {lengths}/s"]
    assert spectrum == [f"frequency, {turns}", f"acceleration, {pushes}"]
    assert last == pytest.approx(10.0 if times != "s" else 10.0 * TURN / 300.0)
    assert highest == pytest.approx(20.0 * 300.0 / turn)
    numbers = browser.text("numbers")
    assert f"frequency, {turns}{float(f'{300.0 / turn:.6g}'):g}" in numbers
    assert f"acceleration of the box, {pushes}5" in numbers
    peak = browser.run("return explorer.inspector.found.response.peak")
    gap = peak * point["amplitude"] * point["eta"] ** 2 / length
    told = numbers.partition(f"largest gap, {lengths}")[2].partition("impacts")[0]
    assert float(told.replace("−", "-")) == pytest.approx(gap, rel=1e-3)
    assert browser.console() == []
