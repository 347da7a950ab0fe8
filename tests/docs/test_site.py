"""The manual builds without a warning, its code cells run, and nothing public is left out.

Slow: it takes half a minute, most of it the tutorial's own questions.
"""

import subprocess
import sys
import zlib

import pytest

import orchestrate
from orchestrate import cli
from tools.site import Site

from ..exports import once
from .written import DOCS


@pytest.fixture(scope="session")
def site(exported, tmp_path_factory):
    """The manual, built in a process of its own as its users do, once for all workers."""
    return once(tmp_path_factory, "manual", lambda: built(tmp_path_factory.mktemp("manual")))


def built(folder):
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
