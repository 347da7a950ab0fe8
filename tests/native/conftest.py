"""The FMUs, and importers compiled for them once a session."""

import sys

import pytest

from ..conftest import BUILD
from . import importers

VERSIONS = ("fmi2", "fmi3")
FORMS = ("fmi2-python", *VERSIONS)


@pytest.fixture(scope="session")
def fmus():
    """Paths of the FMUs by form; the project's conftest.py has exported what was missing or out of date."""
    paths = {form: BUILD / form / "TwoMassImpactOscillator.fmu" for form in FORMS}
    missing = [form for form, path in paths.items() if not path.is_file()]
    if missing:
        pytest.skip(f"no FMU of the form {', '.join(missing)} can be made here")
    return paths


@pytest.fixture(scope="session")
def kernel_objects(fmus):
    """The kernel compiled once more, for builds made by tests: nothing is left over from the FMUs' own build."""
    from fmu_src.export.compile_kernel import compile_objects
    from fmu_src.export.linking import NoCompiler

    compile_objects.cache_clear()
    try:
        return compile_objects("fmu_src.oscillator.model")
    except NoCompiler as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="session")
def importer_of(fmus, tmp_path_factory):
    """A function from FMI version to the compiled importer with the FMU's own binary."""
    made = {}
    if sys.platform != "linux":
        pytest.skip("the importers are run on Linux")

    def make(version):
        if importers.compiler() is None:
            pytest.skip("there is no C compiler")
        if version not in made:
            folder = tmp_path_factory.mktemp(version)
            program = importers.compile_importer(version, fmus[version], folder)
            made[version] = importers.Importer(program, importers.binary(fmus[version], version, folder), version)
        return made[version]

    return make


@pytest.fixture(params=VERSIONS)
def importer(request, importer_of):
    """The importer of each FMI version."""
    return importer_of(request.param)


@pytest.fixture(params=VERSIONS)
def native_fmu(request, fmus):
    """Path of the native FMU of each FMI version."""
    return fmus[request.param]
