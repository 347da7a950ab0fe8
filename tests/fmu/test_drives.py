"""``MotorShaker`` and ``ElectrodynamicShaker`` in all their forms: the same bits, states that
resume, the motion of the equations, inputs that are seen at once, and mistakes that are named.
"""

import pytest

from ..kernels.electrodynamic_shaker.truth import Shaker
from ..kernels.motor_shaker.truth import solve
from .driver import DRIVES, FORMS, path_of
from .programs.driver import Refused, open_fmu

MOTOR, COIL = DRIVES
LIMITED = {  # from limit to limit within half a second
    **{"coil_inductance": 0.02, "voltage_limit": 6.0, "current_limit": 1.0, "position_start": 2e-3},
    **{"command": 1.0, "command_1": 120.0, "command_2": -900.0, "command_3": 2000.0},
    **{"box_force": 5.0, "box_force_1": -100.0, "box_force_2": 900.0},
}
COMMANDED = {**LIMITED, "current_control": True, "coil_inductance": 0.0}
drives = pytest.mark.parametrize("model", DRIVES)


RESUMED = {  # start values, and inputs set at each step
    MOTOR: (
        {"voltage": 6.0, "box_force": 0.5, "box_force_1": -3.0, "armature_inductance": 0.01},
        lambda k: {"voltage": 6.0 + 0.1 * k, "box_force": 0.3 * k},
    ),
    COIL: (
        LIMITED,
        lambda k: {"command": 2 - 0.1 * k, "command_1": 500 - 10.0 * k, "box_force": 0.3 * k},
    ),
}


@drives
def test_states_resume_with_the_same_bits_in_all_forms(model):
    values, inputs = RESUMED[model]

    def go(f, first, last):
        for k in range(first, last):
            f.step(k * 0.0137).set(**inputs(k))
        return f.motion()

    ends = []
    for form in FORMS:
        f = open_fmu(path_of(model, form)).start(**values)
        go(f, 1, 41)
        half = f.save()
        ends += [go(f, 41, 61), go(f.restore(*half), 41, 61)]
        ends.append(go(open_fmu(path_of(model, form)).restore(*half), 41, 61))
    assert len(ends) == 9 and all(end == ends[0] for end in ends)
    assert abs(ends[0]["box_position"]) > 1e-4


def test_a_motor_turns_by_the_equations(form):
    values = {"voltage": 8.0, "box_force": 2.0}
    values |= {"box_force_1": 30.0, "box_force_2": -500.0, "box_force_3": 1e4}
    f = open_fmu(path_of(MOTOR, form)).start(**values).step(0.25)
    expected = solve(values, (0.0,) * 5, 0.25)
    found = f.get("box_position", "box_velocity", "angle", "speed", "motor_energy")
    assert found == pytest.approx([*expected[:4], expected[5]], rel=1e-11)


@pytest.mark.parametrize("values", [LIMITED, COMMANDED], ids=["voltage", "current"])
def test_a_coil_moves_by_the_equations(form, values):
    f = open_fmu(path_of(COIL, form)).start(**values).step(0.5)
    shaker = Shaker(**values)
    start = [values["position_start"], *[0.0] * 6]
    shaker.begin(0.0, start)
    state = shaker.run(start, 0.0, 0.5)
    current, _, voltage = shaker.electric(0.5, state)
    assert shaker.changes >= 3
    found = f.get("box_position", "box_velocity", "current", "voltage", "energy")
    assert found == pytest.approx([*state[:2], current, voltage, state[3]], rel=1e-10)


def test_a_commanded_current_puts_the_energy_of_its_first_jump_in(form):
    """Whenever it is set; as it does over the short time that a high voltage limit leaves it."""
    values = {"current_control": True, "coil_inductance": 0.02}
    first = open_fmu(path_of(COIL, form)).start(**values, command=2.0)
    assert first.one("energy") == 0.5 * 0.02 * 2.0**2 == first.one("stored_energy")
    later = open_fmu(path_of(COIL, form)).start(**values).set(command=2.0)
    limited = open_fmu(path_of(COIL, form)).start(**values, command=2.0, voltage_limit=1e6)
    ends = [f.step(0.1).one("energy") for f in (first, later, limited)]
    assert ends[0] == ends[1] == pytest.approx(ends[2], rel=1e-6)


@drives
def test_acceleration_belongs_to_the_inputs_as_set_now(model, form):
    """In initialisation mode and between steps, after a state was restored too; reading it changes
    nothing.
    """
    name = "voltage" if model == MOTOR else "command"
    f = open_fmu(path_of(model, form))
    f.enter()
    still, pushed = (f.set(box_force=force).one("box_acceleration") for force in (0.0, 11.0))
    assert pushed - still == pytest.approx(2.0, rel=1e-2)  # 5.5 kg
    f.set(box_force=0.0, **{name: 6.0})
    f.leave()
    f.step(0.1)
    rows = []
    for force in (2.0, 13.0):
        state = f.set(box_force=force).save()
        rows.append(f.one("box_acceleration"))
        assert f.restore(*state).one("box_acceleration") == rows[-1]
    assert 2.0 * (1.0 - 1e-12) <= rows[1] - rows[0] < 2.0 * 1.01  # an unbalance takes part
    if model == COIL:
        assert f.set(command=7.0).one("voltage") == 7.0
    f.set(**{name: 3.0})
    other = open_fmu(path_of(model, form)).start(**{name: 6.0}).step(0.1)
    other.set(box_force=13.0, **{name: 3.0})
    assert f.step(0.2).outputs() == other.step(0.2).outputs()


MISTAKES = [  # a model, start values, the end of a step, and what the message must name
    (MOTOR, {"rotor_inertia": 1e-9}, 0.0, "rotor_inertia = 1e-09 kg.m2; unbalance_mass"),
    (MOTOR, {"voltage": 1e30}, 1.0, "range of floating-point numbers"),
    (COIL, {"position_start": -0.02, "travel_limit": 0.01}, 0.0, "position_start = -0.02"),
    (COIL, {"current_start": 3.0, "current_limit": 2.0, "coil_inductance": 0.01}, 0.0, "2.0 A"),
    (COIL, {"command": 40.0, "travel_limit": 0.01}, 2.0, "box_position = 0.01"),
]


def test_mistakes_are_named_and_others_live_on(form):
    living = {model: open_fmu(path_of(model, form), name="other") for model in DRIVES}
    living[MOTOR].start(voltage=5.0)
    living[COIL].start(command=5.0)
    for model, values, end, parts in MISTAKES:
        with pytest.raises(Refused) as refused:
            open_fmu(path_of(model, form)).start(**values).step(end)
        text = " ".join(refused.value.messages)
        assert [part for part in parts.split("; ") if part not in text] == [], text
    assert living[MOTOR].step(0.1).one("angle") > 0.0
    assert living[COIL].step(0.1).one("box_position") > 0.0
