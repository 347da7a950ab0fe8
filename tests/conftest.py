"""What all tests share: the FMUs, exported when the first test needs them, and no clock.

Property tests take the same examples on every machine, however slow: campaigns look for others.
"""

import gc
import math

import pytest
from hypothesis import HealthCheck, settings

from orchestrate.running import runner

from . import held_files
from .exports import BUILD, refresh, unexpected
from .fmu.programs.driver import Fmu2, free_all

alike = {"deadline": None, "derandomize": True, "database": None}
everywhere = settings(**alike, suppress_health_check=list(HealthCheck))
settings.register_profile("few", everywhere, max_examples=10)
settings.register_profile("many", everywhere, max_examples=100)
settings.load_profile("few")


def pytest_configure(config):
    """The slow run takes many examples of each property; the ordinary one few, and all processors
    are at work there: a test starts no workers of its own.
    """
    if config.option.markexpr == "slow":
        settings.load_profile("many")
    else:
        runner.MIN_PARALLEL_SECONDS = math.inf
    if config.option.held_files:
        held_files.install()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """Properties run in the slow run too."""
    if config.option.markexpr == "slow":
        for item in items:
            if getattr(getattr(item, "function", None), "is_hypothesis_test", False):
                item.add_marker(pytest.mark.slow)


def pytest_collection_finish():
    """What is collected stays: the garbage collector need not look at it again."""
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


def pytest_addoption(parser):
    """Declare what a campaign takes: ``pytest tests/campaigns -m slow --seed 95 --budget 2000``."""
    parser.addoption("--seed", type=int, default=1, help="of all that a campaign draws")
    text = "open files cannot be removed or replaced, as on Windows"
    parser.addoption("--held-files", action="store_true", help=text)
    parser.addoption("--budget", type=int, help="units that a campaign does; else its own few")


@pytest.fixture(scope="session")
def exported(request, tmp_path_factory):
    """The build folder, with all FMUs that can be made here, of the present sources.

    What can be made and is not ends the run: tests of an older FMU say nothing of these sources.
    """
    if reasons := unexpected(refresh(BUILD), BUILD):
        text = "; ".join(f"{place}: {reason}" for place, reason in reasons.items())
        request.session.shouldfail = f"cannot export {text}"  # of workers too
        pytest.fail(request.session.shouldfail, pytrace=False)
    Fmu2.home = tmp_path_factory.mktemp("extracted")
    return BUILD


@pytest.fixture(autouse=True)
def instances():
    """No instance of an FMU outlives its test."""
    yield
    free_all()


@pytest.fixture(scope="session")
def python_fmu(exported):
    return exported / "fmi2-python" / "TwoMassImpactOscillator.fmu"
