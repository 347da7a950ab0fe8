"""``MotorShaker`` in all its forms: valid, the same bits, states that resume, inputs that are seen
at once, and mistakes that are named.
"""

import csv

import fmpy
import pytest
from fmpy.validation import validate_fmu

from ..fresh import ROOT
from ..kernels.shaker.truth import solve
from .copies import export_copy, guid_of_copy
from .driver import BUILD, FORMS, run, run_with_output
from .programs.motor_shaker_mistakes import MISTAKES

FMUS = {form: BUILD / form / "MotorShaker.fmu" for form in FORMS}
# What is promised, typed in here: name, causality, unit.
PROMISED = """
box_mass parameter kg | box_stiffness parameter N/m | box_damping parameter N.s/m |
unbalance_mass parameter kg | unbalance_radius parameter m | rotor_inertia parameter kg.m2 |
motor_constant parameter N.m/A | armature_resistance parameter Ohm |
armature_inductance parameter H | angle_start parameter rad | speed_start parameter rad/s |
position_start parameter m | velocity_start parameter m/s | voltage input V | box_force input N |
box_force_1 input N/s | box_force_2 input N/s2 | box_force_3 input N/s3 | box_position output m |
box_velocity output m/s | box_acceleration output m/s2 | angle output rad | speed output rad/s |
motor_torque output N.m | motor_power output W | motor_energy output J
"""


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


def test_exports_are_the_same_bytes_and_named_by_their_sources(tmp_path):
    """The elementary functions, which lie with the other kernel, are among the sources."""
    first = export_copy(tmp_path / "first", model="MotorShaker", PYTHONHASHSEED="1", TZ="UTC")
    second = export_copy(
        tmp_path / "a second one", model="MotorShaker", PYTHONHASHSEED="2", TZ="Asia/Tokyo"
    )
    assert first.read_bytes() == second.read_bytes()
    guid = fmpy.read_model_description(str(first)).guid
    assert guid == fmpy.read_model_description(str(FMUS["fmi2-python"])).guid
    change = ("kernels/numerics/elementary.py", "EXP_ZERO = 700.0", "EXP_ZERO = 701.0")
    same = guid_of_copy(tmp_path / "same", [], model="MotorShaker")
    changed = guid_of_copy(tmp_path / "changed", [change], model="MotorShaker")
    assert same == guid != changed


def test_dependencies_tell_what_follows_an_input_at_once(fmu):
    found = fmpy.read_model_description(str(fmu))
    direct = {
        unknown.variable.name: {variable.name for variable in unknown.dependencies}
        for unknown in found.outputs
    }
    electric = ("motor_current", "motor_torque", "motor_power")
    assert {name: known for name, known in direct.items() if known} == {
        "box_acceleration": {"voltage", "box_force"},
        "box_jerk": {"voltage", "box_force", "box_force_1"},
        **{name: {"voltage"} for name in electric},
    }


def test_initial_dependencies_are_true(fmu, tmp_path):
    """Each start value in turn is changed: no output moves at the start that does not name it, and
    every one that is named moves something.
    """
    moved = run("motor_shaker.initial_dependencies_are_true", fmu, cwd=tmp_path)
    known = {
        u.variable.name: {v.name for v in u.dependencies or ()}
        for u in fmpy.read_model_description(str(fmu)).initialUnknowns
    }
    assert {
        (name, key) for name, keys in moved.items() for key in keys if name not in known[key]
    } == set()
    assert {
        (name, key) for key, names in known.items() for name in names if key not in moved[name]
    } == set()


def test_the_forms_give_the_same_bits_and_states_resume(tmp_path):
    ends = []
    for form, pure in (*((form, False) for form in FORMS), ("fmi2-python", True)):
        end, again, other = run("motor_shaker.resumed", FMUS[form], cwd=tmp_path, pure=pure)
        assert end == again == other
        ends.append(end)
    assert all(end == ends[0] for end in ends)
    assert ends[0]["angle"] > 10.0


def test_motion_is_that_of_the_equations(fmu, tmp_path):
    values = {
        "voltage": 8.0,
        "box_force": 2.0,
        "box_force_1": 30.0,
        "box_force_2": -500.0,
        "box_force_3": 1e4,
    }
    found = run("motor_shaker.motion_is_that_of_the_equations", fmu, values, cwd=tmp_path)
    expected = solve(values, (0.0,) * 5, 0.25)
    assert found == pytest.approx([*expected[:4], expected[5]], rel=1e-11)


def test_acceleration_belongs_to_the_inputs_as_set_now(fmu, tmp_path):
    """In initialisation mode and between steps, after a state was restored too; reading it changes
    nothing.
    """
    rows, same = run(
        "motor_shaker.acceleration_belongs_to_the_inputs_as_set_now", fmu, cwd=tmp_path
    )
    assert rows[:2] == pytest.approx([0.0, 2.0], rel=1e-2)
    assert rows[2] == rows[3] and rows[4] == rows[5]
    # a force on box_mass = 5.5 kg; the unbalance takes part
    assert 2.0 <= rows[4] - rows[2] < 2.0 * 1.01
    assert same


def test_mistakes_are_named_and_others_live_on(fmu, tmp_path):
    texts, angle = run("motor_shaker.mistakes", fmu, cwd=tmp_path)
    for (_, parts), text in zip(MISTAKES, texts, strict=True):
        assert all(part in text for part in parts), text
    assert angle > 0.0


def test_failed_step_leaves_the_instance_where_it_was(fmu, tmp_path):
    assert run("motor_shaker.failed_step_leaves_the_instance_where_it_was", fmu, cwd=tmp_path) == [
        True,
        True,
    ]


@pytest.mark.parametrize("form", ["fmi2-python", "fmi2"])
def test_libcosim(form, tmp_path):
    """Another reader of the XML and another loop: the same bits."""
    pytest.importorskip("libcosimpy")
    names = ["box_position", "box_velocity", "angle", "speed", "motor_energy"]
    values = {"voltage": 7.0, "speed_start": 20.0}
    arguments = (values, names, 0.03125, 64)
    (rows, known), done = run_with_output("libcosim.simulate", FMUS[form], *arguments, cwd=tmp_path)
    expected = run("motor_shaker.steps", FMUS[form], values, names, cwd=tmp_path)
    assert [row[1:] for row in rows] == expected
    assert known > 30 and "error" not in done.stderr.lower()


def test_reference_result(fmu, tmp_path):
    """The cross-check files inside are what FMPy computes from them."""
    folder = ROOT / "fmu_src" / "models" / "motor_shaker" / "reference"
    with (folder / "MotorShaker_ref.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    names = [name for name in rows[0] if name != "time"]
    found = run(
        "motor_shaker.reference_result",
        fmu,
        str(folder / "MotorShaker_in.csv"),
        names,
        cwd=tmp_path,
    )
    assert found == pytest.approx([float(rows[-1][name]) for name in names], rel=1e-7)
