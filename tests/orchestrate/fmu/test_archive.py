"""An FMU that an enemy made is refused before anything of it is unpacked."""

from __future__ import annotations

import random

import pytest

from orchestrate.errors import InputError
from orchestrate.fmu import OSCILLATOR, describe, find
from tests.campaigns import archives

REFUSED = ("path traversal", "link", "bomb", "crowd of files", "a name twice", "no FMU")


@pytest.fixture(scope="module")
def good(exported):
    return find(OSCILLATOR).path


@pytest.mark.parametrize("kind", REFUSED[:-1])
def test_an_enemys_archive_is_refused_in_a_line(good, tmp_path, monkeypatch, kind):
    monkeypatch.setattr("orchestrate.fmu.description.MAX_BYTES", 1 << 26)
    monkeypatch.setattr(archives, "BOMB", 1 << 27)
    monkeypatch.setattr(archives, "CROWD", 10_001)
    for seed in range(1 if kind in ("bomb", "crowd of files") else 4):
        archives.write(kind, good, tmp_path / "bad.fmu", random.Random(seed))
        with pytest.raises(InputError, match="not readable as an FMU") as told:
            describe(tmp_path / "bad.fmu")
        assert len(str(told.value).splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["bad.fmu"]
