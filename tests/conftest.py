"""What all tests share: the FMUs, exported when the first test needs them."""

import pytest

from .exports import BUILD, refresh


@pytest.fixture(scope="session")
def exported():
    """The build folder, with all FMUs that can be made here, of the present sources."""
    refresh(BUILD)
    return BUILD


@pytest.fixture(scope="session")
def python_fmu(exported):
    """The oscillator's FMU by pythonfmu."""
    return exported / "fmi2-python" / "TwoMassImpactOscillator.fmu"
