"""``MotorShaker`` in all its forms: valid, the same bits, states that resume, inputs that are seen
at once, and mistakes that are named.
"""

import csv
import json

import fmpy
import pytest
from fmpy.validation import validate_fmu

from ..fresh import ROOT, run_fresh
from ..kernels.shaker.truth import solve
from .driver import BUILD, FORMS, run
from .exporting import export_copy
from .test_importers import COSIM

FMUS = {form: BUILD / form / "MotorShaker.fmu" for form in FORMS}
# The contract's table, typed in here: name, causality, unit.
CONTRACT = """
box_mass parameter kg | box_stiffness parameter N/m | box_damping parameter N.s/m | unbalance_mass parameter kg | unbalance_radius parameter m |
rotor_inertia parameter kg.m2 | motor_constant parameter N.m/A | armature_resistance parameter Ohm | armature_inductance parameter H |
angle_start parameter rad | speed_start parameter rad/s | position_start parameter m | velocity_start parameter m/s | voltage input V |
box_force input N | box_force_1 input N/s | box_force_2 input N/s2 | box_force_3 input N/s3 | box_position output m | box_velocity output m/s |
box_acceleration output m/s2 | angle output rad | speed output rad/s | motor_torque output N.m | motor_power output W | motor_energy output J
"""
RUN = r"""
f = open_fmu(PATH).start(voltage=6.0, box_force=0.5, box_force_1=-3.0, armature_inductance=0.01)
for k in range(1, 41):
    f.step(k * 0.0137)
    f.set(voltage=6.0 + 0.1 * k, box_force=0.3 * k)
half = f.save()
for k in range(41, 61):
    f.step(k * 0.0137)
end = f.outputs()
f.restore(*half)
for k in range(41, 61):
    f.step(k * 0.0137)
again = f.outputs()
g = open_fmu(PATH).restore(*half)
for k in range(41, 61):
    g.step(k * 0.0137)
answer([end, again, g.outputs()])
"""


@pytest.fixture(params=FORMS, scope="module")
def fmu(request):
    """Path of the exported FMU, in each form."""
    return FMUS[request.param]


def test_valid_and_as_the_contract_says(fmu):
    assert validate_fmu(str(fmu)) == []
    variables = {
        variable.name: variable for variable in fmpy.read_model_description(str(fmu)).modelVariables
    }
    for name, causality, unit in (entry.split() for entry in CONTRACT.split("|")):
        assert (variables[name].causality, variables[name].unit) == (causality, unit), name


def test_exports_are_the_same_bytes_and_named_by_their_sources(tmp_path):
    """The elementary functions, which lie with the other kernel, are among the sources."""
    packages = ("shaker", "motor_shaker")
    first = export_copy(tmp_path / "first", packages=packages, PYTHONHASHSEED="1", TZ="UTC")
    second = export_copy(
        tmp_path / "a second one", packages=packages, PYTHONHASHSEED="2", TZ="Asia/Tokyo"
    )
    assert first.read_bytes() == second.read_bytes()
    guid = fmpy.read_model_description(str(first)).guid
    assert guid == fmpy.read_model_description(str(FMUS["fmi2-python"])).guid
    changed = export_copy(
        tmp_path / "changed",
        [("kernels/numerics/elementary.py", "EXP_ZERO = 700.0", "EXP_ZERO = 701.0")],
        packages,
    )
    assert fmpy.read_model_description(str(changed)).guid != guid


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
    script = r"""
    base = dict(angle_start=0.4, speed_start=30.0, position_start=0.01, velocity_start=0.2, voltage=5.0, box_force=2.0, box_force_1=3.0)
    inductive = {**base, "armature_inductance": 0.1, "current_start": 0.3}
    found = {}

    def at_start(values):
        f = open_fmu(PATH)
        f.set(**values)
        f.enter()
        try:
            return f.outputs()
        finally:
            f.free()

    settable = [v for v in describe(PATH).modelVariables if v.causality in ("parameter", "input")]
    for start in (base, inductive):
        plain = at_start(start)
        for v in settable:
            other = at_start({**start, v.name: 1.25 * start.get(v.name, float(v.start)) + 0.001})
            found.setdefault(v.name, set()).update(key for key in plain if plain[key] != other[key])
    answer({name: sorted(keys) for name, keys in found.items()})
    """
    moved = run(script, fmu, cwd=tmp_path)
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
        end, again, other = run(RUN, FMUS[form], cwd=tmp_path, pure=pure)
        assert end == again == other
        ends.append(end)
    assert all(end == ends[0] for end in ends)
    assert ends[0]["angle"] > 10.0


def test_motion_is_that_of_the_equations(fmu, tmp_path):
    script = r"""
    values = json.loads(sys.argv[2])
    f = open_fmu(PATH).start(**values).step(0.25)
    answer(f.get("box_position", "box_velocity", "angle", "speed", "motor_energy"))
    """
    values = {
        "voltage": 8.0,
        "box_force": 2.0,
        "box_force_1": 30.0,
        "box_force_2": -500.0,
        "box_force_3": 1e4,
    }
    found = run(script, fmu, json.dumps(values), cwd=tmp_path)
    expected = solve(values, (0.0,) * 5, 0.25)
    assert found == pytest.approx([*expected[:4], expected[5]], rel=1e-11)


def test_acceleration_belongs_to_the_inputs_as_set_now(fmu, tmp_path):
    """In initialisation mode and between steps, after a state was restored too; reading it changes
    nothing.
    """
    script = r"""
    f = open_fmu(PATH)
    f.enter()
    rows = []
    for force in (0.0, 11.0):
        f.set(box_force=force)
        rows.append(f.get("box_acceleration")[0])
    f.leave()
    f.set(box_force=0.0, voltage=6.0)
    f.step(0.1)
    states = []
    for force in (2.0, 13.0):
        f.set(box_force=force)
        state = f.save()
        rows.append(f.get("box_acceleration")[0])
        f.restore(*state)
        rows.append(f.get("box_acceleration")[0])
    f.step(0.2)
    looked = f.outputs()
    g = open_fmu(PATH).start()
    g.set(voltage=6.0)
    g.step(0.1).set(box_force=13.0)
    answer([rows, looked == g.step(0.2).outputs()])
    """
    rows, same = run(script, fmu, cwd=tmp_path)
    assert rows[:2] == pytest.approx([0.0, 2.0], rel=1e-2)
    assert rows[2] == rows[3] and rows[4] == rows[5]
    # a force on box_mass = 5.5 kg; the unbalance takes part
    assert 2.0 <= rows[4] - rows[2] < 2.0 * 1.01
    assert same


BAD = [
    ('f.start(box_mass=0.0)', ["box_mass = 0.0 kg", "1e-30 <= box_mass <= 1e+30"]),
    ('f.start(armature_resistance=-1.0)', ["armature_resistance = -1.0 Ohm", "1e-30 <="]),
    ('f.start().set(voltage=math.nan)', ["voltage = nan V", "-1e+30 <= voltage <= 1e+30"]),
    ('f.start().set(box_force_2=math.inf)', ["box_force_2 = inf N/s2", "expected"]),
    ('f.start().set(rotor_inertia=1.0)', ["rotor_inertia = 1.0", "fixed parameter"]),
    ('f.start().set(speed=1.0)', ["speed = 1.0", "output"]),
    ('f.start(rotor_inertia=1e-9)', ["rotor_inertia = 1e-09 kg.m2", "unbalance_mass = 0.025 kg", "expected rotor_inertia >= "]),
    ('f.start(armature_inductance=1e-9, voltage=5.0).step(1.0)', ["armature_inductance = 1e-09 H", "expected 0 H", "reached only"]),
    ('f.start().step(math.nan)', ["communicationStepSize = nan s", "expected every finite number >= 0"]),
    ('f.start().step(-1.0)', ["communicationStepSize = -1.0 s", "expected"]),
    ('f.start(box_force=1e30, box_force_3=1e30).step(1e80)', ["range of floating-point numbers"]),
]  # fmt: skip


def test_mistakes_are_named_and_others_live_on(fmu, tmp_path):
    script = r"""
    other, texts = open_fmu(PATH, name="other").start(voltage=5.0), []
    for call in json.loads(sys.argv[2]):
        f = open_fmu(PATH)
        try:
            eval(call)
            texts.append("accepted")
        except Refused as refusal:
            texts.append(" ".join(refusal.messages))
    answer([texts, other.step(0.1).get("angle")[0]])
    """
    texts, angle = run(script, fmu, json.dumps([call for call, _ in BAD]), cwd=tmp_path)
    for (call, parts), text in zip(BAD, texts, strict=True):
        assert all(part in text for part in parts), (call, text)
    assert angle > 0.0


def test_failed_step_leaves_the_instance_where_it_was(fmu, tmp_path):
    script = r"""
    f = open_fmu(PATH).start(voltage=5.0, armature_inductance=1e-4).step(0.01)
    before = f.outputs()
    try:
        f.step(10.0)
    except Refused as refusal:
        pass
    f.time = 0.01
    kept = f.outputs() == before
    g = open_fmu(PATH).start(voltage=5.0, armature_inductance=1e-4).step(0.01).step(0.02)
    answer([kept, f.step(0.02).outputs() == g.outputs()])
    """
    assert run(script, fmu, cwd=tmp_path) == [True, True]


@pytest.mark.parametrize("form", ["fmi2-python", "fmi2"])
def test_libcosim(form, tmp_path):
    """Another reader of the XML and another loop: the same bits."""
    pytest.importorskip("libcosimpy")
    script = COSIM.replace(
        'observer.last_integer_values(index, [variables["impact_count"]])', "None"
    )
    names = ["box_position", "box_velocity", "angle", "speed", "motor_energy"]
    values = {"voltage": 7.0, "speed_start": 20.0}
    (rows, _, known), done = run_fresh(
        script,
        FMUS[form],
        json.dumps(values),
        json.dumps(names),
        0.03125,
        64,
        cwd=tmp_path,
        env={"VIBROIMPACT_MESSAGES": ""},
    )
    expected = run(
        r"""
        f, names = open_fmu(PATH).start(**json.loads(sys.argv[2])), json.loads(sys.argv[3])
        answer([f.step(k * 0.03125).get(*names) for k in range(1, 65)])
        """,
        FMUS[form],
        json.dumps(values),
        json.dumps(names),
        cwd=tmp_path,
    )
    assert [row[1:] for row in rows] == expected
    assert known > 30 and "error" not in done.stderr.lower()


def test_reference_result(fmu, tmp_path):
    """The cross-check files inside are what FMPy computes from them."""
    folder = ROOT / "fmu_src" / "models" / "motor_shaker" / "reference"
    with (folder / "MotorShaker_ref.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    script = r"""
    import numpy as np
    table = np.genfromtxt(sys.argv[2], delimiter=",", names=True)
    names = json.loads(sys.argv[3])
    found = fmpy.simulate_fmu(PATH, stop_time=5.0, output_interval=0.005, input=table, output=names)
    answer([float(found[name][-1]) for name in names])
    """
    names = [name for name in rows[0] if name != "time"]
    found = run(script, fmu, str(folder / "MotorShaker_in.csv"), json.dumps(names), cwd=tmp_path)
    assert found == pytest.approx([float(rows[-1][name]) for name in names], rel=1e-7)
