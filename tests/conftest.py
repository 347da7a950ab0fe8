"""What all tests share: the FMUs, exported when the first test needs them, and no clock.

Property tests take the same examples on every machine, however slow: campaigns look for others.
"""

import pytest
from hypothesis import settings

from .exports import BUILD, refresh
from .fmu.programs.driver import Fmu2

settings.register_profile("the same everywhere", deadline=None, derandomize=True, database=None)
settings.load_profile("the same everywhere")


def pytest_addoption(parser):
    """Declare what a campaign takes: ``pytest tests/campaigns -m slow --seed 95 --budget 2000``."""
    parser.addoption("--seed", type=int, default=1, help="of all that a campaign draws")
    parser.addoption("--budget", type=int, help="units that a campaign does; else its own few")


@pytest.fixture(scope="session")
def exported(tmp_path_factory):
    """The build folder, with all FMUs that can be made here, of the present sources."""
    refresh(BUILD)
    Fmu2.home = tmp_path_factory.mktemp("extracted")
    return BUILD


@pytest.fixture(scope="session")
def python_fmu(exported):
    """The oscillator's FMU by pythonfmu."""
    return exported / "fmi2-python" / "TwoMassImpactOscillator.fmu"
