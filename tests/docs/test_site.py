"""The manual builds without a warning, its code cells run, and nothing public is left out.

Slow: it takes half a minute, most of it the tutorial's own questions.
"""

import json
import re
import runpy
import subprocess
import sys
import zlib

import pytest
from sphinx.search.en import SearchEnglish

import orchestrate
from orchestrate import cli
from tools.site import Site

from ..exports import once
from .test_manual import GENERATED
from .written import DOCS


@pytest.fixture(scope="session")
def site(exported, tmp_path_factory):
    """The manual, built in a process of its own as its users do, once for all workers."""
    return once(tmp_path_factory, "manual", lambda: built(tmp_path_factory.mktemp("manual")))


def built(folder):
    """Build it."""
    place = folder / "html"
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-n", "--keep-going", DOCS, place]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    return place


def inventory(site):
    """Names of all that the reference describes."""
    packed = (site / "objects.inv").read_bytes().split(b"\n", 4)[4]
    return {line.split()[0] for line in zlib.decompress(packed).decode().splitlines() if line}


@pytest.mark.slow
def test_the_public_face_is_described(site):
    names = {f"orchestrate.{name}" for name in orchestrate.__all__ if not name.startswith("_")}
    assert names - inventory(site) == set()


@pytest.mark.slow
def test_every_command_has_its_help(site):
    page = (site / "commands.html").read_text(encoding="utf-8")
    assert [name for name in cli.COMMANDS if f">{name}<" not in page] == []


@pytest.mark.slow
def test_nothing_comes_from_elsewhere_and_no_link_is_broken(site):
    """No script, style, font or picture is taken from the network."""
    checked = Site(site)
    assert len(checked.pages) > 35
    assert checked.external_resources() == []
    assert checked.broken_links() == []


@pytest.mark.slow
def test_every_page_says_how_long_it_takes_to_read(site):
    said = re.compile(r'class="reading-time">Reading time: (\d+) minutes?<')
    for page in sorted(DOCS.glob("*.md")):
        (minutes,) = said.findall((site / f"{page.stem}.html").read_text(encoding="utf-8"))
        assert 1 <= int(minutes) <= 8 or page.stem in GENERATED, page.stem


FOUND = {  # by the search: a page that is to be among the results
    "measured": "delaminated",
    "CSV": "laboratory",
    "Simulink": "fmi",
    "dSPACE": "fmi",
    "delaminated": "delaminated",
    "unbalance": "coupling",
    "Hz": "engineer",
}


@pytest.mark.slow
@pytest.mark.parametrize("word", FOUND)
def test_the_search_finds_what_users_ask_for(site, word):
    text = (site / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(text.removeprefix("Search.setIndex(").rstrip().removesuffix(")"))
    stem = SearchEnglish({}).stem(word.lower())
    places = [index[part].get(stem, []) for part in ("terms", "titleterms")]
    numbers = {n for found in places for n in (found if isinstance(found, list) else [found])}
    assert FOUND[word] in {index["docnames"][number] for number in numbers}


def test_notebooks_ask_for_no_scripts_of_others():
    """Of widgets, where their package is installed: they come from two other hosts by default."""
    settings = runpy.run_path(str(DOCS / "conf.py"))
    assert settings.get("nb_ipywidgets_js") == {}
