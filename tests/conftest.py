"""What all tests share: the exported FMU, made once before any worker starts."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build"


def pytest_configure(config):
    """Export the FMUs where they are missing or out of date."""
    if not hasattr(config, "workerinput"):
        from orchestrate.build import refresh

        refresh(BUILD)


@pytest.fixture(scope="session")
def python_fmu():
    """The pythonfmu FMU."""
    return BUILD / "fmi2-python" / "TwoMassImpactOscillator.fmu"
