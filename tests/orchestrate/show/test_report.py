"""The page of a report: it carries all it needs, escapes every text, and fits paper and phone."""

import base64
import hashlib
import re
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.show.page import format_number, format_with_error
from orchestrate.show.verdict import make_verdict, verdict_sections

EVIL = "<script>alert(\"1\")</script> & 'others'"
RATE = 1000.0


class Tags(HTMLParser):
    """Tags and texts of a page."""

    def __init__(self):
        super().__init__()
        self.tags, self.open, self.texts = [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)


def parsed(html):
    page = Tags()
    page.feed(html)
    assert page.open == []
    return page


@pytest.fixture(scope="module")
def signs():
    time = np.arange(4000) / RATE
    angle = 2.0 * np.pi * (20.0 * time + 5.0 * time**2)
    generator = np.random.default_rng(2)
    response = 6.0 * np.sin(angle) + np.sin(2.0 * angle) + 0.01 * generator.normal(size=4000)
    record = xr.Dataset(
        {"box_acceleration": ("time", 2.0 * np.sin(angle)), "acceleration1": ("time", response)},
        {"time": time},
        {"title": EVIL},
    )
    return orchestrate.signs(record, seeds=1)


@pytest.fixture(scope="module")
def html(signs, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "r.html"
    return orchestrate.report(signs, output=path, notes=EVIL).read_text("utf-8")


def test_every_text_is_escaped(html):
    page = parsed(html)
    assert "script" not in {tag for tag, _ in page.tags}
    assert EVIL in page.texts  # as a text, twice: the notes and the title's part
    assert not any(name.startswith("on") for _, attributes in page.tags for name in attributes)


def test_it_needs_no_network_and_its_style_is_the_one_allowed(html):
    assert "http:" not in html and "https:" not in html
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', html)[1]
    style = re.search(r"<style>(.*?)</style>", html, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    assert f"'sha256-{digest}'" in policy.replace("&#39;", "'")
    assert "default-src" in policy and "unsafe" not in policy and "script-src" not in policy
    assert not any("style" in attributes for _, attributes in parsed(html).tags)


def test_numbers_have_the_digits_of_their_errors():
    assert format_with_error(0.57123, 0.0312) == "0.571 ± 0.031"
    assert format_with_error(42.0, np.nan, "Hz") == "42 Hz"
    assert format_with_error(-3.4e-7, 4.4e-7, "m") == "-0.34 ± 0.44 µm"
    assert (format_number(np.inf, "Hz"), format_number(2e-6, "m")) == ("–", "2 µm")


@pytest.fixture(scope="module")
def verdict():
    return xr.Dataset(
        {
            "verdict": ((), "delaminated"),
            "misfit": ("hypothesis", [2.0, 0.5]),
            "value": (("hypothesis", "parameter"), [[0.3, np.nan], [np.nan, 42.0]]),
            "standard_error": (("hypothesis", "parameter"), [[0.1, np.nan], [np.nan, 0.5]]),
        },
        {
            "hypothesis": ["bonded, with a stop in the positive direction", "delaminated"],
            "parameter": ["stop", "f1"],
            "unit": ("parameter", ["1", "Hz"]),
            "meaning": ("parameter", ["stiffness of a stop", "frequency of half 1"]),
        },
        {"m1": 1.5, "m2": 0.75, "k1": 1.5 * (2 * np.pi * 42.0) ** 2, "k2": 0.75e5},
    )


def test_a_verdict_says_what_was_guessed_and_what_each_parameter_is(verdict):
    sections = {section.heading: section for section in verdict_sections(verdict)}
    assert any("1.5 kg and 0.75 kg" in words for words in sections["What was assumed"].points)
    assert any("42 Hz and 50.3 Hz" in words for words in sections["What was assumed"].points)
    rows = dict(row[:1] + row[1:2] for row in sections["Parameters"].tables[0].rows)
    assert rows["f1, frequency of half 1"] == "42.00 ± 0.50 Hz"
    assert "stop, stiffness of a stop" in rows
    assert make_verdict(verdict).sentence.endswith("frequencies fitted: f1 = 42.00 ± 0.50 Hz.")
    doubted = make_verdict(verdict.assign_attrs(wiring="face 1: polarity?")).sentence
    assert doubted.startswith("The wiring is doubtful: face 1: polarity?.")
    without = verdict.assign_attrs(m1=float("nan"))
    sections = {section.heading: section for section in verdict_sections(without)}
    assert not any("kg" in words for words in sections["What was assumed"].points)
