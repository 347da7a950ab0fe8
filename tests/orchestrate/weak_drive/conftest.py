"""What the tests of weak drives share."""

import pytest

from orchestrate.running.runner import compute_dataset
from orchestrate.weak_drive import cosimulate


@pytest.fixture
def here(monkeypatch):
    """Drives of somebody else run in this process, not each in one of its own."""
    monkeypatch.setattr(
        cosimulate,
        "compute_dataset",
        lambda job, *known, foreign=0: compute_dataset(job, *known[:2]),
    )
