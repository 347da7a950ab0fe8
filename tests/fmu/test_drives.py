"""The drives in all forms: bits, states, motion by the equations, inputs seen at once, mistakes."""

import numpy as np
import pytest

from ..sparing import ordinary
from .coil_truth import Shaker
from .driver import DRIVES, FORMS, path_of
from .motor_truth import solve
from .programs.driver import Refused, open_fmu

MOTOR, COIL = DRIVES
LIMITED = {  # from limit to limit within half a second
    **{"coil_inductance": 0.02, "voltage_limit": 6.0, "current_limit": 1.0, "position_start": 2e-3},
    **{"command": 1.0, "command_1": 120.0, "command_2": -900.0, "command_3": 2000.0},
    **{"box_force": 5.0, "box_force_1": -100.0, "box_force_2": 900.0},
}
ENERGIES = {  # given, given, lost, (lost,) kept
    MOTOR: ("motor_energy", "box_force_work", "box_damper_energy", "stored_energy"),
    COIL: ("energy", "box_force_work", "coil_heat", "suspension_loss", "stored_energy"),
}
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


@pytest.mark.parametrize("inductance", [0.0, 0.05])
def test_a_motor_turns_by_the_equations(inductance):
    """In steps too, over which the force runs on; its energy is kept."""
    values = {"voltage": 8.0, "armature_inductance": inductance}
    values |= {"box_force": 2.0, "box_force_1": 30.0, "box_force_2": -500.0, "box_force_3": 1e4}
    f, whole = (open_fmu(path_of(MOTOR, form)).start(**values) for form in ("fmi2", "fmi3"))
    expected = solve(values, (0.0,) * 5, 0.25)
    names = ("box_position", "box_velocity", "angle", "speed", "motor_energy", "box_acceleration")
    found = whole.step(0.25).get(*names)
    assert found[:5] == pytest.approx([*expected[:4], expected[5]], rel=1e-11)
    parts = f.at(0.0171, 0.05, 0.0833, 0.25).get(*names)
    assert parts == pytest.approx(found, rel=1e-10)
    spent, given, lost, kept = whole.get(*ENERGIES[MOTOR])
    assert inductance or abs(spent + given - lost - kept) < 1e-12 * (1.0 + abs(given))


def draw_coil(seed):
    """Random values of a shaker: kind of control, inductance, limits, cubics, start values."""
    rng = np.random.default_rng(seed)
    lags, commanded, voltage, current = (bool(seed >> bit & 1) for bit in range(4))
    values = {
        **{"table_mass": rng.uniform(0.5, 5.0), "suspension_stiffness": rng.uniform(1e2, 4e3)},
        **{"suspension_damping": rng.uniform(0.0, 30.0), "force_factor": rng.uniform(5.0, 40.0)},
        **{"coil_resistance": rng.uniform(0.5, 5.0), "current_control": commanded},
        **{"coil_inductance": rng.uniform(2e-3, 5e-2) if lags else 0.0},
        **{"voltage_limit": rng.uniform(0.5, 6.0) if voltage else 0.0},
        **{"current_limit": rng.uniform(1.0, 2.0) if current else 0.0},
        **{"position_start": 0.01 * rng.normal(), "velocity_start": 0.3 * rng.normal()},
        "current_start": rng.uniform(-1.0, 1.0),
    }
    for name, size in (("command", 1.0), ("box_force", 20.0)):
        for order in range(4):
            values[f"{name}_{order}" if order else name] = size * 8.0**order * rng.normal()
    return values


KINDS = range(16)  # voltage or current control, with and without inductance, no limit to both


@pytest.mark.parametrize("kind", ordinary(KINDS, [2, 5, 9, 14, 15]))
def test_random_coils_move_by_the_equations(kind):
    """By scipy to 1e-10, over cubics that take the amplifier from limit to limit."""
    values = draw_coil(kind)
    f = open_fmu(path_of(COIL, "fmi3")).start(**values)
    free = values["current_control"] and not values["voltage_limit"]
    current = f.one("current") if free else values["current_start"]
    shaker = Shaker(**values)
    state = [values["position_start"], values["velocity_start"], current, *[0.0] * 4]
    shaker.begin(0.0, state)
    state = shaker.run(state, 0.0, 1.0)
    current, _, voltage = shaker.electric(1.0, state)
    expected = [*state[:2], current, voltage, shaker.acceleration(1.0, state), *state[3:]]
    names = ("box_position", "box_velocity", "current", "voltage", "box_acceleration", "energy")
    found = f.step(1.0).get(*names, "coil_heat", "suspension_loss", "box_force_work")
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_a_coils_bits_and_energy_on_any_grid(kind):
    """In all forms, at random points, some in quick succession; its energies close."""
    values, rng = draw_coil(kind + 48), np.random.default_rng(kind)
    whole = open_fmu(path_of(COIL, "fmi3")).start(**values).step(1.0).motion()
    f = open_fmu(path_of(COIL, FORMS[kind % 3])).start(**values)
    before = f.one("stored_energy") - f.one("energy")  # a commanded current has jumped
    for time in sorted([*rng.uniform(0.0, 1.0, 30), 0.5, 0.5 + 1e-15, 1.0]):
        f.step(float(time))
        spent, given, heat, loss, kept = terms = f.get(*ENERGIES[COIL])
        balance = spent + given - heat - loss - kept + before
        assert abs(balance) < 3e-13 * (sum(map(abs, terms)) + abs(before))
    assert f.motion() == whole


@pytest.mark.parametrize("lags", [0.0, 0.02])
@pytest.mark.parametrize("commanded", [False, True])
def test_limits_of_a_coil_are_kept_and_told(commanded, lags):
    """The commanded quantity, and the other one unless the table drives the coil beyond it."""
    limits, seen = np.array([3.0, 0.5]), set()
    values = {"voltage_limit": 3.0, "current_limit": 0.5, "coil_inductance": lags}
    values |= {"command": 0.3, "command_1": 4.0, "command_2": -40.0, "command_3": 70.0}
    f = open_fmu(path_of(COIL, "fmi2")).start(**values, current_control=commanded)
    for k in range(1, 401):
        parts = np.abs(f.step(k / 200).get("voltage", "current")) / limits
        assert (parts <= 1.0 + 1e-12).all()
        assert f.one("limited") == (parts > 1.0 - 1e-9).any()
        seen.add((f.one("limited"), parts[0] > 1.0 - 1e-9))
    assert len(seen) >= 2


def test_each_cubic_of_a_coil_begins_where_its_own_inputs_are_set():
    """The command runs on while the force is set in each step."""
    values = {"command": 1.0, "command_1": 2.0, "command_2": -6.0, "coil_inductance": 0.01}
    f = open_fmu(path_of(COIL, "fmi2")).start(**values)
    for k in range(8):
        f.set(box_force=0.0, box_force_1=0.0).step((k + 1) / 8)
    assert f.one("voltage") == pytest.approx(1.0 + 2.0 - 3.0, abs=1e-14)
    f.set(command=1.0).step(1.5)  # to the value that it has as an input: it begins anew
    assert f.one("voltage") == pytest.approx(1.0 + 2.0 * 0.5 - 3.0 * 0.5**2, abs=1e-14)


def test_no_event_of_a_coil_is_missed():
    """A command just beyond its limit for 0.6 ms, a stop reached by a nanometre, in long steps."""
    path = path_of(COIL, "fmi3")
    for command in (2.0, 2.0 + 1e-12, -2.0, 2.0 - 1e-12):
        f = open_fmu(path).start(command=command, voltage_limit=2.0)
        for _ in range(2):
            limited = abs(command) > 2.0
            assert f.get("voltage", "limited") == [max(-2.0, min(2.0, command)), limited]
            f.step(5.0)
    for excess in (1e-7, -1e-7):  # command = 2 + excess - (t - 1)^2
        cubic = {"command": 1.0 + excess, "command_1": 2.0, "command_2": -2.0}
        f = open_fmu(path).start(**cubic, voltage_limit=2.0).step(1.0)
        assert f.one("limited") == (excess > 0.0)
        assert f.step(1.0 + 2.0 * 1e-7**0.5).one("limited") == 0.0
    swing = {"force_factor": 0.0, "suspension_damping": 0.0, "velocity_start": 0.1}
    highest = 0.1 / np.sqrt(1375.0 / 5.5)
    open_fmu(path).start(**swing, travel_limit=highest + 1e-9).step(50.0)
    f = open_fmu(path).start(**swing, travel_limit=highest - 1e-9)
    assert "box_position = 0.0063" in f.refused("doStep", 0.0, 50.0)


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
    """In initialisation mode, between steps, after a state was restored; reading is harmless."""
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
