"""A folder as a reader has it: the FMUs in ``build/``, nothing else."""

import pytest

import orchestrate
from orchestrate.show.style import STYLE

from .smaller import QUESTIONS, smaller


@pytest.fixture
def folder(exported, tmp_path, monkeypatch):
    """Where the reader works."""
    (tmp_path / "build").symlink_to(exported, target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def coarse(monkeypatch):
    """Pictures are coarse."""
    monkeypatch.setitem(STYLE, "savefig.dpi", 20)


@pytest.fixture
def small(monkeypatch, coarse):
    """All questions are small ones too."""
    for name in QUESTIONS:
        if name in orchestrate.__all__:
            monkeypatch.setattr(orchestrate, name, smaller(getattr(orchestrate, name)))
