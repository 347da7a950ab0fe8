"""Tests never run on FMUs of other sources."""

import importlib.util

from .exports import unexpected


def test_an_fmu_that_is_left_behind_or_could_be_made_ends_the_run(tmp_path, monkeypatch):
    (tmp_path / "fmi2").mkdir()
    (tmp_path / "fmi2" / "Old.fmu").touch()
    reasons = {"fmi2/Old": "why", "fmi2/Other": "why"}
    assert unexpected(reasons, tmp_path) == reasons
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert unexpected(reasons, tmp_path) == {"fmi2/Old": "why"}
