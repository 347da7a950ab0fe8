"""The SSP package in other tools: read, run, and wrong by what their fixed step explains."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from lxml import etree
from pythonfmu import FmuBuilder

from orchestrate import Shaker, Structure, cosimulate
from orchestrate.errors import InputError
from orchestrate.weak_drive.connection import OURS
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.ssp import NAMESPACES, write_ssp

from ...sparing import ordinary
from .coupled import QUICK, master, rest
from .drives import exciter, table

VOLTAGE, SPEED, TIME = 1.5, 1.25, 20.0
TOOLS = ("fmpy", "ecospy", "libcosimpy")
BEAM = Structure(m1=0.5, m2=0.4, k1=300.0, k2=420.0, d1=0.4, d2=0.5, e=0.6)
SHAKER = Shaker.from_file("shaker_1kN")
SYSTEMS = {
    **{"bonded": QUICK.as_bonded(), "delaminated": QUICK},
    "pressed": QUICK.with_structure(clearance=-1.0),
}
SPACE = {name: NAMESPACES[name] for name in ("ssd", "ssc", "ssv")}


def run(tool, path, step, shown="speed", end=TIME):
    """x1, x2 and an output of the shaker at the end, as a tool finds them."""
    program = Path(__file__).with_name("run_ssp.py")
    line = [sys.executable, program, tool, path, repr(step), str(round(end / step)), shown]
    done = subprocess.run([*map(str, line)], capture_output=True, text=True, timeout=120)
    if done.returncode == 3:
        pytest.skip(f"{tool} cannot be used here: {done.stderr.strip()}")
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


CASES = [(name, tool) for name in SYSTEMS for tool in TOOLS]


@pytest.mark.parametrize(
    ("name", "tool"), ordinary(CASES, [("delaminated", "fmpy")], several_names=True)
)
def test_tools(tmp_path, name, tool):
    """Each error is of first order in the step: structure, motor and start are as written."""
    system, steps = SYSTEMS[name], (0.01, 0.005)
    path = write_ssp(tmp_path / "drive.ssp", *system, voltage=VOLTAGE, speed_start=SPEED)
    with master(system, Scheme(0.05), rest(SPEED, system.structure)) as m:
        m.run([VOLTAGE] * round(TIME / 0.05))
        expected = [m["x1"], m["x2"], m["speed"]]
    coarse, fine = (np.subtract(run(tool, path, step), expected) for step in steps)
    assert (np.abs(coarse) < 8.0 * steps[0] * np.abs(expected)).all()
    assert ((coarse / fine > 1.6) & (coarse / fine < 2.5)).all()
    assert abs(fine[0]) > 0.01 * expected[0]  # far too large a step for a tool that holds inputs


OTHERS = [("Shaker", tool) for tool in TOOLS] + [(one, "fmpy") for one in ("theirs", "pushes")]


@pytest.mark.parametrize(("kind", "tool"), ordinary(OTHERS, OTHERS[:3], several_names=True))
def test_drives_of_others_in_tools(exported, tmp_path, kind, tool):
    """Started by a constant voltage. libcosimpy does not come back from an FMU by pythonfmu."""
    drive, started, connect, shown = SHAKER, {"command": 3.0}, None, "box_acceleration"
    if kind == "theirs":
        drive, started = FmuBuilder.build_FMU(table.__file__, dest=tmp_path), {"volts": 3.0}
        connect = {"box_force": "specimen_force", "box_acceleration": "table_acc"}
        shown = "table_acc"
    elif kind == "pushes":  # a force on a half
        drive = FmuBuilder.build_FMU(exciter.__file__, dest=tmp_path, project_files=[])
        started, connect, shown = {}, {"force1": "push"}, "push"
    path, end = tmp_path / "drive.ssp", 0.4
    write_ssp(path, BEAM, drive, connect=connect, parameters=started, step=1e-3)
    more = {"inputs": started, "duration": end, "progress": False, "estimate": False}
    fine = {**connect, "box_velocity": "table_vel"} if kind == "theirs" else connect
    truth = cosimulate(BEAM, drive, connect=fine, step=1e-3 if connect else 2e-4, **more)
    expected = [float(truth[name][-1]) for name in ("x1", "x2")]
    error = np.abs(np.subtract(run(tool, path, 2.5e-4, shown, end)[:2], expected)).max()
    assert 0.0 < error < 0.05 * abs(truth.x1).max()
    assert (truth.sizes["impact"] > 2) == (kind != "pushes")


def parts(path):
    """The description and both parameter sets, by the schema that FMPy has of SSP 1.0."""
    archive, schemas = zipfile.ZipFile(path), Path(fmpy.__file__).parent / "ssp" / "schema"
    names = ["SystemStructure.ssd", "resources/oscillator.ssv", "resources/shaker.ssv"]
    trees = [etree.fromstring(archive.read(name)) for name in names]
    if trees[0].get("version") == "1.0":
        for tree, kind in zip(trees, ("Description", *["ParameterValues"] * 2), strict=True):
            xsd = etree.parse(str(schemas / f"SystemStructure{kind}.xsd"))
            etree.XMLSchema(xsd).assertValid(tree)
    assert {tree.get("version") for tree in trees} == {trees[0].get("version")}
    return trees


def test_package(tmp_path):
    """Bindings and connections of components only; Booleans where they are true; units of ports;
    the step as OMSimulator reads it; the same bytes again.
    """
    for system, word in ((QUICK, "delaminated"), (QUICK.as_bonded(), "bonded")):
        more = {"voltage": VOLTAGE, "speed_start": SPEED, "step": 4e-5}
        path, again = (write_ssp(tmp_path / f"{n}.ssp", *system, **more) for n in (word, "again"))
        assert path.read_bytes() == again.read_bytes()
        tree, *sets = parts(path)
        assert word in tree.find("ssd:System", SPACE).get("description")
        told = [one for each in sets for one in each.iterfind(".//ssv:Parameter", SPACE)]
        values = {one.get("name"): one[0].get("value") for one in told}
        assert values["voltage"] == "1.5" and values["speed_start"] == "1.25"
        assert values.get("bonded") == (None if word == "delaminated" else "true")
    components = tree.findall(".//ssd:Component", SPACE)
    assert {one.get("name"): one.get("source") for one in components} == {
        "oscillator": "resources/TwoMassImpactOscillator.fmu",
        "shaker": "resources/MotorShaker.fmu",
    }
    for name in ("Connectors", "ParameterBindings"):
        assert not tree.findall(f"ssd:System/ssd:{name}", SPACE)
    used = {
        (component.get("name"), port.get("name")): port.find("ssc:Real", SPACE).get("unit")
        for component in components
        for port in component.iterfind("ssd:Connectors/ssd:Connector", SPACE)
    }
    units = {
        unit.get("name"): dict(unit.find("ssc:BaseUnit", SPACE).attrib)
        for unit in tree.findall("ssd:Units/ssc:Unit", SPACE)
    }
    assert len(used) == 14 and set(used.values()) == set(units)
    assert used["oscillator", "box_jerk"] == used["shaker", "box_jerk"] == "m/s3"
    assert units["N"] == {"kg": "1", "m": "1", "s": "-2"}
    links = tree.findall(".//ssd:Connection", SPACE)
    ends = [(one.get("startElement"), one.get("endElement")) for one in links]
    assert set(ends) == {("oscillator", "shaker"), ("shaker", "oscillator")} and len(ends) > 2
    assert not any(len(one) for one in links)  # neither signs nor units differ
    assert {one.get("suppressUnitConversion") for one in links} == {None}
    assert all(one.get("startConnector") == one.get("endConnector") for one in links)
    (solver,) = tree.iterfind(f".//{{{NAMESPACES['oms']}}}SimulationInformation")
    assert dict(solver.attrib)["fixedStepSize"] == "0.00004"
    assert float(solver[0].get("stepSize")) == 4e-5
    annotation = tree.find("ssd:System/ssd:Annotations/ssc:Annotation", SPACE)
    assert annotation.get("type") == "org.openmodelica"


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_sign_and_unit_are_linear_transformations(tmp_path, version):
    """In place of the tool's conversion; the drive's velocity is shown, not connected."""
    connect = {"box_force": "-box_force[kN]", "box_acceleration": "-box_acceleration"}
    connect |= {"box_velocity": "box_velocity", "box_position": "box_position[mm]"}
    path = write_ssp(tmp_path / "x.ssp", BEAM, SHAKER, connect=connect, version=version)
    tree, _, values = parts(path)
    factors = {}
    for link in tree.iterfind(".//ssd:Connection", SPACE):
        (transformation,) = link
        factors[link.get("startConnector")] = float(transformation.get("factor"))
        assert link.get("suppressUnitConversion") == "true"
    assert factors == {"box_force": -1e-3, "box_acceleration": -1.0}  # end = factor * start
    shown = {one.get("name") for one in tree.iterfind(".//ssd:Component[2]//ssd:Connector", SPACE)}
    assert shown == set(connect)
    kinds = {etree.QName(value).localname for value in values.iterfind(".//ssv:Parameter/*", SPACE)}
    assert kinds - {"Boolean"} == {"Real" if version == "1.0" else "Float64"}
    for wrong in ({"box_force": "box_force", "box_velocity": "box_velocity"}, OURS):
        with pytest.raises(InputError, match="expected box_force and box_acceleration, with or"):
            write_ssp(tmp_path / "x.ssp", BEAM, SHAKER, connect=wrong)
