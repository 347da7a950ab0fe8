"""The manual as its readers have it: short pages, small pictures, limits beside every verdict."""

import re
import runpy

import pytest
from PIL import Image, ImageChops

from tools.pictures import __main__ as made
from tools.pictures.small import save_small

from .written import DOCS, ROOT

MOST_WORDS = 1500
GENERATED = {  # by a tool, of which each row may be looked up but none is read in turn
    "claims": "tools.paper_page",
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


def test_words_are_those_that_are_read(words):
    page = "# Two words\n\n```python\nnot = these\n```\n<!-- nor: these -->\nThis | *is* | three\n"
    assert words(page) == 5
    assert words("---\nfile_format: mystnb\n---\n\n$$\na = b\n$$ (eq-a)\n\nOne\n") == 1


@pytest.mark.parametrize("name", VERDICTS)
def test_every_page_with_a_verdict_says_where_its_limits_stand(name):
    assert re.search(
        r"\]\((verdict_)?limits\.md(#[\w-]+)?\)", (DOCS / f"{name}.md").read_text("utf-8")
    )


@pytest.mark.parametrize("picture", PICTURES, ids=lambda picture: picture.name)
def test_pictures_are_small_and_shown(picture):
    assert picture.stat().st_size <= MOST_BYTES
    shown = [ROOT / "README.md", *PAGES]
    assert any(f"{picture.name})" in page.read_text(encoding="utf-8") for page in shown)


@pytest.mark.parametrize("name", ["two_masses", "fmu", "certificate"])
def test_drawings_are_those_of_their_script(name, tmp_path):
    save_small(made.PICTURES[name](), tmp_path / f"{name}.png")
    with Image.open(tmp_path / f"{name}.png") as own, Image.open(DOCS / f"{name}.png") as kept:
        assert own.size == kept.size
        # not each edge, nor each letter, which Matplotlib 3.10 sets some pixels off those of 3.11
        small = [picture.convert("L").reduce(32) for picture in (own, kept)]
        assert ImageChops.difference(*small).getextrema()[1] < 20


def test_history_is_in_the_changelog_alone():
    """A page says what is so, not what earlier versions did."""
    said = re.compile(r"\b(?:0\.1\.0|earlier numbers|before that|used to be|was wrong|now the)\b")
    for name in ("coupling", "performance", "paper", "jumps", "coupling_scheme"):
        assert said.findall((DOCS / f"{name}.md").read_text(encoding="utf-8")) == [], name
