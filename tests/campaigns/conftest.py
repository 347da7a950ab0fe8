"""Seed and budget of a campaign, and the FMU that is attacked."""

from pathlib import Path

import pytest

from orchestrate.fmu import OSCILLATOR, find_or_export


@pytest.fixture
def seed(request: pytest.FixtureRequest) -> int:
    return int(request.config.getoption("--seed"))


@pytest.fixture
def budget(request: pytest.FixtureRequest) -> int:
    """Number of units to do: of the option, or of the campaign's mark."""
    default = request.node.get_closest_marker("budget").args[0]
    return int(request.config.getoption("--budget") or default)


@pytest.fixture(scope="session")
def fmu(exported: Path) -> Path:
    return find_or_export(OSCILLATOR).path
