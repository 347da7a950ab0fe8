"""The motion between and through limits, against other solutions of the same equations."""

import numpy as np
import pytest

from fmu_src.kernels.electrodynamic_shaker import limits, stepper
from fmu_src.kernels.electrodynamic_shaker import memory as at

from ...sparing import ordinary
from .kernel import advanced, draw, memory_of, outputs, set_inputs, started
from .truth import Shaker, polynomial

KINDS = range(16)  # voltage or current control, with and without inductance, no limit to both
SLOTS = (at.BOX_POSITION, at.BOX_VELOCITY, at.CURRENT, at.VOLTAGE, at.BOX_ACCELERATION)
ENERGIES = (at.ENERGY, at.COIL_HEAT, at.SUSPENSION_LOSS, at.BOX_FORCE_WORK)
LIMITS = {"voltage_limit": 3.0, "current_limit": 0.5}


def solve(values, first_current, stop):
    """Current, motion and energies by scipy."""
    shaker = Shaker(**values)
    state = [values["position_start"], values["velocity_start"], first_current, *[0.0] * 4]
    shaker.begin(0.0, state)
    state = shaker.run(state, 0.0, stop)
    current, _, voltage = shaker.electric(stop, state)
    motion = [state[0], state[1], current, voltage, shaker.acceleration(stop, state)]
    return [*motion, *state[3:]]


@pytest.mark.parametrize("kind", ordinary(KINDS, [2, 5, 9, 14, 15]))
def test_random_shakers_are_those_of_the_equations(kind):
    """By scipy to 1e-10, over cubics that take the amplifier from limit to limit."""
    values = draw(kind)
    m = started(**values)
    free = values["current_control"] and not values["voltage_limit"]
    expected = solve(values, m[at.CURRENT] if free else values["current_start"], 1.0)
    found = [advanced(m, 1.0)[slot] for slot in (*SLOTS, *ENERGIES)]
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-12)


def test_an_event_that_cannot_be_decided_is_an_error(monkeypatch):
    """Each search for a root has an end, whatever entry point it is called from."""
    values = {"command": 0.9, "command_1": 10.0, "command_2": -500.0, "voltage_limit": 1.0}
    m = advanced(started(**values), 1e-9)
    monkeypatch.setattr(limits, "MOST_STEPS", 0)
    assert stepper.initialize(memory_of(**values), 0.0) == at.NOT_FINITE
    assert stepper.advance(list(m), 0.1) == at.NOT_FINITE
    set_inputs(m, command=0.91)
    assert stepper.refresh(m, 0.0) == at.NOT_FINITE
    assert stepper.advance(m, 2e-9) == at.NOT_FINITE


@pytest.mark.parametrize("kind", ordinary(KINDS))
def test_communication_points_change_no_bit(kind):
    """Points at random, some of them in quick succession, and one at an event."""
    for seed in (kind, kind + 48):
        values, rng = draw(seed), np.random.default_rng(seed)
        whole = advanced(started(**values), 1.0)
        times = sorted([*rng.uniform(0.0, 1.0, 30), 0.5, 0.5 + 1e-15])
        assert outputs(advanced(started(**values), *times, 1.0)) == outputs(whole)
        first = whole[at.ORIGIN]  # of the last state
        if 0.0 < first < 1.0:
            parts = advanced(started(**values), np.nextafter(first, 0.0), first)
            assert outputs(advanced(parts, 1.0)) == outputs(whole)


@pytest.mark.parametrize("kind", KINDS)
def test_energy_is_kept(kind):
    values = draw(kind + 64)
    m = started(**values)
    before = m[at.STORED_ENERGY] - m[at.ENERGY]  # a commanded current has jumped
    for k in range(1, 65):
        advanced(m, k / 64)
        if k == 32:  # a jump, of a commanded current too
            set_inputs(m, command=-values["command"], command_1=0.5)
        terms = [m[at.ENERGY], m[at.BOX_FORCE_WORK], -m[at.COIL_HEAT], -m[at.SUSPENSION_LOSS]]
        terms += [before, -m[at.STORED_ENERGY]]
        assert abs(sum(terms)) < 3e-13 * sum(map(abs, terms))


def test_a_constant_that_is_set_to_its_value_is_no_new_input():
    values = {"command": 3.0, "box_force": -1.0, "coil_inductance": 0.01, "current_limit": 0.5}
    whole = advanced(started(**values), 1.0)
    m = started(**values)
    for k in range(1, 11):
        set_inputs(m, command=3.0, box_force=-1.0)
        advanced(m, k / 10)
    assert outputs(m) == outputs(whole)


def test_each_cubic_begins_where_its_own_inputs_are_set():
    """The command runs on while the force is set in each step."""
    values = {"command": 1.0, "command_1": 2.0, "command_2": -6.0, "coil_inductance": 0.01}
    m = started(**values)
    for k in range(8):
        set_inputs(m, box_force=0.0, box_force_1=0.0)
        advanced(m, (k + 1) / 8)
    assert m[at.VOLTAGE] == pytest.approx(1.0 + 2.0 - 3.0, abs=1e-14)
    set_inputs(m, command=1.0)  # to the value that it has as an input: it begins anew
    advanced(m, 1.5)
    expected = polynomial(dict(values, command_3=0.0), "command", 0.5)[0]
    assert m[at.VOLTAGE] == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("lags", [0.0, 0.02])
@pytest.mark.parametrize("commanded", [0.0, 1.0])
def test_limits_are_kept_and_told(commanded, lags):
    """The commanded quantity, and the other one too where the table does not drive the coil beyond
    it; ``limited`` says so.
    """
    values = {**LIMITS, "coil_inductance": lags, "current_control": commanded}
    m = started(**values, command=0.3, command_1=4.0, command_2=-40.0, command_3=70.0)
    seen = set()
    for k in range(1, 401):
        advanced(m, k / 200)
        voltage, current = abs(m[at.VOLTAGE]), abs(m[at.CURRENT])
        assert voltage <= 3.0 * (1 + 1e-12) and current <= 0.5 * (1 + 1e-12)
        at_limit = voltage > 3.0 * (1 - 1e-9) or current > 0.5 * (1 - 1e-9)
        assert m[at.LIMITED] == at_limit
        seen.add((m[at.LIMITED], voltage > 3.0 * (1 - 1e-9)))
    assert len(seen) >= 2


@pytest.mark.parametrize("command", [2.0, 2.0 + 1e-12, -2.0, 2.0 - 1e-12])
def test_a_command_at_its_limit(command):
    """A constant at the limit is not clipped; just beyond it is."""
    m = started(command=command, voltage_limit=2.0)
    assert m[at.VOLTAGE] == max(-2.0, min(2.0, command))
    assert m[at.LIMITED] == float(abs(command) > 2.0)
    advanced(m, 5.0)
    assert m[at.LIMITED] == float(abs(command) > 2.0)


def test_no_event_is_missed():
    """A command that is a ten millionth beyond its limit for 0.6 ms, and stops that a free table
    reaches by a millionth of a millimetre, in steps that are much longer.
    """
    peak = 2.0 + 1e-7  # command = peak - (t - 1)^2
    cubic = {"command": peak - 1.0, "command_1": 2.0, "command_2": -2.0}
    m = advanced(started(**cubic, voltage_limit=2.0), 1.5)
    assert m[at.ORIGIN] == pytest.approx(1.0 + 1e-7**0.5, abs=1e-9)  # of the last state
    assert advanced(started(**cubic, voltage_limit=2.0), 1.0)[at.LIMITED] == 1.0
    below = {**cubic, "command": peak - 1.0 - 2e-7}
    assert advanced(started(**below, voltage_limit=2.0), 1.5)[at.ORIGIN] == 0.0
    swing = {"force_factor": 0.0, "suspension_damping": 0.0, "velocity_start": 0.1}
    highest = 0.1 / np.sqrt(1375.0 / 5.5)
    assert stepper.advance(started(**swing, travel_limit=highest + 1e-9), 50.0) == at.OK
    m = started(**swing, travel_limit=highest - 1e-9)
    assert stepper.advance(m, 50.0) == at.TRAVEL
    assert m[at.REPORT] == pytest.approx(0.5 * np.pi / np.sqrt(250.0), abs=1e-3)
    assert m[at.BOX_POSITION] == pytest.approx(highest - 1e-9, rel=1e-14)
