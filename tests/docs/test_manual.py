"""The manual as its readers have it: short pages, small pictures, limits beside every verdict."""

import re
import runpy

import pytest

from tests import ROOT

from .written import DOCS

MOST_WORDS = 1500
GENERATED = {  # by a tool, of which each row may be looked up but none is read in turn
    "claims": "tools.paper_page",
    "source_map": "tools.source_map",
    "variables": "tools.assets",
}
PAGES = sorted(DOCS.glob("*.md"))
VERDICTS = ("coupling", "delaminated", "diagnosis", "engineer", "jumps", "paper", "signs")
PICTURES = sorted({*DOCS.rglob("*.png"), *DOCS.rglob("*.svg")})
MOST_BYTES = 150_000


@pytest.fixture(scope="module")
def words():
    """How the manual counts the words of a page."""
    return runpy.run_path(str(DOCS / "conf.py"))["count_words"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_is_read_at_one_sitting(page, words):
    text = page.read_text(encoding="utf-8")
    assert words(text) <= MOST_WORDS or f"python -m {GENERATED.get(page.stem)}" in text


@pytest.mark.parametrize("name", VERDICTS)
def test_every_page_with_a_verdict_says_where_its_limits_stand(name):
    text = (DOCS / f"{name}.md").read_text("utf-8")
    assert re.search(r"\]\((verdict_)?limits\.md(#[\w-]+)?\)", text)


@pytest.mark.parametrize("picture", PICTURES, ids=lambda picture: picture.name)
def test_pictures_are_small_and_shown(picture):
    assert picture.stat().st_size <= MOST_BYTES
    shown = [ROOT / "README.md", *PAGES]
    assert any(f"{picture.name})" in page.read_text(encoding="utf-8") for page in shown)
