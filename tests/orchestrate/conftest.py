"""What the tests of the orchestration share: a place for sweeps, and one uninterrupted run."""

import pytest

from ..conftest import BUILD
from .command import Sweeps

RUN = ("--eta", "1:1.5:0.002", "--transient", "20", "--samples", "100")  # chaotic ranges included: a wrong start is seen
ROWS = 251


FORMS = ("fmi2-python", "fmi2", "fmi3")


def exported(form):
    """The oscillator's FMU of a form; native ones are not made everywhere."""
    path = BUILD / form / "TwoMassImpactOscillator.fmu"
    return path if path.is_file() else None


@pytest.fixture(scope="session")
def fmu(python_fmu):
    """The FMU that sweeps take by themselves: the native one where there is one."""
    return exported("fmi2") or python_fmu


@pytest.fixture(params=FORMS)
def any_fmu(request):
    """Every form of the FMU in turn."""
    return exported(request.param) or pytest.skip(f"no {request.param} here")


@pytest.fixture
def sweeps(tmp_path, fmu):
    """Sweep commands in a folder of the test's own."""
    commands = Sweeps(tmp_path, fmu)
    yield commands
    commands.clean_up()


@pytest.fixture(scope="session")
def uninterrupted(tmp_path_factory, fmu):
    """Bytes of the result file of RUN, computed in one go."""
    commands = Sweeps(tmp_path_factory.mktemp("uninterrupted"), fmu)
    try:
        commands.run(*RUN).success()
        return commands.result().read_bytes()
    finally:
        commands.clean_up()
