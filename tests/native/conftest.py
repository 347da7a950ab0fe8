"""The FMUs, and importers compiled for them once a session."""

import sys
from types import SimpleNamespace

import pytest

from fmu_src.export import compiler
from tests import importers

from ..fmu.driver import FMUS, VERSIONS


@pytest.fixture(scope="session")
def fmus(exported):
    """The oscillator's FMUs by form; what can be made here and is not has ended the run before."""
    if not all(path.exists() for path in FMUS.values()):
        pytest.skip("ziglang is missing")
    return FMUS


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
    if sys.platform != "linux" or not importers.c_compiler():
        pytest.skip("the importers are compiled and run on Linux")

    def make(version):
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
