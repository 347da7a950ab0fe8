"""The version stands in one place; what cannot read it there says the same."""

import re

import orchestrate
from fmu_src.export import forms
from fmu_src.export.sources import load_model
from fmu_src.version import VERSION

from .fresh import ROOT


def test_the_citation_says_the_version():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r"^version: (.*)$", text, re.M)[1] == VERSION


def test_the_changelog_begins_with_the_version():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(r"^## (\S+)", text, re.M)[1] == VERSION


def test_results_say_the_version_of_the_code():
    """Not of the last ``pip install -e``, which an edit leaves as it was."""
    assert orchestrate.__version__ == VERSION


def test_the_models_bear_the_version():
    assert {load_model(folder).version for folder in forms.MODELS.values()} == {VERSION}
