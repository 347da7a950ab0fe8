"""The files an FMU is made of are those that its modules import; nothing else decides its GUID."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fmu_src.export import forms, pythonfmu_form, sources
from fmu_src.export.errors import CannotExport
from tests import ROOT

IMPORTING = """
import importlib, sys
for name in sys.argv[1:]:
    importlib.import_module(name)
    print(*(m.__file__ for name, m in sys.modules.items() if name.split(".")[0] == "fmu_src"))
"""


@pytest.mark.parametrize("folder", forms.MODELS.values())
def test_a_model_and_the_embedded_package_are_made_of_what_they_import(folder):
    """By what a fresh process runs that imports the model, and then the slave."""
    modules = f"fmu_src.models.{folder}.model", "fmu_src.runtime.slave"
    command = [sys.executable, "-c", IMPORTING, *modules]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    model, package = (
        {Path(file).relative_to(sources.ROOT).as_posix() for file in line.split()}
        for line in done.stdout.splitlines()
    )
    assert sources.model_sources(folder).keys() == model
    assert pythonfmu_form.embedded_sources(folder).keys() == package
    kernels = {name.split("/")[1] for name in model if name.startswith("kernels/")}
    assert kernels == {"__init__.py", "numerics", folder}


def statements(node):
    """A tree's statements, and those inside them: what is smaller has none."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.stmt, ast.excepthandler, ast.match_case)):
            yield child
            yield from statements(child)


def test_no_import_of_ours_is_overlooked():
    """A file's imports are read without the tree of the rest of it."""
    for path in [*(ROOT / "fmu_src").rglob("*.py"), *(ROOT / "orchestrate").rglob("*.py")]:
        source, imports = path.read_bytes(), (ast.Import, ast.ImportFrom)
        nodes = {ast.unparse(n) for n in statements(ast.parse(source)) if isinstance(n, imports)}
        assert nodes <= {*map(ast.unparse, sources.import_statements(source))}, path


@pytest.mark.parametrize("form", forms.FORMS)
def test_a_change_of_any_source_is_another_guid(monkeypatch, form):
    """Kernel, table, texts, exporter and C shim; another form's or model's is none of them."""
    name, python = "TwoMassImpactOscillator", form == forms.PYTHON_FORM
    before, read = forms.fmu_guid(name, form), Path.read_bytes
    for changed, same in (
        ("kernels/numerics/elementary.py", False),
        ("models/oscillator/variables.py", False),
        ("export/compiler.py", False),
        ("runtime/native/core.c", False),
        ("models/form.html.in", False),
        ("models/license.txt", False),
        ("models/oscillator/documentation/index.html.in", False),
        ("models/oscillator/reference/TwoMassImpactOscillator_ref.csv", False),
        ("models/motor_shaker/documentation/index.html.in", True),
        ("kernels/motor_shaker/stepper.py", True),
        ("export/pythonfmu_form.py", not python),
        ("runtime/slave.py", not python),
    ):

        def altered(path, changed=changed):
            return read(path) + (b"#" if path == sources.ROOT / changed else b"")

        monkeypatch.setattr(Path, "read_bytes", altered)
        assert (forms.fmu_guid(name, form) == before) == same, changed


def test_sources_edited_during_an_export_are_named(monkeypatch, tmp_path):
    """And no FMU of two readings is written."""
    read = Path.read_bytes
    place = sources.ROOT / "kernels/oscillator/impact.py"

    def edited_meanwhile(*_):
        monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + b"#" * (path == place))
        return {}

    monkeypatch.setattr(pythonfmu_form, "compile_libraries", edited_meanwhile)
    with pytest.raises(CannotExport, match=f"^{place} was edited .*: expected a new process$"):
        forms.export("TwoMassImpactOscillator", "fmi2-python", tmp_path)
    assert not list(tmp_path.rglob("*.fmu"))
