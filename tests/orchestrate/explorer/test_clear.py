"""The page is clear to someone who sees it first: what it says is true, and nothing jumps."""

import itertools
import json
import re

import numpy as np
import pytest

import orchestrate

from ...sparing import ordinary
from .conftest import typed

READY = (
    "return explorer.regions.complete && !explorer.regions.quick && explorer.inspector.found"
    " && explorer.inspector.exponent !== undefined"
)
SEEN = """
const values = [...document.querySelectorAll("input, select")].map(({ id, type, value, checked }) =>
  [id, type === "checkbox" ? checked : value]);
const texts = ["sentence", "numbers", "status", "tour", "command", "motion-command",
  "record-status", "section-count", "basins", "drive-status"].map((id) =>
  [id, document.getElementById(id).textContent, document.getElementById(id).hidden]);
const { diagram } = explorer.regions;
const open = [...document.querySelectorAll("#tour p")].map((text) => text.hidden);
return JSON.stringify([values, texts, diagram.points.length, diagram.low, diagram.high, open,
  location.hash, explorer.inspector.periods, explorer.inspector.animation.speed]);
"""
BOXES = """
return ["play", "listen", "impact", "pitch", "history", "drive-go", "motion"].map((id) => {
  const { x, y, width, height } = document.getElementById(id).getBoundingClientRect();
  return [id, x, y + scrollY, width, height];
});
"""


def test_reset_brings_back_the_page_as_it_was_opened(opened):
    opened.until(READY)
    before = json.loads(opened.run(SEEN))
    typed(opened, "pitch", "9")
    typed(opened, "periods", "3")
    opened.run(
        "for (const [id, value] of [['units', 'own'], ['direction', 'both'], ['speed', '2']]) {"
        "  const at = document.getElementById(id); at.value = value;"
        "  at.dispatchEvent(new Event('input')); at.dispatchEvent(new Event('change')); }"
        "document.getElementById('beside').click();"
    )
    typed(opened, "f1", "42")
    opened.run("explorer.open(1.1, 1.3); explorer.choose(1.23456)")
    opened.until(READY)
    opened.run("document.querySelector('#tour a').click()")
    opened.until(READY)
    opened.run("explorer.change({ ...explorer.structure, e: 0.6 })")  # the diagram is still to come
    opened.run("document.getElementById('reset').click()")
    opened.until(READY)
    after = json.loads(opened.run(SEEN))
    for was, now in zip(before, after, strict=True):
        assert now == was


def test_reset_of_a_link_is_what_the_link_shows(opened, page):
    opened.open(page, "#tour=pressed")
    opened.until(READY)
    before = json.loads(opened.run(SEEN))
    opened.run("explorer.choose(1.02)")
    opened.run("document.getElementById('reset').click()")
    opened.until(READY)
    assert json.loads(opened.run(SEEN)) == before


def test_numbers_are_rounded_for_showing_alone(opened):
    opened.run("explorer.choose(2.7323809523809, true)")
    opened.until(READY)
    assert opened.run("return explorer.eta") == 2.7323809523809
    assert opened.get("eta-number", "value") == "2.732381"
    assert "frequency ratio η2.73238large" in opened.text("numbers")


def hinted(browser):
    return browser.run(
        "return document.getElementById('hint').checkVisibility({ checkVisibilityCSS: true })"
    )


@pytest.mark.parametrize(("eta", "others"), [(1.3, True), (1.7, False)])
def test_where_another_motion_is_known_the_page_says_so(opened, eta, others):
    opened.run("explorer.choose(arguments[0], true)", eta)
    opened.until(READY)
    opened.until("return explorer.basin.few.length")
    opened.run("document.getElementById('others').click()")
    opened.until("return document.getElementById('basins').dataset.complete === 'true'")
    rows = opened.run(
        "return [...document.querySelectorAll('#basins li')].map((row) => row.innerText)"
    )
    assert len(rows) == 1 + others
    words = (
        "Other motions: see the coloured map." if others else "No other motion from 4096 starts."
    )
    assert hinted(opened) and opened.text("hint") == words
    assert sum("shown now" in row for row in rows) == 1
    if others:
        now = opened.run("return document.querySelector('#basins .now').parentElement.textContent")
        opened.run("document.querySelector('#basins button').click()")
        opened.until(READY)
        marked = "return document.querySelector('#basins .now').parentElement.textContent"
        assert opened.run(marked) != now and hinted(opened)


def test_a_hint_comes_by_itself(opened):
    opened.run("explorer.choose(1.3, true)")
    opened.until(READY)
    opened.until("return !document.getElementById('hint').classList.contains('absent')")
    assert opened.run("return explorer.basin.few.length") == 2  # of a few starts alone
    assert opened.text("hint") == "There is another motion at this frequency."


def test_where_all_of_a_few_starts_lead_to_one_motion_nothing_hints_at_another(opened):
    opened.run("explorer.choose(1.7, true)")
    opened.until(READY)
    opened.until("return explorer.basin.tried")
    assert opened.run("return explorer.basin.few.length") == 1
    assert opened.run("return explorer.basin.hint(true)") == ""  # whatever the sweeps suggest
    opened.run("explorer.basin.tried = false")
    assert (
        opened.run("return explorer.basin.hint(true)")
        == "There may be another motion at this frequency."
    )


def test_no_sentence_moves_what_is_below_it(opened):
    opened.until(READY)
    opened.run("scrollTo(0, 0)")
    before = opened.run(BOXES)
    for eta in (1.2, 2.9, 0.3):  # of the longest sentences
        opened.run("explorer.choose(arguments[0], true)", eta)
        opened.until(READY)
        assert opened.run(BOXES) == before


def test_no_button_moves_what_is_around_it(opened):
    opened.until(READY)
    opened.run("scrollTo(0, 0)")
    before = opened.run(BOXES)
    for button in ("listen", "play"):
        opened.run("document.getElementById(arguments[0]).click()", button)
    opened.until("return explorer.inspector.sound.playing")
    assert opened.run("return document.getElementById('listen').innerText").startswith("Stop sound")
    opened.run("document.getElementById('drive-go').textContent = 'Stop motor'")
    opened.run("document.getElementById('hint').classList.toggle('absent')")
    assert opened.run(BOXES) == before


def test_pressed_halves_that_are_shut_are_drawn_as_one_and_shading_has_a_legend(opened, page):
    opened.open(page, "#tour=pressed")
    opened.until(READY)
    drawn = """
    const kept = {};
    const { pictures } = explorer.inspector;
    const old = pictures.show;
    pictures.show = (name, chart, words) => { kept[name] = chart; old(name, chart, words); };
    explorer.inspector.drawMotion();
    pictures.show = old;
    const { series, y, spans } = kept.history;
    const [one, two] = series.filter(({ label }) => label?.startsWith("half"));
    const far = one.y.reduce((most, value, i) => Math.max(most, Math.abs(value - two.y[i])), 0);
    const size = one.y.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
    return [far / size, y.label, spans.length];
    """
    assert "The halves open only from 36.2 to 47 Hz" in opened.text("status")
    far, label, spans = opened.run(drawn)
    assert far < 1e-9 and label == "displacement from rest, mm" and spans == 1
    opened.run("document.querySelector(\"[data-save='history.svg']\").click()")
    assert "stuck together" in opened.download("history*.svg").read_text()


def test_what_never_repeats_has_impacts_on_average(opened):
    opened.run("explorer.choose(2.9, true)")
    opened.until(READY)
    assert ", on average " in opened.text("sentence") and " on average" in opened.text("numbers")
    assert "then the halves stick" not in opened.text("sentence")
    periods = opened.run("return explorer.inspector.found.response.gaps.length")
    assert opened.text("average").startswith(f"averages over {periods} periods; from another start")
    visible = "return !document.getElementById('average').classList.contains('absent')"
    assert opened.run(visible)
    opened.run("explorer.choose(1.7, true)")
    opened.until(READY)
    assert not opened.run(visible)


def test_a_mean_is_rounded_alike_in_the_headline_and_in_the_table(opened):
    opened.run("explorer.choose(2.9, true)")
    opened.until(READY)
    for impacts in (1.045, 0.895, 22.125):
        opened.run(
            "explorer.inspector.found.response.impacts = arguments[0];"
            "explorer.inspector.showNumbers()",
            impacts,
        )
        headline = re.search(r"on average (\S+) impacts", opened.text("sentence")).group(1)
        table = re.search(r"impacts a period(\S+) on average", opened.text("numbers")).group(1)
        assert headline == table and abs(float(table) - impacts) < 0.01 * impacts


def test_contact_that_is_not_in_the_picture_is_said_to_have_been_before_it(opened):
    opened.run("explorer.choose(2.9, true)")
    opened.until(READY)
    opened.run(
        "const { response, motion } = explorer.inspector.found;"
        "response.contact = true; motion.contact.fill(0); explorer.inspector.showNumbers()"
    )
    assert "at times, outside the periods shown, the halves stick" in opened.text("sentence")


EXPONENTS = {  # of a motion that has not repeated: value and error, headline, label
    "chaos": (0.05, 0.01, "Chaos: never repeats", "chaotic"),
    "converging": (-0.05, 0.01, "Has not repeated within 50 periods, but converges", "converges"),
    "undecided": (-0.00103, 0.002, "Nearly repeats, or is still settling", "undecided"),
    "undecided above zero": (0.009, 0.01, "Nearly repeats, or is still settling", "undecided"),
}


@pytest.mark.parametrize("name", ordinary(EXPONENTS, ["chaos", "undecided above zero"]))
def test_an_exponent_within_its_error_decides_nothing(opened, name):
    value, error, headline, label = EXPONENTS[name]
    opened.run("explorer.choose(2.9, true)")
    opened.until(READY)
    assert opened.run("return explorer.inspector.found.response.multiplicity") == 0
    opened.run(
        "const [value, error] = arguments;"
        "explorer.inspector.takeSpectra({ exponent: { value, error } })",
        value,
        error,
    )
    assert opened.text("sentence").startswith(headline)
    assert label in opened.text("exponent")
    undecided = name.startswith("undecided")
    for text in (opened.text("sentence"), opened.text("exponent")):
        assert ("undecided here" in text) == undecided
    assert "undecided here" in opened.text("help-exponent")


def test_in_a_cloud_an_exponent_goes_on_until_its_sign_is_known(opened):
    """After 400 periods at 3.05 it is 0.004 with an error of 0.015."""
    opened.run("explorer.choose(3.05, true, [0, 0, 0, 0])")
    opened.until(READY)
    assert opened.text("sentence").startswith("Chaos: never repeats")


@pytest.mark.parametrize("eta", [2.9, 1.7, 3.05])
def test_the_error_of_the_exponent_covers_the_careful_one(opened, eta):
    opened.run("explorer.choose(arguments[0], true)", eta)
    opened.until(READY)
    found = opened.run("return explorer.inspector.exponent")
    careful = orchestrate.lyapunov(orchestrate.Structure(), eta=eta, progress=False)
    assert abs(found["value"] - careful.exponent.item()) < found["error"] < abs(found["value"])


def test_a_mean_place_makes_no_line_in_the_spectrum(opened, page):
    """The halves that are pressed shut stand beside their springs' own lengths and move as one."""
    opened.open(page, "#tour=pressed")
    opened.until(READY)
    delaminated, bonded = (
        opened.numbers(f"explorer.inspector.spectra.{name}.amplitude")
        for name in ("delaminated", "bonded")
    )
    assert opened.run("return Math.abs(explorer.inspector.found.motion.states[0])") > 1e-6
    slow = slice(0, 32)  # below half of the shaking frequency
    assert delaminated[slow].max() < 1e-7 * delaminated.max()
    assert np.abs(delaminated - bonded).max() < 1e-3 * bonded.max()


def luminance(colour):
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [
        part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    ]
    return float(np.dot(linear, (0.2126, 0.7152, 0.0722)))


def test_sweeps_up_and_down_have_colours_that_nobody_mixes_up(opened):
    """One is blue, one is orange: they differ for those who see no red or no green, too."""
    up, down = opened.run(
        "const style = getComputedStyle(document.documentElement);"
        "return ['up', 'down'].map((name) => style.getPropertyValue(`--${name}`).trim())"
    )
    blue, red = (lambda colour: int(colour[5:7], 16)), (lambda colour: int(colour[1:3], 16))
    assert blue(up) - blue(down) > 100 and red(down) - red(up) > 100
    for colour in (up, down):
        assert 1.05 / (luminance(colour) + 0.05) > 3.0  # against white paper


def test_the_words_are_one_click_from_the_first_sentence(opened):
    opened.until(READY)
    shown = opened.run("return location.hash")
    opened.click("words-link")
    assert opened.run("return document.getElementById('words').open")
    assert opened.run("return location.hash") == shown
    words = opened.text("words")
    for word in ("orbit diagram", "sweep", "chatter", "impact", "level, g"):
        assert word in words


def test_how_fast_the_motion_is_shown_is_a_number(opened, page):
    opened.until(READY)
    assert opened.text("speed-words") == "0.35 periods a second"
    opened.open(page, "#tour=pressed")  # 30 Hz
    opened.until(READY)
    opened.until("return document.getElementById('speed-words').textContent.includes('slowed')")
    speed = opened.run("return explorer.inspector.animation.speed")
    assert opened.text("speed-words") == f"{30.0 / speed:.2g} times slowed"


def test_the_chosen_frequency_sweeps_and_impacts_have_colours_of_their_own(opened):
    names = ("hit", "mark", "down", "up", "one", "two")
    colours = opened.run(
        "const style = getComputedStyle(document.documentElement);"
        "return arguments[0].map((name) => style.getPropertyValue(`--${name}`).trim())",
        names,
    )
    assert all(colours) and len(set(colours)) == len(names)


def test_controls_and_symbols_explain_themselves(opened):
    for name, word in (
        ("e", "after an impact"),
        ("eta-number", "natural frequency"),
        ("units", "delamination"),
    ):
        title = opened.run(
            "return document.getElementById(arguments[0]).closest('[title]')?.title"
            " ?? document.querySelector(`label[for='${arguments[0]}']`).title",
            name,
        )
        assert word in title
    assert "bonded" not in opened.run("return document.body.innerText").lower()


def test_a_sound_that_is_heard_goes_on_with_the_next_motion(opened):
    opened.until(READY)
    opened.run("document.getElementById('listen').click()")
    opened.until("return explorer.inspector.sound.playing")
    for eta in (2.9, 1.7):
        opened.run("window.last = explorer.inspector.sound.source")
        opened.run("explorer.choose(arguments[0], true)", eta)
        opened.until(READY)
        opened.until("return explorer.inspector.sound.source !== window.last")
        assert opened.run("return explorer.inspector.sound.playing")
        assert opened.text("listen-word") == "Stop sound"
    opened.run("document.getElementById('listen').click()")
    opened.run("explorer.choose(1.2, true)")
    opened.until(READY)
    assert not opened.run("return explorer.inspector.sound.playing")
    assert opened.text("listen-word") == "Sound"


LOUD = (
    "return Boolean(explorer.inspector.sound.source?.buffer.getChannelData(0)"
    ".some((value) => value !== 0))"
)


def test_halves_that_stay_shut_are_silent_until_they_knock_again(opened, page):
    opened.open(page, "#tour=pressed")
    opened.until(READY)
    opened.run("document.getElementById('listen').click()")
    opened.until("return document.getElementById('listen-word').textContent === 'Stop sound'")
    opened.until(READY)
    assert not opened.run(LOUD)
    opened.run("document.querySelector('a[href=\"#tour=pressed-open\"]').click()")
    opened.until(LOUD)


@pytest.mark.parametrize(
    "name",
    ordinary(["quiet", "chattering", "two-answers", "pressed", "pressed-open"], ["pressed"]),
)
def test_no_step_of_the_tour_moves_the_pictures(opened, page, name):
    """On a screen of 1440 x 900: the diagram, the sentence, the motion stay where they were."""
    size = {"width": 1440, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    opened.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        opened.open(page)
        opened.until(READY)
        before = opened.run(PLACED)
        opened.run("document.querySelector(`a[href='#tour=${arguments[0]}']`).click()", name)
        opened.until(READY)
        assert opened.run(PLACED) == before
        for part in ("diagram", "animation", "history", "hint", "others"):
            assert opened.run(BOTTOM, part) <= 900
    finally:
        opened.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


PLACED = """
return ["diagram", "sentence", "animation", "history"].map((id) =>
  [id, document.getElementById(id).getBoundingClientRect().top + scrollY]);
"""
BOTTOM = "return document.getElementById(arguments[0]).getBoundingClientRect().bottom"


@pytest.mark.parametrize("eta", [1.3, 1.7])
def test_other_motions_that_come_move_nothing(opened, eta):
    opened.run("explorer.choose(arguments[0], true)", eta)
    opened.until(READY)
    opened.run("document.getElementById('basin-figure').scrollIntoView({ block: 'center' })")
    places = (
        "return ['basin', 'phase', 'section', 'drive'].map((id) =>"
        " document.getElementById(id).getBoundingClientRect().top + scrollY)"
    )
    opened.run("explorer.basin.forget()")
    before = opened.run(places)
    opened.run("document.getElementById('others').click()")
    opened.until("return document.getElementById('basins').dataset.complete === 'true'")
    assert opened.run("return document.querySelectorAll('#basins li').length") > 0
    assert opened.run(places) == before


def test_on_a_phone_the_motion_stands_before_the_controls(opened, page):
    size = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
    opened.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        opened.open(page)
        opened.until(READY)
        tops = opened.run(
            "return ['diagram', 'sentence', 'animation', 'listen', 'eta', 'spectrum'].map((id) =>"
            " document.getElementById(id).getBoundingClientRect().top)"
        )
        assert tops == sorted(tops)
        assert opened.run("return document.documentElement.scrollWidth") <= 390
    finally:
        opened.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


TEXTS_DRAWN = """
const [name] = arguments;
const boxes = [];
const proto = CanvasRenderingContext2D.prototype;
const old = proto.fillText;
proto.fillText = function (words, x, y) {
  const { a, b, c, d, e, f } = this.getTransform();
  const { width } = this.measureText(words);
  const size = parseFloat(this.font);
  const left = { start: 0, center: -width / 2, end: -width }[this.textAlign];
  const density = devicePixelRatio || 1;
  const turned = Math.abs(b) > 1e-6;
  const [w, h] = turned ? [size, width] : [width, size];
  const [cx, cy] = [e / density, f / density];
  const from = turned ? [cx - size / 2, cy - width - left] : [cx + left, cy - size / 2];
  boxes.push([words, from[0], from[1], w, h]);
  old.call(this, words, x, y);
};
try {
  const picture = name === "diagram" ? explorer.regions.view.picture
    : explorer.inspector.pictures.pictures[name];
  picture.paint();
} finally {
  proto.fillText = old;
}
return boxes;
"""


def overlapping(boxes, room=0.0):
    """Pairs of texts whose boxes come nearer to each other than some pixels sideways."""
    near = []
    for i, (first, x, y, w, h) in enumerate(boxes):
        for second, left, top, wide, high in boxes[i + 1 :]:
            if x < left + wide + room and left < x + w + room and y < top + high and top < y + h:
                near.append((first, second))
    return near


PANELS = ("diagram", "history", "spectrum", "phase", "section")
NARROW = (("diagram", 390), ("spectrum", 1440), ("phase", 390))  # where texts are nearest


@pytest.mark.parametrize(
    ("name", "width"),
    ordinary(itertools.product(PANELS, (1440, 390)), NARROW, several_names=True),
)
def test_no_two_texts_of_a_picture_collide(opened, page, name, width):
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
    opened.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        opened.open(page, "#tour=two-answers")
        opened.until(READY)
        opened.until("return Boolean(explorer.inspector.spectra)")
        boxes = opened.run(TEXTS_DRAWN, name)
        assert len(boxes) > 5
        assert overlapping(boxes, room=6.0) == []
    finally:
        opened.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_a_saved_picture_is_sharp_on_paper(opened):
    """A PNG has two pixels for each of the screen's, where the screen has one."""
    opened.until(READY)
    opened.run("document.querySelector(\"[data-save='history.png']\").click()")
    width = int.from_bytes(opened.download("history*.png").read_bytes()[16:20], "big")
    shown = opened.run("return document.getElementById('history').clientWidth")
    assert width >= 2 * shown


def test_only_the_sweep_that_the_page_came_with_is_said_to_be_one(opened):
    opened.until(READY)
    opened.run("document.querySelector(\"[data-save='diagram.svg']\").click()")
    assert "sweep by" in opened.download("diagram_eta0.7.svg").read_text()
    opened.run("explorer.open(1.1, 1.3); explorer.choose(1.25, true)")
    opened.until(READY)
    for name in ("diagram", "history"):
        opened.run(f"document.querySelector(\"[data-save='{name}.svg']\").click()")
        text = opened.download(f"{name}_eta1.25.svg").read_text()
        assert "kernel {" in text and "sweep by" not in text
