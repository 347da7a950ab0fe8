"""The FMU as a file: valid, complete, and without a trace of the machine that made it."""

import re
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree as ET

import fmpy
import pytest
from fmpy.validation import validate_fmu

from tests import ROOT

from .driver import FMUS, MODELS, path_of
from .programs.driver import open_fmu

PYTHON = FMUS["fmi2-python"]


def contents(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.mark.parametrize("model", MODELS)
def test_fmpy_finds_no_problem(model, form):
    assert validate_fmu(str(path_of(model, form))) == []


def test_documentation_is_inside(fmu):
    """A page that explains every variable promised, an icon."""
    files, found = contents(fmu), fmpy.read_model_description(str(fmu)).modelVariables
    page = files["documentation/index.html"].decode()
    promised = [v for v in found if v.causality in ("parameter", "input", "output")]
    names = [v.name for v in promised if v.type != "Clock" and not v.dimensions]
    assert [name for name in names if not re.search(rf"\b{name}\b", page)] == []
    icon = "terminalsAndIcons/icon.png" if fmu.parent.name == "fmi3" else "model.png"
    assert files[icon].startswith(b"\x89PNG")


def table(data):
    head, *lines = data.decode().split()
    return head.split(","), [[float(cell) for cell in line.split(",")] for line in lines]


@pytest.mark.parametrize(("model", "form"), [*zip(MODELS, FMUS, strict=True)])
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
    places = {"/work/", "/root/", "/home/", "/tmp/", str(ROOT), str(Path.home()), sys.prefix}
    for name, data in contents(fmu).items():
        if "python" in fmu.parent.name and name.startswith("binaries/"):
            continue
        for place in places - {"/"}:
            assert place.encode() not in data, (name, place)


@pytest.mark.parametrize("drive", ["MotorShaker", "ElectrodynamicShaker"])
def test_terminals_of_both_models_fit_together(exported, drive):
    """An output here, an input of the same unit there; the structure has more, for others."""
    sides = []
    for name in ("TwoMassImpactOscillator", drive):
        path = exported / "fmi3" / f"{name}.fmu"
        found = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
        with zipfile.ZipFile(path) as opened:
            root = ET.fromstring(opened.read("terminalsAndIcons/terminalsAndIcons.xml"))
            assert opened.read("terminalsAndIcons/icon.png").startswith(b"\x89PNG")
        (terminal,) = root.findall("Terminals/Terminal")
        members = terminal.findall("TerminalMemberVariable")
        sides.append({m.get("memberName"): found[m.get("variableName")] for m in members})
    one, other = sides
    assert set(other) == {"force", "acceleration", "jerk"} < set(one)
    more = ("snap", "crackle", "impulse", "impulse_moment")
    assert {m: one[m].name for m in set(one) - set(other)} == {m: f"box_{m}" for m in more}
    for member, variable in ((m, one[m]) for m in other):
        assert {variable.causality, other[member].causality} == {"input", "output"}
        assert variable.unit == other[member].unit
