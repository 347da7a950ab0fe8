"""The FMUs, and importers compiled for them once a session."""

import functools
import sys
from importlib.util import find_spec
from types import SimpleNamespace

import pytest

from fmu_src.export import compiler
from tests import importers

from ..exports import refresh
from ..fmu.driver import FMUS, OSCILLATOR, VERSIONS, path_of


@pytest.fixture(scope="session")
def fmus(exported):
    """The oscillator's FMUs by form; what can be made here and is not has ended the run before."""
    missing = [form for form, path in FMUS.items() if not path.exists()]
    if missing:
        reason = next(iter(refresh(exported).values()), "no reason given")
        end = pytest.fail if find_spec("ziglang") else pytest.skip
        end(f"cannot make {', '.join(missing)}: {reason}")
    return FMUS


@pytest.fixture
def hide(monkeypatch):
    """A function that hides ``"ziglang"``, or ``"own"``, the machine's C compiler."""
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
    """A function from FMI version and model to the compiled importer with the FMU's binary."""
    if sys.platform != "linux" or not importers.c_compiler():
        pytest.skip("the importers are compiled and run on Linux")

    @functools.cache
    def make(version, model=OSCILLATOR):
        path = path_of(model, version)
        return importers.importer(version, path, tmp_path_factory.mktemp(version))

    return make


@pytest.fixture(params=VERSIONS)
def version(request):
    return request.param


@pytest.fixture
def importer(version, importer_of):
    return importer_of(version)
