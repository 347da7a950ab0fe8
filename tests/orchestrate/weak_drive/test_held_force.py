"""Drives that take a held force: errors against one system, their order, and what is stated."""

import warnings

import numpy as np
import pytest

import orchestrate

from .drives.linear import displacement_error, table_drive, together
from .monolithic import Monolith

STEPS = (0.1, 0.05, 0.025)
START, DURATION = (0.0, 0.5, 0.0, 0.0), 20.0
TIMES = np.linspace(0.0, DURATION, round(DURATION / STEPS[-1]) + 1)
STRUCTURE = orchestrate.Structure(m1=1.0, m2=1.0, k1=1.0, k2=1.2, d1=0.01, d2=0.01, e=0.7)
MOTOR = orchestrate.Drive(
    **{"box_mass": 3.6667, "box_stiffness": 0.036667, "box_damping": 0.0036667},
    **{"unbalance_mass": 0.01, "unbalance_radius": 100.0, "rotor_inertia": 300.0},
    **{"motor_constant": 6.0, "armature_resistance": 6.0, "armature_inductance": 0.5},
)
MOTIONS = {"a": "box_acceleration", "v": "box_velocity", "p": "box_position"}
ERRORS = {  # m, at most, with steps of STEPS
    ("motor", "avp"): (1.3e-6, 9.0e-8, 6.0e-9),
    (0.2, "av"): (1.3e-4, 9.0e-6, 6.0e-7),
    (0.2, "v"): (1.8e-3, 1.5e-4, 1.2e-5),
    (0.2, "a"): (1.6e-2, 2.2e-3, 3.0e-4),
    (5.5, "p"): (3.2e-3, 6.5e-4, 1.0e-4),
}
ORDER = {"p": 2.4}  # at least, by regression over STEPS
pytestmark = pytest.mark.usefixtures("exported")


def shaker(mass, stiffness=0.055, damping=0.0055):
    numbers = {"mass": mass, "stiffness": stiffness, "damping": damping}
    return table_drive({**numbers, "bl": 1.0, "r": 1.0, "l": 0.1})


def system_of(name, letters, folder, exported):
    """The drive, its arguments, and the truth: displacements and impacts."""
    if name == "motor":
        names = {"box_force": "box_force", **{MOTIONS[one]: MOTIONS[one] for one in letters}}
        start = {**MOTOR.parameters(), "speed_start": 1.25}
        own = {"parameters": start, "inputs": {"voltage": 7.8}}
        state = [0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 1.25, 0.0]
        rows, impacts = Monolith(STRUCTURE, MOTOR, 7.8).solve(state, TIMES)
        drive = exported / "fmi3" / "MotorShaker.fmu"
        return drive, {**own, "connect": names}, rows[:, [0, 2]], impacts
    drive = shaker(name)
    own = {"parameters": drive.parameters, "inputs": {"command": 1.5}}
    truth = together(drive, STRUCTURE, lambda _: 1.5, TIMES, START)
    return drive.write(folder), {**own, "connect": drive.connected(letters)}, *truth


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(("name", "letters"), ERRORS)
def test_a_held_force_costs_no_order(tmp_path, exported, name, letters):
    drive, own, truth, impacts = system_of(name, letters, tmp_path, exported)
    run = {"duration": DURATION, "start": START, "estimate": False, "progress": False, **own}
    errors = []
    for step, most in zip(STEPS, ERRORS[name, letters], strict=True):
        found = orchestrate.cosimulate(STRUCTURE, drive, step=step, **run)
        assert found.sizes["impact"] == impacts >= 6
        errors.append(displacement_error(found, truth))
        assert errors[-1] <= most
    assert np.polyfit(np.log(STEPS), np.log(errors), 1)[0] > ORDER.get(letters, 2.7)


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("letters", ["p", "av", "avp"])
def test_a_step_that_is_too_long_for_a_stiff_drive_is_said(tmp_path, letters):
    """A table on a suspension of 500 rad/s: its velocity swings within a step of 0.01 s."""
    drive = shaker(0.5, 125e3, 1.0)
    run = {"connect": drive.connected(letters), "parameters": drive.parameters, "start": START}
    run |= {"duration": 0.5, "estimate": False, "progress": False}
    path, missing = drive.write(tmp_path), "box_velocity" if letters in "ap" else "box_position"
    with warnings.catch_warnings(record=True) as shown:
        warnings.simplefilter("always")
        orchestrate.cosimulate(STRUCTURE, path, step=0.01, **run)
    said = [str(one.message) for one in shown if "the step is too long" in str(one.message)]
    assert len(said) == (letters != "avp") and all(missing in text for text in said)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        orchestrate.cosimulate(STRUCTURE, path, step=0.001, **run)
