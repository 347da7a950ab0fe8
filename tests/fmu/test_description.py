"""``modelDescription.xml`` says what is promised, and its dependencies are true."""

import contextlib

import fmpy
import pytest

from ..sparing import ordinary
from .driver import DRIVES, FORMS, MODELS, OSCILLATOR, path_of
from .programs.driver import Refused, describe, open_fmu

# What is promised: name, unit, start; typed in here, so that a slip in a project's table shows.
PARAMETERS, INPUTS, OUTPUTS = "parameter", "input", "output"
PROMISED = {
    OSCILLATOR: {
        PARAMETERS: """
m1 kg 1 | m2 kg 1 | k1 N/m 1 | k2 N/m 1.2 | d1 N.s/m 0.01 | d2 N.s/m 0.01 | e 1 0.7 | gamma 1 * |
x1_start m 0 | x2_start m 0 | v1_start m/s 0 | v2_start m/s 0 | phase_start rad 0 |
clearance m 0 | e_slope s/m 0 | stroke m 0 | bonded Boolean * | wall Boolean *
""",
        INPUTS: """
box_amplitude m 1 | box_frequency rad/s 0.4 | box_acceleration m/s2 0 | box_jerk m/s3 0 |
box_snap m/s4 0 | box_crackle m/s5 0 | force1_amplitude N 0 | force2_amplitude N 0 |
force1 N 0 | force1_1 N/s 0 | force1_2 N/s2 0 | force1_3 N/s3 0 |
force2 N 0 | force2_1 N/s 0 | force2_2 N/s2 0 | force2_3 N/s3 0
""",
        OUTPUTS: """
x1 m | x2 m | v1 m/s | v2 m/s | x_rel m | v_rel m/s | xi1 1 | xi2 1 | xi_rel 1 | box_force N |
box_impulse N.s | box_impulse_moment N.s2 | contact_force N | phase rad | impact_time s |
impact_velocity m/s | impact_energy J | x_rel_max m | sticking_energy J | in_contact Boolean |
impact_count Integer | impact_side Integer | contact_side Integer
""",
    },
    "MotorShaker": {
        PARAMETERS: """
box_mass kg * | box_stiffness N/m * | box_damping N.s/m * | unbalance_mass kg * |
unbalance_radius m * | rotor_inertia kg.m2 * | motor_constant N.m/A * |
armature_resistance Ohm * | armature_inductance H 0 | angle_start rad 0 | speed_start rad/s 0 |
position_start m 0 | velocity_start m/s 0
""",
        INPUTS: """
voltage V * | box_force N 0 | box_force_1 N/s 0 | box_force_2 N/s2 0 | box_force_3 N/s3 0
""",
        OUTPUTS: """
box_position m | box_velocity m/s | box_acceleration m/s2 | angle rad | speed rad/s |
motor_torque N.m | motor_power W | motor_energy J
""",
    },
    "ElectrodynamicShaker": {
        PARAMETERS: """
table_mass kg * | suspension_stiffness N/m * | suspension_damping N.s/m * | force_factor N/A * |
coil_resistance Ohm * | coil_inductance H * | voltage_limit V 0 | current_limit A 0 |
travel_limit m 0 | position_start m 0 | velocity_start m/s 0 | current_start A 0 |
current_control Boolean *
""",
        INPUTS: """
command V * | command_1 V/s 0 | command_2 V/s2 0 | command_3 V/s3 0 |
box_force N 0 | box_force_1 N/s 0 | box_force_2 N/s2 0 | box_force_3 N/s3 0
""",
        OUTPUTS: """
box_position m | box_velocity m/s | box_acceleration m/s2 | current A | voltage V | coil_force N |
power W | energy J | limited Boolean
""",
    },
}
BASES = {  # exponents of kg, m, s, A
    **{"kg": (1, 0, 0, 0), "m": (0, 1, 0, 0), "s": (0, 0, 1, 0), "A": (0, 0, 0, 1)},
    **{"N": (1, 1, -2, 0), "J": (1, 2, -2, 0), "W": (1, 2, -3, 0), "V": (1, 2, -3, -1)},
    **{"Ohm": (1, 2, -3, -2), "H": (1, 2, -2, -2), "rad": (0, 0, 0, 0), "1": (0, 0, 0, 0)},
}
TYPES = {"Float64": "Real", "Int32": "Integer"}  # of FMI 3.0
models = pytest.mark.parametrize("model", MODELS)
moving = pytest.mark.parametrize("form", ordinary(FORMS, ["fmi3"]))  # they compute alike


@pytest.fixture
def found(model, form):
    return fmpy.read_model_description(str(path_of(model, form)))


@pytest.fixture
def variables(found):
    return {variable.name: variable for variable in found.modelVariables}


def kind(variable):
    return TYPES.get(variable.type, variable.type)


@models
def test_model(found, model):
    assert found.modelName == model
    assert found.modelExchange is None
    ability = found.coSimulation
    assert ability.canHandleVariableCommunicationStepSize
    assert ability.canGetAndSetFMUstate and ability.canSerializeFMUstate
    assert found.defaultExperiment.stopTime and found.defaultExperiment.stepSize
    references = [v.valueReference for v in found.modelVariables]
    assert len(set(references)) == len(references)


@models
@pytest.mark.parametrize("causality", [PARAMETERS, INPUTS, OUTPUTS])
def test_variables_are_those_promised(variables, model, causality):
    for entry in PROMISED[model][causality].split("|"):
        name, unit, *starts = entry.split()
        variable = variables[name]
        assert variable.causality == causality and variable.description
        if unit in ("Boolean", "Integer"):
            assert kind(variable) == unit
            continue
        assert (kind(variable), variable.unit) == ("Real", unit)
        if causality == OUTPUTS:
            assert variable.start is None
            continue
        assert variable.variability == ("fixed" if causality == PARAMETERS else "continuous"), name
        assert starts == ["*"] or float(variable.start) == float(starts[0]), name
        assert float(variable.min) < float(variable.max), name
    if model == OSCILLATOR:
        assert 0.0 < float(variables["gamma"].start) < 1e-2
        for name in ("x_rel", "contact_force", "impact_count", "x_rel_max"):
            assert float(variables[name].min) == 0.0


def exponents(unit):
    """Exponents of a unit such as ``N.m/s2``, rad left out."""
    total = [0, 0, 0, 0]
    above, *below = unit.split("/")
    for part, sign in (*((p, 1) for p in above.split(".")), *((p, -1) for p in below)):
        name, power = (part[:-1], int(part[-1])) if part[-1] in "2345" else (part, 1)
        total = [t + sign * power * base for t, base in zip(total, BASES[name], strict=True)]
    return total


@models
def test_units_are_defined(found, variables):
    defined = {unit.name: unit.baseUnit for unit in found.unitDefinitions}
    used = {variable.unit for variable in variables.values() if variable.unit}
    assert used <= set(defined) <= used | {"s"}  # of time
    for name, base in defined.items():
        assert [base.kg, base.m, base.s, base.A] == exponents(name), name
        assert base.rad == name.startswith("rad")
        assert (base.factor, base.offset) == (1.0, 0.0)
        assert not (base.K or base.mol or base.cd)
    shown = {unit.name: {d.name for d in unit.displayUnits} for unit in found.unitDefinitions}
    for variable in variables.values():
        display = getattr(variable, "displayUnit", None)
        assert display is None or display in shown[variable.unit]


TOUCHING = {"x1_start": 0.25, "x2_start": 0.25, "phase_start": 0.5}
MOTOR = {
    **{"angle_start": 0.4, "speed_start": 30.0, "position_start": 0.01, "velocity_start": 0.2},
    **{"voltage": 5.0, "box_force": 2.0, "box_force_1": 3.0},
}
COIL = {
    **{"position_start": 1e-3, "velocity_start": 0.2, "current_start": 0.3},
    **{"command": 1.5, "command_1": 3.0, "command_2": -20.0, "box_force": 2.0, "box_force_1": 3.0},
}
FOLLOWING = {  # a constant current, whose change would take more voltage than there is
    **{"current_control": True, "coil_inductance": 0.1, "voltage_limit": 6.0},
    **{"current_start": 0.3, "command": 0.3, "command_1": 0.0, "command_2": 0.0},
}
STARTS = {
    OSCILLATOR: [  # at rest, in flight, at impacts, on the boundary, where what is driven decides
        {},
        {"x2_start": 0.5, "v1_start": 0.25},
        {**TOUCHING, "v1_start": 1.0, "e": 0.05, "gamma": 0.9},
        {**TOUCHING, "v1_start": 1.0, "e": 0.05, "e_slope": 2.0, "gamma": 0.9, "d2": 0.02},
        {**TOUCHING, "v1_start": 0.5, "v2_start": 0.5, "d2": 0.03},
        {"v1_start": 1.0, "clearance": -0.5, "d2": 0.03},
        {"clearance": 0.5},
        {"clearance": -0.5},
        {"d2": 0.03, "phase_start": -0.5},
        {"d2": 0.03, "box_amplitude": 0.0},
        {"d2": 0.03, "box_amplitude": 0.0, "force1": 0.1, "force2": -0.2, "phase_start": 1.0},
        {"d2": 0.03, "stroke": 0.5, "v1_start": -1.0, "x2_start": 0.5, "x1_start": 0.0},
        {**TOUCHING, "v1_start": 1.0, "e": 0.05, "gamma": 0.9, "force1_amplitude": 0.5},
        {"stroke": 0.5, "x2_start": 0.5, "v2_start": 1.0, "e": 0.05, "gamma": 0.9, "force2": 2.0},
        {"wall": True, "clearance": -0.5},
        {**TOUCHING, "e": 0.0, "v1_start": 0.250000001, "v2_start": 0.25},
        {"wall": True, "v1_start": 1.0, "e": 0.05, "gamma": 0.9, "phase_start": 1.0},
    ],
    "MotorShaker": [MOTOR, {**MOTOR, "armature_inductance": 0.1, "current_start": 0.3}],
    "ElectrodynamicShaker": [  # of amplifier, and what limits it from the start
        {**COIL, **more}
        for more in (
            FOLLOWING,
            {},
            {"coil_inductance": 0.1},
            {"current_control": True, "coil_inductance": 0.1},
            {"current_control": True, "coil_inductance": 0.1, "voltage_limit": 5.0},
            {"current_control": True, "voltage_limit": 5.0},
            {"current_control": True, "voltage_limit": 12.0},
            {"current_limit": 0.2, "coil_inductance": 0.1, "current_start": 0.2, "command": 20.0},
            {"current_limit": 0.2},
            {"voltage_limit": 1.0},
            {**FOLLOWING, "command": 0.6000000000000001, "command_1": 3.0, "command_2": -20.0},
        )
    ],
}


def others(variable, start):
    value = start.get(variable.name, variable.start)
    if variable.type == "Boolean":
        return [value in (False, "false")]
    if kind(variable) == "Integer":
        return [int(value) // 2, 3]
    value = float(value)
    near = (value + d for d in (-20, -2, -0.3, 0.3, 2, 20))
    return [0.0, 0.75 * value, 1.25 * value + 0.001, *near]


def moved(plain, other):
    """Outputs that differ by more than rounding."""
    pairs = {name: (value, other[name]) for name, value in plain.items()}
    return {n for n, (a, b) in pairs.items() if abs(a - b) > 1e-12 * (abs(a) + abs(b))}


ARRAYS = ("positions", "velocities", "impact")  # which FMI 3.0 alone has


def stated(unknowns, left_out=()):
    """Pairs of an unknown and what it is said to depend on; an attribute each."""
    pairs = {(v.name, u.variable.name) for u in unknowns for v in u.dependencies}
    return {(name, key) for name, key in pairs if key not in left_out}


@models
@moving
def test_initial_dependencies_are_true(model, form):
    path = path_of(model, form)
    f, found = open_fmu(path), set()

    def at_start(values):
        f.reset().set(**values)
        f.enter(3.0)
        return f.outputs()

    for start in STARTS[model]:
        plain = at_start(start)
        for v in f.variables.values():
            if v.causality not in ("parameter", "input"):
                continue
            for value in others(v, start):
                with contextlib.suppress(Refused):
                    other = at_start({**start, v.name: value})
                    found |= {(v.name, key) for key in moved(plain, other)}
    assert found == stated(describe(path).initialUnknowns, ARRAYS)


@models
def test_all_forms_state_the_same_dependencies(model):
    """But for arrays, which FMI 2.0 has element by element."""
    told = []
    for form in FORMS:
        found = describe(path_of(model, form))
        told.append([stated(each, ARRAYS) for each in (found.initialUnknowns, found.outputs)])
    assert told[0] == told[1] == told[2] and told[0][0]


@models
@moving
def test_dependencies_between_steps_are_true(model, form):
    """An oscillator's outputs wait for the next step, a drive's move at once where they name it."""
    path, found = path_of(model, form), set()
    for start in STARTS[model]:
        f = open_fmu(path).start(**start).step(0.01)
        inputs = {v.name: v for v in f.variables.values() if v.causality == "input"}
        values, state = f.outputs(inputs), f.save()
        plain = f.set(**values).outputs()
        for name, variable in inputs.items():
            for value in others(variable, values):
                with contextlib.suppress(Refused):
                    other = f.restore(*state).set(**{**values, name: value}).outputs()
                    found |= {(name, key) for key in moved(plain, other) if key != "evaluations"}
        if model == OSCILLATOR:
            f.step(0.02)
            assert moved(plain, f.outputs()) > {"phase", "box_impulse"}
    assert found == stated(describe(path).outputs)
    assert bool(found) == (model in DRIVES)
