"""The FMUs, and importers compiled for them once a session."""

import importlib.util
import sys
from types import SimpleNamespace

import pytest

from fmu_src.export import compiler
from fmu_src.export.forms import FORMS
from tests import importers

from ..exports import guid_inside, refresh
from ..fmu.programs.driver import free_all

VERSIONS = ("fmi2", "fmi3")


def cannot(reason):
    """Skip where the tools are missing; where they are there and fail, so does the test."""
    if importlib.util.find_spec("ziglang") is None:
        pytest.skip(f"ziglang missing: {reason}")
    text = "a new version of ziglang breaks the way the native FMUs are made"
    pytest.fail(f"{text}: {reason}", pytrace=False)


@pytest.fixture(scope="session")
def fmus(exported):
    paths = {form: exported / form / "TwoMassImpactOscillator.fmu" for form in FORMS}
    if not all(guid_inside(path) for path in paths.values()):
        cannot(next(iter(refresh(exported).values()), "no reason given"))
    return paths


@pytest.fixture
def hide(monkeypatch):
    """A function that takes a C compiler away from the exporter: ``"ziglang"``, or ``"own"``, the
    machine's.
    """
    compiler.warn_once.cache_clear()

    def away(*names):
        if "ziglang" in names:
            util = SimpleNamespace(find_spec=lambda _: None)
            monkeypatch.setattr(compiler, "importlib", SimpleNamespace(util=util))
        if "own" in names:
            monkeypatch.setattr(compiler, "shutil", SimpleNamespace(which=lambda _: None))

    yield away
    compiler.warn_once.cache_clear()


@pytest.fixture(scope="session")
def importer_of(fmus, tmp_path_factory):
    """A function from FMI version to the compiled importer with the FMU's own binary."""
    made = {}
    if sys.platform != "linux":
        pytest.skip("the importers are run on Linux")

    def make(version):
        if importers.c_compiler() is None:
            pytest.skip("there is no C compiler")
        if version not in made:
            folder = tmp_path_factory.mktemp(version)
            made[version] = importers.importer(version, fmus[version], folder)
        return made[version]

    return make


@pytest.fixture(params=VERSIONS)
def version(request):
    return request.param


@pytest.fixture
def importer(version, importer_of):
    return importer_of(version)


@pytest.fixture(autouse=True)
def instances():
    """No instance outlives its test."""
    yield
    free_all()
