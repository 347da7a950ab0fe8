"""``modelDescription.xml`` says what is promised, and its dependencies are true."""

import zipfile
from xml.etree import ElementTree as ET

import fmpy
import pytest

from .driver import run

# What is promised: name, unit, start; typed in here, so that a slip in the project's table shows.
PARAMETERS = """
m1 kg 1 | m2 kg 1 | k1 N/m 1 | k2 N/m 1.2 | d1 N.s/m 0.01 | d2 N.s/m 0.01 | e 1 0.7 | gamma 1 * |
x1_start m 0 | x2_start m 0 | v1_start m/s 0 | v2_start m/s 0 | phase_start rad 0 |
clearance m 0 | e_slope s/m 0
"""
INPUTS = """
box_amplitude m 1 | box_frequency rad/s 0.4 | box_acceleration m/s2 0 | box_jerk m/s3 0 |
box_snap m/s4 0 | box_crackle m/s5 0
"""
OUTPUTS = """
x1 m | x2 m | v1 m/s | v2 m/s | x_rel m | v_rel m/s | xi1 1 | xi2 1 | xi_rel 1 | box_force N |
box_impulse N.s | box_impulse_moment N.s2 | contact_force N | phase rad | impact_time s |
impact_velocity m/s | impact_energy J | x_rel_max m
"""
BASE = {
    "kg": {"kg": 1},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "1": {},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "m/s3": {"m": 1, "s": -3},
    "m/s4": {"m": 1, "s": -4},
    "m/s5": {"m": 1, "s": -5},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "s": {"s": 1},
    "s/m": {"s": 1, "m": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.s": {"kg": 1, "m": 1, "s": -1},
    "N.s2": {"kg": 1, "m": 1},
    "J": {"kg": 1, "m": 2, "s": -2},
}
TYPES = {"Float64": "Real", "Int32": "Integer"}  # of FMI 3.0


def table(text):
    return [entry.split() for entry in text.split("|")]


@pytest.fixture
def found(fmu):
    return fmpy.read_model_description(str(fmu))


@pytest.fixture
def variables(found):
    return {variable.name: variable for variable in found.modelVariables}


def kind(variable):
    return TYPES.get(variable.type, variable.type)


def test_model(found):
    assert found.modelName == "TwoMassImpactOscillator"
    assert found.modelExchange is None
    ability = found.coSimulation
    assert ability.canHandleVariableCommunicationStepSize
    assert ability.canGetAndSetFMUstate and ability.canSerializeFMUstate
    assert found.defaultExperiment.stopTime and found.defaultExperiment.stepSize


def test_parameters_and_inputs(variables):
    for causality, entries in (("parameter", table(PARAMETERS)), ("input", table(INPUTS))):
        for name, unit, start in entries:
            variable = variables[name]
            assert (kind(variable), variable.causality, variable.unit) == (
                "Real",
                causality,
                unit,
            ), name
            assert variable.variability == (
                "fixed" if causality == "parameter" else "continuous"
            ), name
            assert start == "*" or float(variable.start) == float(start), name
            assert variable.description
            assert float(variable.min) < float(variable.max), name
    bonded = variables["bonded"]
    assert (kind(bonded), bonded.causality, bonded.variability, bonded.start) == (
        "Boolean",
        "parameter",
        "fixed",
        "false",
    )
    assert 0.0 < float(variables["gamma"].start) < 1e-2


def test_outputs(variables):
    for name, unit in table(OUTPUTS):
        variable = variables[name]
        assert (kind(variable), variable.causality, variable.unit) == ("Real", "output", unit), name
        assert variable.start is None
    assert (kind(variables["in_contact"]), variables["in_contact"].causality) == (
        "Boolean",
        "output",
    )
    assert (kind(variables["impact_count"]), variables["impact_count"].causality) == (
        "Integer",
        "output",
    )
    for name in ("x_rel", "contact_force", "impact_count", "x_rel_max"):
        assert float(variables[name].min) == 0.0
    references = [v.valueReference for v in variables.values()]
    assert len(set(references)) == len(references)


def test_units_are_defined(found, variables):
    defined = {unit.name: unit.baseUnit for unit in found.unitDefinitions}
    used = {variable.unit for variable in variables.values() if variable.unit}
    assert used == set(defined)
    for name, base in defined.items():
        exponents = {
            key: getattr(base, key)
            for key in ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
            if getattr(base, key)
        }
        assert exponents == BASE[name], name
        assert (base.factor, base.offset) == (1.0, 0.0)


def structure(fmu):
    """Names of outputs and of initial unknowns, with the names they depend on."""
    with zipfile.ZipFile(fmu) as archive:
        root = ET.fromstring(archive.read("modelDescription.xml"))
    if root.get("fmiVersion").startswith("3"):
        names = {v.get("valueReference"): v.get("name") for v in root.find("ModelVariables")}
        parts, key = (
            (root.findall("ModelStructure/Output"), root.findall("ModelStructure/InitialUnknown")),
            "valueReference",
        )
    else:
        names = {str(i + 1): v.get("name") for i, v in enumerate(root.find("ModelVariables"))}
        parts, key = (
            (
                root.findall("ModelStructure/Outputs/Unknown"),
                root.findall("ModelStructure/InitialUnknowns/Unknown"),
            ),
            "index",
        )
    # an attribute each
    return [
        {names[u.get(key)]: [names[k] for k in u.attrib["dependencies"].split()] for u in part}
        for part in parts
    ]


def test_structure_is_complete(fmu, variables):
    outputs, unknowns = structure(fmu)
    expected = {v.name for v in variables.values() if v.causality == "output" and v.type != "Clock"}
    assert {name for name in outputs if variables[name].type != "Clock"} == expected
    assert expected <= set(unknowns)
    assert not any(outputs.values())  # outputs belong to the last communication point


def test_initial_dependencies_are_true(fmu, tmp_path):
    """Each start value in turn is changed: the outputs that move at the start are those that name
    it, no more and no fewer.
    """
    moved = run("description.initial_dependencies", fmu, cwd=tmp_path)
    _, unknowns = structure(fmu)
    scalars = [name for name in unknowns if name not in ("positions", "velocities", "impact")]
    stated = {name: sorted(key for key in scalars if name in unknowns[key]) for name in moved}
    assert stated == moved


def test_outputs_wait_for_the_next_step(fmu, tmp_path):
    """As the structure says, no output changes when an input is set."""
    before, after, later = run(
        "description.outputs_wait_for_the_next_step", fmu, {"x2_start": 0.5}, cwd=tmp_path
    )
    assert after == before
    assert all(
        later[name] != before[name] for name in ("x1", "x2", "v1", "v2", "phase", "box_impulse")
    )
