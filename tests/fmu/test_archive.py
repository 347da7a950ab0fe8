"""The FMU as a file: reproducible, named by its contents, valid, complete, and without a trace of
the machine that made it.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from importlib import metadata
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu

from fmu_src.export import forms, pythonfmu_form
from fmu_src.export.errors import CannotExport

from ..fresh import ROOT
from .copies import copy_sources, export_copy
from .driver import FMUS, MODELS, OSCILLATOR, path_of
from .programs.driver import describe, open_fmu

PYTHON = FMUS["fmi2-python"]
BUILD = 'extra == "build"'


def contents(fmu):
    """Files of an FMU by name."""
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_two_exports_are_the_same_bytes(tmp_path, monkeypatch):
    """Of the same sources, from different places and surroundings; no other GUID either."""
    first = export_copy(tmp_path, PYTHONHASHSEED="2", TZ="Asia/Tokyo", LC_ALL="C.UTF-8")
    assert fmpy.read_model_description(str(first)).guid == describe(PYTHON).guid

    def no_compiler(*_):
        raise CannotExport("not wanted here")

    monkeypatch.setattr(pythonfmu_form, "link_all", no_compiler)
    second = forms.export(OSCILLATOR, forms.PYTHON_FORM, tmp_path / "here")
    assert first.read_bytes() == second.read_bytes()


def test_guid_belongs_to_the_sources(changed):
    """Another number in the table, another GUID and other names of modules. Which files count is
    for tests/export.
    """
    assert fmpy.read_model_description(str(changed)).guid != describe(PYTHON).guid
    ours = {name for name in contents(changed) if re.match(r"resources/(fmu_|TwoMass)", name)}
    assert ours and not ours & set(contents(PYTHON))


def other_pythons():
    """Interpreters of other versions than this one that can build: by pyenv, or on the path."""
    ours = f"{sys.version_info.major}.{sys.version_info.minor}"
    versions = [f"3.{minor}" for minor in range(10, 15) if f"3.{minor}" != ours]
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    found = [[*pyenv.glob(f"{v}.*/bin/python"), shutil.which(f"python{v}")] for v in versions]
    return [path for paths in found for path in paths if path and runs(path)]


def runs(python):
    """Whether an interpreter is there: pyenv has names on the path for versions not chosen."""
    return subprocess.run([python, "--version"], capture_output=True).returncode == 0


def built(python, root):
    """The oscillator in the native forms and the one by pythonfmu, from the sources in ``root``."""
    forms = ("fmi2-python", "fmi2", "fmi3-plain")
    program = (
        "import sys; from pathlib import Path; from fmu_src.export.forms import export\n"
        "for form in sys.argv[1:]: export('TwoMassImpactOscillator', form, Path('made'))"
    )
    subprocess.run([python, "-c", program, *forms], cwd=root, check=True)
    return {form: root / "made" / form / "TwoMassImpactOscillator.fmu" for form in forms}


@pytest.fixture(scope="module")
def complete(tmp_path_factory):
    """FMUs with everything compiled."""
    return built(sys.executable, copy_sources(tmp_path_factory.mktemp("complete")))


@pytest.mark.slow
def test_two_complete_builds_are_the_same_bytes(complete, tmp_path):
    """In different folders, by the same version of Python."""
    again = built(sys.executable, copy_sources(tmp_path / "another place"))
    for form, path in complete.items():
        assert again[form].read_bytes() == path.read_bytes(), form


@pytest.mark.slow
def test_another_python_makes_the_same_files(complete, tmp_path):
    """Binaries included: the kernel is translated from its text."""
    others = other_pythons()
    if not others:
        pytest.skip("there is no other Python from 3.10 to 3.14")
    subprocess.run([others[-1], "-m", "venv", tmp_path / "environment"], check=True)
    python = tmp_path / "environment" / "bin" / "python"
    needed = [line.split(";")[0] for line in metadata.requires("vibroimpact") if BUILD in line]
    subprocess.run([python, "-m", "pip", "install", "-q", "fmpy", "jinja2", *needed], check=True)
    for form, other in built(python, copy_sources(tmp_path / "sources")).items():
        ours, theirs = contents(complete[form]), contents(other)
        assert list(ours) == list(theirs)
        assert not [name for name in ours if ours[name] != theirs[name]], form


@pytest.mark.parametrize("model", MODELS)
def test_fmpy_finds_no_problem(model, form):
    assert validate_fmu(str(path_of(model, form))) == []


def test_documentation_is_inside(fmu):
    """A page that explains every variable promised, an icon, reference results."""
    files = contents(fmu)
    page = files["documentation/index.html"].decode()
    found = fmpy.read_model_description(str(fmu))
    for variable in found.modelVariables:
        if (
            variable.causality in ("parameter", "input", "output")
            and variable.type != "Clock"
            and not variable.dimensions
        ):
            assert re.search(rf"\b{variable.name}\b", page), variable.name
    for picture in re.findall(r'(?:src|data|href)="([^":#]+\.(?:png|svg|csv))"', page):
        assert (
            f"documentation/{picture}" in files or str(Path("documentation", picture)) in files
        ), picture
    icon = "terminalsAndIcons/icon.png" if fmu.parent.name == "fmi3" else "model.png"
    assert files[icon].startswith(b"\x89PNG")
    reference = [
        name
        for name in files
        if name.startswith("documentation/reference/") and name.endswith("_ref.csv")
    ]
    assert reference
    assert all(len(files[name].splitlines()) > 10 for name in reference)


def table(data):
    """Names and rows of a CSV file."""
    head, *lines = data.decode().split()
    return head.split(","), [[float(cell) for cell in line.split(",")] for line in lines]


@pytest.mark.parametrize("model", MODELS)
def test_reference_results_are_what_the_fmu_gives(model, form):
    """The table in documentation/reference, recomputed at its own times with its own inputs."""
    path = path_of(model, form)
    files = contents(path)
    place = f"documentation/reference/{model}"
    (_, *inputs), settings = table(files[f"{place}_in.csv"])
    (time_name, *names), rows = table(files[f"{place}_ref.csv"])
    assert time_name == "time" and len(rows) > 100

    def values(time):
        return dict(zip(inputs, [row for row in settings if row[0] <= time][-1][1:], strict=True))

    f = open_fmu(path).start(rows[0][0], **values(rows[0][0]))
    for time, *expected in rows:
        if time > rows[0][0]:
            f.step(time)
        assert f.get(*names) == pytest.approx(expected, rel=1e-9, abs=1e-12), time
        f.set(**values(time))


def test_no_path_of_the_machine_is_inside(fmu):
    """No file but pythonfmu's own binaries says where it was made."""
    places = {
        "/work/",
        "/root/",
        "/home/",
        "/tmp/",
        str(ROOT),
        str(Path.home()),
        sys.prefix,
        tempfile.gettempdir(),
    }
    for name, data in contents(fmu).items():
        if "python" in fmu.parent.name and name.startswith("binaries/"):
            continue
        for place in places - {"/"}:
            assert place.encode() not in data, (name, place)


def test_compiled_kernel_stands_alone(tmp_path):
    """Nothing outside itself but memset: it runs with every C library."""
    name, data = next(
        (n, d) for n, d in contents(PYTHON).items() if re.search(r"kernel-x86_64-linux\.so$", n)
    )
    (tmp_path / "kernel.so").write_bytes(data)
    nm = ["nm", "-D", "--undefined-only", "kernel.so"]
    try:
        done = subprocess.run(nm, cwd=tmp_path, capture_output=True, text=True, check=True)
    except FileNotFoundError:
        pytest.skip("no nm here")
    symbols = {
        line.split()[-1].split("@")[0] for line in done.stdout.splitlines() if " w " not in line
    }
    assert symbols <= {"memset"}, name
    defined = subprocess.run(
        ["nm", "-D", "--defined-only", "kernel.so"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert {line.split()[-1] for line in defined.splitlines() if " T " in line} == {
        "initialize",
        "advance",
        "coast",
        "differentiate",
        "restore",
    }
