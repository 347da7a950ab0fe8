"""The C inside the FMUs: what a bare compiler makes of it, and that it defends its bits."""

import platform
import re
import shutil
import subprocess
import sys
import zipfile
from xml.etree import ElementTree as ET

import fmpy
import pytest
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu

from fmu_src.export import compiler, forms

from ..fmu.driver import OSCILLATOR, VERSIONS
from ..fmu.programs.driver import harmonic
from ..sparing import ordinary
from .test_bit_identity import run

GCC = shutil.which("gcc")
BARE = ("-std=c99", "-ffp-contract=off")
FAST = ("-O1", "-ffast-math", "-mfma")
FOLDERS = {"fmi2": "linux64", "fmi3": "x86_64-linux"}
pytestmark = pytest.mark.skipif(
    GCC is None or (sys.platform, platform.machine()) != ("linux", "x86_64"),
    reason="expected Linux on x86-64 with gcc",
)


def unpacked(fmu, folder):
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    shutil.rmtree(folder / "binaries", ignore_errors=True)
    return folder


def packed(folder):
    shutil.make_archive(str(folder), "zip", folder)
    return folder.with_suffix(".zip").rename(folder.with_suffix(".fmu"))


def compiled(folder, version, *flags):
    """The folder as an FMU with a library made of its own sources, and what gcc has to say."""
    target = folder / "binaries" / FOLDERS[version] / f"{OSCILLATOR}.so"
    target.parent.mkdir(parents=True)
    command = [GCC, *flags, "-shared", "-fPIC", *(folder / "sources").glob("*.c"), "-o", target]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return packed(folder), done.stderr


def rows(fmu, folder):
    """Common outputs through chaos, as hexadecimal numbers."""
    return run(fmu, folder, 2048.0, 32, harmonic(1.13))["rows"]


@pytest.fixture(scope="module")
def reference(fmus, tmp_path_factory):
    return rows(fmus["fmi2"], tmp_path_factory.mktemp("reference") / "run")


@pytest.mark.slow
@pytest.mark.parametrize("flags", [FAST, ("-Ofast", "-mfma"), ("-O0",), ("-O3", "-march=native")])
def test_fast_options_change_no_bit(fmus, flags, tmp_path, reference):
    """The sources say what gcc may not do."""
    fmu, _ = compiled(unpacked(fmus["fmi2"], tmp_path / "fmu"), "fmi2", *flags)
    assert rows(fmu, tmp_path / "run") == reference


@pytest.mark.parametrize("version", ordinary(FOLDERS))
def test_other_bits_are_refused_at_instantiation(fmus, version, tmp_path):
    """A compiler that is asked to be fast, and does not know what the sources say to gcc."""
    folder = unpacked(fmus[version], tmp_path / "fmu")
    kernel = folder / "sources" / "kernel.c"
    lines = kernel.read_text("utf-8").splitlines(keepends=True)
    kernel.write_text("".join(line for line in lines if "GCC optimize" not in line), "utf-8")
    fmu, _ = compiled(folder, version, *FAST)
    # in a process of its own: gcc lets such a library flush small numbers to 0 in the whole process
    program = (
        "import fmpy, sys; fmpy.simulate_fmu(sys.argv[1], logger=lambda *args: print(args[-1]))"
    )
    command = [sys.executable, "-c", program, str(fmu)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode != 0 and "nstantiate" in done.stderr
    assert "numbers differ from the model's in their last digits: compile it with" in done.stdout


def test_the_description_names_the_sources(fmus):
    """All that is compiled, and nothing else: FMI 2.0 in the model description, 3.0 beside it."""
    for form, description, tag in (
        ("fmi2", "modelDescription.xml", "File"),
        ("fmi3", "sources/buildDescription.xml", "SourceFile"),
    ):
        with zipfile.ZipFile(fmus[form]) as archive:
            told = [f.get("name") for f in ET.fromstring(archive.read(description)).iter(tag)]
            inside = {n for n in archive.namelist() if re.fullmatch(r"sources/.*\.c", n)}
        assert sorted(f"sources/{name}" for name in told) == sorted(inside)


@pytest.fixture(scope="module")
def without_binaries(tmp_path_factory):
    """The FMUs for targets that compile, by form, made where there is no compiler."""
    build = tmp_path_factory.mktemp("sources")
    wanted = forms.source_forms_of(forms.FORMS + forms.PLAIN_FORMS)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiler, "run_compiler", None)
        return {form: forms.export(OSCILLATOR, form, build) for form in wanted}


def test_each_form_has_a_guid_of_its_own(without_binaries):
    """No FMU of sources alone is taken for one that can be run as it is."""
    expected = {f"fmi{n}{plain}-sources" for n in (2, 3) for plain in ("", "-plain")}
    assert set(without_binaries) == expected
    assert len({forms.fmu_guid(OSCILLATOR, form) for form in forms.ALL_FORMS}) == 9


def test_a_description_of_sources_alone_is_true(without_binaries, fmus):
    """No binary, nothing else missing, the capabilities of the FMU with binaries."""
    for form, path in without_binaries.items():
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            page = archive.read("documentation/index.html").decode()
        assert not [name for name in names if name.startswith("binaries/")]
        assert "sources/kernel.c" in names and "there is no binary inside" in page
        assert validate_fmu(str(path)) == []
        found = fmpy.read_model_description(str(path))
        assert found.guid == forms.fmu_guid(OSCILLATOR, form)
        if "plain" not in form:
            whole = fmpy.read_model_description(str(fmus[form[:4]]))
            assert repr(found.coSimulation) == repr(whole.coSimulation)
            assert not found.coSimulation.needsExecutionTool


@pytest.mark.parametrize("form", ordinary(["fmi2-plain-sources", "fmi3-sources", "fmi2-sources"]))
def test_a_bare_compiler_makes_the_bits_of_the_binary(without_binaries, form, tmp_path, reference):
    """And no name is exported that is not FMI's: the C library has functions of the same names."""
    version = form[:4]
    folder = unpacked(without_binaries[form], tmp_path / "fmu")
    fmu, warnings = compiled(folder, version, *BARE, "-Wall", "-Wextra")
    assert warnings == ""
    library = folder / "binaries" / FOLDERS[version] / f"{OSCILLATOR}.so"
    table = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True)
    names = [line.split()[-1] for line in table.stdout.splitlines()]
    assert names and all(name.startswith(version) for name in names)
    assert rows(fmu, tmp_path / "run") == reference


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
def test_fmpy_and_cmake_make_libraries(fmus, version, tmp_path, reference):
    """FMPy's own way through CMake, and the CMakeLists.txt inside."""
    if shutil.which("cmake") is None:
        pytest.skip("no cmake")
    folder = unpacked(fmus[version], tmp_path / "fmu")
    subprocess.run(["cmake", "-S", folder / "sources", "-B", tmp_path / "made"], check=True)
    subprocess.run(["cmake", "--build", tmp_path / "made"], check=True)
    assert (tmp_path / "made" / f"{OSCILLATOR}.so").is_file()
    build_platform_binary(folder)
    assert rows(packed(folder), tmp_path / "run") == reference
