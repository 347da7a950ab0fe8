"""The README keeps pace: its test command is the one that runs, what it points to is there."""

import inspect
import re

import pytest

import orchestrate
from fmu_src.export import forms
from fmu_src.export.sources import load_model
from fmu_src.version import VERSION
from orchestrate.fmu import find_or_export
from tests import ROOT
from tools import assets

from .exports import BUILD

README = (ROOT / "README.md").read_text(encoding="utf-8")
TABLES = assets.TABLES.read_text(encoding="utf-8")


def test_the_test_command_is_what_ci_runs():
    command = (ROOT / ".ci" / "run").read_text().strip().splitlines()[-1]
    assert f"```\n{command}\n```" in README


@pytest.mark.parametrize("reference", assets.REFERENCES, ids=lambda reference: reference.model)
def test_the_variable_tables_are_the_fmus(exported, reference):
    table = assets.variable_tables_as_markdown(BUILD / "fmi2-python" / f"{reference.model}.fmu")
    assert assets.replace_variable_table(TABLES, reference, table) == TABLES


def test_what_it_points_to_is_there():
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", README)
    pages = re.findall(r"[^!]\[[^]]*\]\((docs/[^)]+|[A-Z]+\.md)\)", README)
    folders = re.findall(r"`((?:fmu_src|orchestrate|tools|tests|build)/[\w/]*)`", README)
    assert pictures and pages and folders
    assert [p for p in (*pictures, *pages, *folders) if not (ROOT / p).exists()] == []


def test_the_fmu_of_the_example_is_one_that_the_first_command_makes():
    made = inspect.signature(find_or_export).parameters["form"].default
    (block,) = (part for part in re.findall(r"```python\n(.*?)```", README, re.S) if "fmpy" in part)
    assert re.findall(r'"build/([\w-]+)/', block) == [made]


def test_the_version_stands_in_one_place_and_elsewhere_it_is_said_as_there():
    """Results say that of the code, not of the last ``pip install -e``."""
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    told = [re.search(r"^version: (.*)$", citation, re.M)[1]]
    told.append(re.search(r"^## (\S+)", changes, re.M)[1])
    models = {load_model(folder).version for folder in forms.MODELS.values()}
    assert {*told, orchestrate.__version__, *models} == {VERSION}
