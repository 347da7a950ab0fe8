"""The README's variable tables are the FMUs'."""

import pytest

from orchestrate.assets import REFERENCES, variable_table, with_table

from ..conftest import BUILD
from .command import ROOT


@pytest.mark.parametrize("reference", REFERENCES, ids=lambda reference: reference.model)
def test_variable_table(reference):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert with_table(text, reference, variable_table(BUILD / "fmi2" / f"{reference.model}.fmu")) == text
