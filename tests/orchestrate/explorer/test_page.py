"""The page in headless browsers: each way to use it, and the bits of what it shows."""

import numpy as np
import pytest

import orchestrate
from orchestrate.explorer.page import explore
from orchestrate.fmu import OSCILLATOR, Instance, find_or_export, sample_evenly, start_motion
from orchestrate.model import Excitation
from orchestrate.model.ranges import PUSHES
from orchestrate.response.questions import Point
from orchestrate.response.spectra import acceleration_spectrum

from ...sparing import ordinary

DIAGRAM = "explorer.regions.diagram"
MOTION = "explorer.inspector.found.motion"


def test_every_response_has_the_samples_of_the_file_to_the_last_bit(browser, swept):
    assert swept.sizes["eta"] > 50 and int((swept.multiplicity == 0).sum()) > 3
    etas = browser.numbers(f"{DIAGRAM}.points.map((point) => point.eta)")
    assert np.array_equal(etas, swept.eta.values)
    gaps = browser.numbers(f"{DIAGRAM}.lanes[0].found.flatMap((one) => Array.from(one.gaps))")
    assert gaps.tobytes() == swept.xi_rel.values.tobytes()


ASK = """
explorer.answers = [];
for (const [structure, eta] of arguments[0]) {
  const frequency = eta * Math.sqrt(structure.k1 / structure.m1);
  const points = [{ structure, eta, frequency, amplitude: 1 / (eta * eta) }];
  const asked = { points, starts: new Float64Array(4), indices: [0], settings: arguments[1] };
  const index = explorer.answers.push(null) - 1;
  explorer.pool.ask("responses", asked, ([part]) => { explorer.answers[index] = part; });
}
"""
SETTINGS = {"transient": 500, "samples": 200, "tolerance": 1e-2}


def random_structures(seed, count):
    """Structures with a gap, a preload or neither, some of them before a wall, with a play or
    under forces; a frequency ratio each, and what pushes them besides.
    """
    random = np.random.default_rng(seed)
    for i in range(count):
        structure = orchestrate.Structure.nondimensional(
            mu=random.uniform(0.25, 4.0),
            kappa=random.uniform(0.4, 3.0),
            D1=random.uniform(0.0005, 0.2),
            D2=random.uniform(0.0005, 0.2),
            e=random.uniform(0.05, 0.95),
        ).replace(clearance=(0.0, random.uniform(-3.0, 3.0))[i % 2], wall=i % 4 == 3)
        if i % 3 == 1:
            least = max(structure.clearance, 0.0)
            structure = structure.replace(stroke=least + random.uniform(0.1, 3.0))
        pushes = {name: float(random.normal() * (i % 5 > 2)) for name in PUSHES}
        pushes["force2"] *= not structure.wall
        yield structure, float(random.uniform(0.3, 5.0)), pushes


def numbers_of(structure, pushes):
    """A structure as the page has it."""
    return {name: float(value) for name, value in structure.parameters().items()} | pushes


@pytest.mark.parametrize("count", ordinary([20, 300]))
def test_the_numbers_are_those_of_python(shown, count):
    pairs = list(random_structures(11, count))
    shown.run(ASK, [[numbers_of(s, pushes), eta] for s, eta, pushes in pairs], SETTINGS)
    shown.until("return explorer.answers.every(Boolean)", seconds=300)
    found = [
        orchestrate.sweep(structure, eta=[eta], progress=False, jobs=1, **pushes, **SETTINGS)
        for structure, eta, pushes in pairs
    ]
    names = {
        "peak": "xi_rel_max",
        "impacts": "impacts_per_period",
        "multiplicity": "multiplicity",
        "decided": "multiplicity_decided",
        "contact": "permanent_contact",
    }
    for mine, theirs in names.items():
        numbers = shown.numbers(f"explorer.answers.map((one) => Number(one.{mine}))")
        expected = np.concatenate([data[theirs].values for data in found]).astype(float)
        assert np.array_equal(numbers, expected), mine
    gaps = shown.numbers("explorer.answers.flatMap((one) => Array.from(one.gaps))")
    assert gaps.tobytes() == np.concatenate([d.xi_rel.values[0] for d in found]).tobytes()
    assert len({int(data.multiplicity_decided[0]) for data in found}) >= 2


MOTIONS = {  # a structure and frequency ratio: chaos, regular, with contact, preloaded
    "chaos": (orchestrate.Structure(), 2.86),
    "regular": (orchestrate.Structure.nondimensional(mu=2.0, kappa=0.7, D=0.02, e=0.6), 1.2),
    "contact": (orchestrate.Structure.nondimensional(e=0.3, D=0.05), 0.6),
    "preload": (orchestrate.Structure.nondimensional(mu=1.5).replace(clearance=-0.5), 0.8),
    "play": (orchestrate.Structure.nondimensional(D=0.05).replace(stroke=1.5, e=0.8), 0.7),
}
SPECTRA = """
const [structure, eta, start] = arguments;
const frequency = eta * Math.sqrt(structure.k1 / structure.m1);
const point = { structure, eta, frequency, amplitude: 1 / (eta * eta) };
explorer.parts = [];
explorer.pool.ask("spectra", { point, start }, (parts) => explorer.parts.push(...parts));
"""


@pytest.mark.parametrize("name", MOTIONS)
def test_spectra_and_exponents_are_those_of_python(shown, name):
    structure, eta = MOTIONS[name]
    pushes = dict(zip(PUSHES, (0.1, 0.3, -0.2) if structure.stroke else (0.0,) * 3, strict=True))
    asked = {"eta": [eta], "transient": 400, "samples": 50, "progress": False}
    swept = orchestrate.sweep(structure, **asked, **pushes)
    start = swept.end_state.values[0].tolist()
    shown.run(SPECTRA, numbers_of(structure, pushes), eta, start)
    shown.until("return explorer.parts.length === 2")
    point = Point(structure, Excitation.nondimensional(eta, structure, **pushes))
    with Instance(find_or_export(OSCILLATOR).path) as instance:
        start_motion(instance, *point, start)
        states = sample_evenly(instance, 0.0, 64 * point.excitation.period, 65536)
    expected = acceleration_spectrum(states, 64, point.excitation)[0, :1281]
    amplitude = shown.numbers("explorer.parts[0].delaminated.amplitude")
    np.testing.assert_allclose(amplitude, expected, atol=1e-9 * expected.max())
    assert len(amplitude) == 1281 and amplitude.max() > 0.1
    asked = {"eta": eta, "progress": False, **pushes}
    bonded = orchestrate.spectra(structure, transient=2001, highest=20.0, **asked)
    bonded = bonded.acceleration.sel(kind="bonded", mass=1).values.ravel()
    mine = shown.numbers("explorer.parts[0].bonded.amplitude")
    np.testing.assert_allclose(mine, bonded, atol=1e-9 * bonded.max())
    found = shown.run("return explorer.parts[1].exponent")
    expected = orchestrate.lyapunov(structure, periods=400, start=start, transient=0, **asked)
    assert found["verdict"] == int(expected.verdict[0]) == (1 if name == "chaos" else -1)
    assert found["value"] == pytest.approx(float(expected.exponent[0]), rel=1e-6)
    assert found["error"] == pytest.approx(float(expected.standard_error[0]), rel=1e-3)


def test_a_click_shows_the_motion_of_the_response_there(browser, swept):
    browser.mouse("diagram", (0.37, 0.4))
    row = swept.sel(eta=browser.chosen())
    samples = browser.numbers("explorer.inspector.found.response.gaps")
    assert samples.tobytes() == row.xi_rel.values.tobytes()
    assert "impacts in 10 periods" in browser.get("history", "aria-label")


def test_a_link_restores_the_view(chromium, page):
    browser = chromium
    browser.open(page, "#from=2.8&to=3.1&direction=up&e=0.6&eta=2.95", whole=False)
    browser.chosen()
    link = browser.run("return location.hash")
    assert "start=" in link and "e=0.6" in link
    before = browser.numbers(f"{MOTION}.states")
    browser.open(page, link, whole=False)
    browser.chosen()
    assert browser.numbers(f"{MOTION}.states").tobytes() == before.tobytes()
    assert browser.run("return location.hash") == link
    assert browser.console() == []


def test_keys_alone_do_it(browser):
    from selenium.webdriver.common.keys import Keys

    browser.run("document.getElementById('closer').focus()")
    browser.keys(*[Keys.TAB] * 6)  # the sweep's direction, three files, the link
    assert browser.run("return document.activeElement.id") == "diagram"
    browser.keys(Keys.ARROW_RIGHT)
    first = browser.chosen()
    browser.keys(Keys.ARROW_RIGHT)
    second = browser.chosen()
    browser.keys(Keys.ARROW_RIGHT, held=Keys.SHIFT)
    assert browser.chosen() - second == pytest.approx(20 * (second - first), rel=0.05)
    whole = browser.run(f"return {DIAGRAM}.high - {DIAGRAM}.low")
    browser.keys("+")
    assert browser.run(f"return {DIAGRAM}.high - {DIAGRAM}.low") < 0.4 * whole
    browser.keys("b")
    assert browser.run(f"return {DIAGRAM}.high - {DIAGRAM}.low") == whole


@pytest.fixture(scope="module")
def shown(chromium, page):
    """The page for tests that only ask what it computes."""
    chromium.open(page)
    yield chromium
    assert chromium.console() == []


@pytest.mark.parametrize("clearance", [0.0, 3.0, -1.0])
def test_the_weak_drive_is_the_masters(shown, clearance):
    structure, drive = (
        kind.from_file("quick") for kind in (orchestrate.Structure, orchestrate.Drive)
    )
    structure = structure.replace(clearance=clearance)
    fixed = {"step": 0.1 / structure.omega, "tolerance": 0.0}
    found = orchestrate.couple(structure, drive, voltage=1.3, duration=300.0, **fixed)
    shown.run(
        """
        const { drive, oscillator, ...rest } = explorer.table.drive;
        const motor = { ...drive, voltage: 1.3, speed_start: 1.3 / drive.motor_constant };
        const voltages = new Array(1500).fill(1.3);
        const halves = { ...oscillator, clearance: arguments[0] };
        const asked = { run: null, start: { ...rest, drive: motor, oscillator: halves }, voltages };
        explorer.told = null;
        explorer.pool.ask("drive", asked, ([first]) =>
          explorer.pool.ask("drive", { ...asked, run: first.run }, ([last]) => {
            explorer.told = [...first.rows, ...last.rows];
          }));
        """,
        clearance,
    )
    shown.until("return explorer.told")
    count = found.sizes["revolution"]
    assert count > 40 and int(found.impacts.sum()) > 10
    for name in ("time", "speed", "impacts"):
        mine = shown.numbers(f"explorer.told.map((row) => row.{name})")
        assert np.array_equal(mine, found[name].values), name


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
