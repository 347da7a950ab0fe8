"""The page of a report: it carries all it needs, escapes every text, and fits paper and phone."""

import base64
import hashlib
import re

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.show.page import format_number, format_with_error

from ..elements import Elements

EVIL = "<script>alert(\"1\")</script> & 'others'"
RATE = 1000.0


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
    page = Elements(html)
    assert "script" not in page.tags
    assert EVIL in page.texts  # as a text, twice: the notes and the title's part
    assert not any(name.startswith("on") for name in page.attributes)


def test_it_needs_no_network_and_its_style_is_the_one_allowed(html):
    assert "http:" not in html and "https:" not in html
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', html)[1]
    style = re.search(r"<style>(.*?)</style>", html, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    assert f"'sha256-{digest}'" in policy.replace("&#39;", "'")
    assert "default-src" in policy and "unsafe" not in policy and "script-src" not in policy
    assert "style" not in Elements(html).attributes


def test_numbers_have_the_digits_of_their_errors():
    assert format_with_error(0.57123, 0.0312) == "0.571 ± 0.031"
    assert format_with_error(42.0, np.nan, "Hz") == "42 Hz"
    assert format_with_error(-3.4e-7, 4.4e-7, "m") == "-0.34 ± 0.44 µm"
    assert (format_number(np.inf, "Hz"), format_number(2e-6, "m")) == ("–", "2 µm")
