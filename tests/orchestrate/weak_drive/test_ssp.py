"""The SSP package in other tools: read, run, and wrong by what their fixed step explains."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.dom import minidom

import fmpy
import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssd, read_ssv
from lxml import etree
from pythonfmu import FmuBuilder

from orchestrate import Shaker, Structure, cosimulate
from orchestrate.errors import InputError, StoreError
from orchestrate.weak_drive.connection import OURS
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.ssp import NAMESPACES, write_ssp

from ...sparing import ordinary
from .coupled import QUICK, master, rest
from .drives import table

VOLTAGE, SPEED, TIME = 1.5, 1.25, 20.0
TOOLS = ("fmpy", "ecospy", "libcosimpy")
STEPS = (0.01, 0.005)


def write(folder, system, name="drive.ssp"):
    return write_ssp(folder / name, *system, voltage=VOLTAGE, speed_start=SPEED)


def run(tool, path, step, shown="speed", end=TIME):
    """x1, x2 and an output of the shaker at the end, as a tool finds them."""
    program = Path(__file__).with_name("run_ssp.py")
    line = [sys.executable, program, tool, path, repr(step), str(round(end / step)), shown]
    done = subprocess.run([*map(str, line)], capture_output=True, text=True, timeout=120)
    if done.returncode == 3:
        pytest.skip(f"{tool} cannot be used here: {done.stderr.strip()}")
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


def truth(system):
    """The same by our own master."""
    with master(system, Scheme(0.05), rest(SPEED, system.structure)) as m:
        m.run([VOLTAGE] * round(TIME / 0.05))
        return [m["x1"], m["x2"], m["speed"]]


BEAM = Structure(m1=0.5, m2=0.4, k1=300.0, k2=420.0, d1=0.4, d2=0.5, e=0.6)
SHAKER = Shaker.from_file("shaker_1kN")
SYSTEMS = {
    **{"bonded": QUICK.as_bonded(), "delaminated": QUICK},
    "pressed": QUICK.with_structure(clearance=-1.0),
}


@pytest.fixture(scope="module", params=ordinary(SYSTEMS, ["delaminated"]))
def case(request, tmp_path_factory):
    """A package, and what is true of it."""
    system = SYSTEMS[request.param]
    return write(tmp_path_factory.mktemp("ssp"), system), truth(system)


@pytest.mark.parametrize("tool", ordinary(TOOLS))
def test_tools(case, tool):
    """Each error is of first order in the step: structure, motor and start are as written."""
    path, expected = case
    errors = [
        [abs(a - b) for a, b in zip(run(tool, path, step), expected, strict=True)] for step in STEPS
    ]
    for coarse, fine, value in zip(*errors, expected, strict=True):
        assert coarse < 8.0 * STEPS[0] * value
        assert 1.6 < coarse / fine < 2.5
    assert errors[1][0] > 0.01 * expected[0]  # far too large a step for a tool that holds inputs


CASES = [("Shaker", tool) for tool in TOOLS] + [("theirs", tool) for tool in TOOLS[:2]]


@pytest.mark.parametrize(("kind", "tool"), ordinary(CASES, CASES[:3], several_names=True))
def test_drives_of_others_in_tools(exported, tmp_path, kind, tool):
    """Started by a constant voltage. libcosimpy does not come back from an FMU by pythonfmu."""
    command, drive, fine, connect = "command", SHAKER, OURS, None
    if kind == "theirs":
        drive, command = FmuBuilder.build_FMU(table.__file__, dest=tmp_path), "volts"
        connect = {"box_force": "specimen_force", "box_acceleration": "table_acc"}
        fine = {**connect, "box_velocity": "table_vel"}
    path, end, started = tmp_path / "drive.ssp", 0.4, {command: 3.0}
    write_ssp(path, BEAM, drive, connect=connect, parameters=started, step=1e-3)
    more = {"inputs": started, "duration": end, "progress": False}
    h = 2e-4 if connect is None else 1e-3
    truth = cosimulate(BEAM, drive, connect=fine, estimate=False, step=h, **more)
    expected = [float(truth[name][-1]) for name in ("x1", "x2")]
    shown = connect["box_acceleration"] if connect else "box_acceleration"
    found = [run(tool, path, h, shown, end)[:2] for h in (5e-4, 2.5e-4)]
    errors = [np.abs(np.subtract(one, expected)).max() for one in found]
    assert truth.sizes["impact"] > 2 and errors[0] < 0.1 * abs(truth.x1).max()
    assert errors[0] > 1.5 * errors[1] > 0.0


def test_package(case, tmp_path):
    """What all tools read: bindings of components, connections between components, no other."""
    path, _ = case
    system = read_ssd(str(path)).system
    assert {element.name: element.source for element in system.elements} == {
        "oscillator": "resources/TwoMassImpactOscillator.fmu",
        "shaker": "resources/MotorShaker.fmu",
    }
    assert not system.connectors
    assert not system.parameterBindings
    assert all(link.startElement and link.endElement for link in system.connections)
    for element in system.elements:
        for binding in element.parameterBindings:
            values = {p.name: p for p in read_ssv(str(path), binding.source).parameters}
            assert all(p.value == "true" for p in values.values() if p.type == "Boolean")
    assert float(values["voltage"].value) == VOLTAGE


def test_it_says_which_structure_it_is_for(tmp_path):
    for system, word in ((QUICK, "delaminated"), (QUICK.as_bonded(), "bonded")):
        path = write(tmp_path, system, f"{word}.ssp")
        description = zipfile.ZipFile(path).read("SystemStructure.ssd").decode()
        assert word in read_ssd(str(path)).system.description
        assert ("delaminated" in description) == (word == "delaminated")
        assert path.read_bytes() == write(tmp_path, system, "again.ssp").read_bytes()


def check_schema(name, tree):
    """FMPy has the schema of SSP 1.0."""
    path = Path(fmpy.__file__).parent / "ssp" / "schema" / f"SystemStructure{name}.xsd"
    etree.XMLSchema(etree.parse(str(path))).assertValid(tree)


def test_connectors_have_the_units_of_the_variables(case):
    """Each is declared, by its powers of SI units, and the document is valid."""
    path, _ = case
    tree = etree.fromstring(zipfile.ZipFile(path).read("SystemStructure.ssd"))
    check_schema("Description", tree)
    space = {"ssd": NAMESPACES["ssd"], "ssc": NAMESPACES["ssc"]}
    declared = {
        unit.get("name"): dict(unit.find("ssc:BaseUnit", space).attrib)
        for unit in tree.findall("ssd:Units/ssc:Unit", space)
    }
    used = {
        (component.get("name"), connector.get("name")): connector.find("ssc:Real", space).get(
            "unit"
        )
        for component in tree.iterfind(".//ssd:Component", space)
        for connector in component.iterfind("ssd:Connectors/ssd:Connector", space)
    }
    assert len(used) == 14
    assert set(used.values()) == set(declared)
    assert used["oscillator", "box_force"] == used["shaker", "box_force"] == "N"
    assert used["oscillator", "box_jerk"] == used["shaker", "box_jerk"] == "m/s3"
    assert declared["N"] == {"kg": "1", "m": "1", "s": "-2"}


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_sign_and_unit_are_linear_transformations(tmp_path, version):
    """In place of the tool's conversion; the drive's velocity is shown, not connected."""
    connect = {"box_force": "-box_force[kN]", "box_acceleration": "-box_acceleration"}
    connect |= {"box_velocity": "box_velocity", "box_position": "box_position[mm]"}
    path = write_ssp(tmp_path / "x.ssp", BEAM, SHAKER, connect=connect, version=version)
    archive = zipfile.ZipFile(path)
    tree = etree.fromstring(archive.read("SystemStructure.ssd"))
    space = {"ssd": NAMESPACES["ssd"], "ssc": NAMESPACES["ssc"], "ssv": NAMESPACES["ssv"]}
    factors = {}
    for link in tree.iterfind(".//ssd:Connection", space):
        (transformation,) = link
        factors[link.get("startConnector")] = float(transformation.get("factor"))
        assert link.get("suppressUnitConversion") == "true"
    assert factors == {"box_force": -1e-3, "box_acceleration": -1.0}  # end = factor * start
    shown = {one.get("name") for one in tree.iterfind(".//ssd:Component[2]//ssd:Connector", space)}
    assert shown == set(connect)
    values = etree.fromstring(archive.read("resources/shaker.ssv"))
    assert tree.get("version") == values.get("version") == version
    kinds = {etree.QName(value).localname for value in values.iterfind(".//ssv:Parameter/*", space)}
    assert kinds - {"Boolean"} == {"Real" if version == "1.0" else "Float64"}
    if version == "1.0":
        check_schema("Description", tree)
        check_schema("ParameterValues", values)


def test_omsimulator_finds_its_step(tmp_path):
    """Its C reader goes by the prefixes as they are written; its Python reader takes the solver by
    the name that it gives to co-simulation FMUs.
    """
    path = write_ssp(tmp_path / "drive.ssp", *QUICK, voltage=VOLTAGE, step=4e-5)
    node = minidom.parseString(zipfile.ZipFile(path).read("SystemStructure.ssd"))
    for name in (
        "ssd:SystemStructureDescription",
        "ssd:System",
        "ssd:Annotations",
        "ssc:Annotation",
        "oms:Annotations",
        "oms:SimulationInformation",
        "oms:FixedStepMaster",
    ):
        (node,) = (child for child in node.childNodes if child.nodeName == name)
        if name == "ssc:Annotation":
            assert node.getAttribute("type") == "org.openmodelica"
    assert float(node.getAttribute("stepSize")) == 4e-5
    assert node.getAttribute("description") == "oms-ma"
    solver = dict(node.parentNode.attributes.items())
    assert solver == {"name": "oms_ma_default", "method": "oms_ma", "fixedStepSize": "0.00004"}


def test_mistakes(tmp_path):
    with pytest.raises(InputError, match="step = 0.0 s: expected 0 < step"):
        write_ssp(tmp_path / "x.ssp", *QUICK, voltage=1.0, step=0.0)
    with pytest.raises(InputError, match="voltage = nan V: expected a finite number"):
        write_ssp(tmp_path / "x.ssp", *QUICK, voltage=float("nan"))
    for connect in ({"box_force": "box_force", "box_velocity": "box_velocity"}, OURS):
        with pytest.raises(InputError, match="expected box_force and box_acceleration, with or"):
            write_ssp(tmp_path / "x.ssp", BEAM, SHAKER, connect=connect)
    with pytest.raises(InputError, match="version = '3.0': expected '1.0' or '2.0'"):
        write_ssp(tmp_path / "x.ssp", *QUICK, voltage=1.0, version="3.0")
    with pytest.raises(InputError, match="voltage: expected with a motor"):
        write_ssp(tmp_path / "x.ssp", *QUICK)
    with pytest.raises(StoreError, match="nowhere"):
        write(tmp_path / "nowhere", QUICK)
    assert not list(tmp_path.iterdir())
