"""Every example in a docstring runs and prints what it says."""

import doctest
from importlib import import_module

import pytest

from tests import ROOT

from ..sparing import ordinary

MODULES = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    for path in sorted((ROOT / "orchestrate").rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]
LONG = {
    *(f"orchestrate.diagnosis.{name}" for name in ("detect", "fit", "plan_test", "signs")),
    *(f"orchestrate.dynamics.{name}" for name in ("borders", "orbits", "branches", "manifolds")),
    *("orchestrate.dynamics.stable_windows", "orchestrate.show.report"),
    "orchestrate.laboratory.record_of_run",
    *(f"orchestrate.weak_drive.{name}" for name in ("couple_all", "drive_branch", "jump_voltages")),
}


@pytest.mark.parametrize("module", ordinary(MODULES, set(MODULES) - LONG))
def test_examples(module, exported, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE | doctest.IGNORE_EXCEPTION_DETAIL
    found = doctest.testmod(import_module(module), optionflags=flags)
    assert found.attempted > 0
    assert found.failed == 0
