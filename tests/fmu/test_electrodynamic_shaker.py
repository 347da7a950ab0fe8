"""``ElectrodynamicShaker`` in all its forms: valid, the same bits whatever the communication
points, states that resume, inputs that are seen at once, and mistakes that are named.
"""

import csv

import fmpy
import pytest
from fmpy.validation import validate_fmu

from ..fresh import ROOT
from ..kernels.electrodynamic_shaker.truth import Shaker
from .driver import BUILD, FORMS, run, run_with_output
from .programs.electrodynamic_shaker_mistakes import MISTAKES

FMUS = {form: BUILD / form / "ElectrodynamicShaker.fmu" for form in FORMS}
# What is promised, typed in here: name, causality, unit.
PROMISED = """
table_mass parameter kg | suspension_stiffness parameter N/m | suspension_damping parameter N.s/m |
force_factor parameter N/A | coil_resistance parameter Ohm | coil_inductance parameter H |
voltage_limit parameter V | current_limit parameter A | travel_limit parameter m |
position_start parameter m | velocity_start parameter m/s | current_start parameter A |
command input V | command_1 input V/s | command_2 input V/s2 | command_3 input V/s3 |
box_force input N | box_force_1 input N/s | box_force_2 input N/s2 | box_force_3 input N/s3 |
box_position output m | box_velocity output m/s | box_acceleration output m/s2 |
current output A | voltage output V | coil_force output N | power output W | energy output J
"""
LIMITED = {  # from limit to limit within half a second
    **{"coil_inductance": 0.02, "voltage_limit": 6.0, "current_limit": 1.0, "position_start": 2e-3},
    **{"command": 1.0, "command_1": 120.0, "command_2": -900.0, "command_3": 2000.0},
    **{"box_force": 5.0, "box_force_1": -100.0, "box_force_2": 900.0},
}
COMMANDED = {**LIMITED, "current_control": True, "coil_inductance": 0.0}


@pytest.fixture(params=FORMS, scope="module")
def fmu(request):
    """Path of the exported FMU, in each form."""
    return FMUS[request.param]


def test_valid_and_as_promised(fmu):
    assert validate_fmu(str(fmu)) == []
    variables = {
        variable.name: variable for variable in fmpy.read_model_description(str(fmu)).modelVariables
    }
    for name, causality, unit in (entry.split() for entry in PROMISED.split("|")):
        assert (variables[name].causality, variables[name].unit) == (causality, unit), name
    assert {variables[name].type for name in ("current_control", "limited")} == {"Boolean"}


def test_the_forms_and_all_communication_points_give_the_same_bits(tmp_path):
    for values in (LIMITED, COMMANDED):
        ends = []
        for form, pure in (*((form, False) for form in FORMS), ("fmi2-python", True)):
            arguments = (FMUS[form], values, 0.5)
            ends += run("electrodynamic_shaker.grids", *arguments, cwd=tmp_path, pure=pure)
        assert len(ends) == 3 * (len(FORMS) + 1)
        assert all(end == ends[0] for end in ends)


def test_states_resume_with_the_same_bits(tmp_path):
    ends = []
    for form in FORMS:
        found = run("electrodynamic_shaker.resumed", FMUS[form], LIMITED, cwd=tmp_path)
        end, again, other, limited = found
        assert end == again == other and limited
        ends.append(end)
    assert all(end == ends[0] for end in ends)


@pytest.mark.parametrize("values", [LIMITED, COMMANDED], ids=["voltage", "current"])
def test_motion_is_that_of_the_equations(fmu, values, tmp_path):
    names = ["box_position", "box_velocity", "current", "voltage", "energy"]
    found = run("electrodynamic_shaker.motion", fmu, values, 0.5, names, cwd=tmp_path)
    shaker = Shaker(**values)
    start = [values["position_start"], *[0.0] * 6]
    shaker.begin(0.0, start)
    state = shaker.run(start, 0.0, 0.5)
    current, _, voltage = shaker.electric(0.5, state)
    assert shaker.changes >= 3
    assert found == pytest.approx([*state[:2], current, voltage, state[3]], rel=1e-10)


@pytest.mark.parametrize("part", ["initial_dependencies", "dependencies"])
def test_dependencies_are_true(part, tmp_path):
    """Nothing moves what does not name it, and what is named moves it."""
    path = FMUS["fmi2"]
    found = run(f"electrodynamic_shaker.{part}_are_true", path, cwd=tmp_path)
    moved = {(name, key) for name, keys in found.items() for key in keys if key != "evaluations"}
    description = fmpy.read_model_description(str(path))
    unknowns = description.outputs if part == "dependencies" else description.initialUnknowns
    named = {(v.name, u.variable.name) for u in unknowns for v in u.dependencies or ()}
    assert moved == named


def test_outputs_belong_to_the_inputs_as_set_now(fmu, tmp_path):
    """Between steps, after a state was restored too; reading them changes nothing."""
    rows, same = run("electrodynamic_shaker.inputs_as_set_now", fmu, cwd=tmp_path)
    assert rows[0] == rows[1] and rows[2] == rows[3] and rows[4] == 7.0
    assert rows[2] - rows[0] == pytest.approx(11.0 / 5.5)
    assert same


def test_mistakes_are_named_and_others_live_on(fmu, tmp_path):
    texts, position = run("electrodynamic_shaker.mistakes", fmu, cwd=tmp_path)
    for (_, parts), text in zip(MISTAKES, texts, strict=True):
        assert all(part in text for part in parts), text
    assert position > 0.0


def test_a_stop_leaves_the_instance_where_it_was(fmu, tmp_path):
    program = "electrodynamic_shaker.a_stop_leaves_the_instance_where_it_was"
    assert run(program, fmu, cwd=tmp_path) == [True, True]


@pytest.mark.parametrize("form", ["fmi2-python", "fmi2"])
def test_libcosim(form, tmp_path):
    """Another reader of the XML and another loop: the same bits."""
    pytest.importorskip("libcosimpy")
    names = ["box_position", "current", "voltage", "energy"]
    values = {name: value for name, value in LIMITED.items() if value}
    arguments = (values, names, 0.03125, 16)
    (rows, known), done = run_with_output("libcosim.simulate", FMUS[form], *arguments, cwd=tmp_path)
    expected = run("electrodynamic_shaker.motion", FMUS[form], values, 0.5, names, cwd=tmp_path)
    assert rows[-1][1:] == expected
    assert known > 30 and "error" not in done.stderr.lower()


def test_reference_result(fmu, tmp_path):
    """The cross-check files inside are what FMPy computes from them."""
    folder = ROOT / "fmu_src" / "models" / "electrodynamic_shaker" / "reference"
    with (folder / "ElectrodynamicShaker_ref.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    names = [name for name in rows[0] if name != "time"]
    path = str(folder / "ElectrodynamicShaker_in.csv")
    found = run("electrodynamic_shaker.reference_result", fmu, path, names, cwd=tmp_path)
    assert found == pytest.approx([float(rows[-1][name]) for name in names], rel=1e-7, abs=1e-12)
