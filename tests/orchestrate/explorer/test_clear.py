"""The page is clear to someone who sees it first: what it says is true, and nothing jumps."""

import json

import pytest

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


def test_as_it_was_brings_back_the_page_as_it_was_opened(opened):
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


def test_as_it_was_of_a_link_is_what_the_link_shows(opened, page):
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
    assert len(rows) == 1 + others == 1 + hinted(opened)
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
    assert opened.run("return document.getElementById('listen').innerText").startswith("Silence")
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
    assert "Impacts under a gap of 0" in opened.text("status")
    far, label, spans = opened.run(drawn)
    assert far < 1e-9 and label == "displacement from rest, mm" and spans == 1
    opened.run("document.querySelector(\"[data-save='history.svg']\").click()")
    assert "stuck together" in opened.download("history*.svg").read_text()


def test_what_never_repeats_has_impacts_on_average(opened):
    opened.run("explorer.choose(2.9, true)")
    opened.until(READY)
    assert ", on average " in opened.text("sentence") and " on average" in opened.text("numbers")
    assert "then the halves stick" not in opened.text("sentence")


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
