"""What is refused by the functions of the weak drive: one line with the name and the value."""

import math

import pytest
import xarray as xr

import orchestrate
from orchestrate import InputError, SpeedControl, SpeedGradient
from orchestrate.fmu import MOTOR_SHAKER
from orchestrate.weak_drive.drive_spectra import drive_spectra, voltage_at_resonance
from orchestrate.weak_drive.ssp import write_ssp

from .coupled import QUICK

STRONG = QUICK.drive.replace(armature_resistance=1e-3 * QUICK.drive.armature_resistance)
RAMP, NAN = {"voltage": (1.2, 1.6)}, float("nan")
MISTAKES = {  # by function: what is given, what the line says
    orchestrate.couple: [
        ({"voltage": (1.2, 1.2)}, "(1.2, 1.2) | different"),
        ({"voltage": 1.2}, "voltage = 1.2 | duration"),
        ({**RAMP, "duration": 3.0}, "duration = 3.0 | rate"),
        ({"voltage": (1.0, 1.2, 1.4)}, "(1.0, 1.2, 1.4) | (first, last)"),
        ({"voltage": "high", "duration": 1.0}, "'high' | a number"),
        ({"voltage": (1.2, NAN)}, "voltage = nan | finite"),
        ({**RAMP, "rate": 0.0}, "rate = 0.0 | > 0"),
        ({**RAMP, "rate": NAN}, "rate = nan | > 0"),
        ({**RAMP, "rate": 1e-12}, "steps | at most 1e+09"),
        ({**RAMP, "step": -0.1}, "step = -0.1 | 0.0001 <= step <= 1"),
        ({**RAMP, "increment": 2.0}, "increment = 2.0 | 0 <= increment <= 0.4"),
        ({**RAMP, "settle": -1.0}, "settle = -1.0 | 0 <= settle"),
        ({**RAMP, "hold": -1.0}, "hold = -1.0 s | 0 <= hold"),
        ({**RAMP, "speed_start": math.inf}, "speed_start = inf | finite"),
        ({**RAMP, "tolerance": -1.0}, "tolerance | >= 0"),
        ({"voltage": 1.5, "duration": 1e-10}, "duration = 1e-10 s | one communication step"),
        ({"voltage": 0.001, "duration": 10.0}, "no revolution in 10 s | raise the voltage"),
        ({**RAMP, "fmu": {MOTOR_SHAKER: "nowhere.fmu"}}, "nowhere.fmu: no such file"),
        ({**RAMP, "control": "pi"}, "control = 'pi' | SpeedControl(...)"),
        ({**RAMP, "drive": QUICK.drive.replace(motor_constant=0.0)}, "motor_constant = 0.0 N.m/A"),
    ],
    orchestrate.passage: [
        ({**RAMP, "around": 0.0}, "around = 0.0 s | 0 < around"),
        ({"voltage": 1.5, "duration": 0.0}, "duration = 0 s | one communication step"),
    ],
    orchestrate.capture: [
        ({"voltage": 1.5}, "voltage = 1.5 | (lowest, highest)"),
        ({"voltage": (1.6, 1.5)}, "(1.6, 1.5) | (lowest, highest)"),
        ({"voltage": (-1.0, 1.5)}, "voltage = -1.0 | 0 <= voltage"),
        ({"count": 1}, "count = 1 | from 2"),
        ({"tolerance": 0.0}, "tolerance = 0.0 | 0 < tolerance"),
        ({"time": -1.0}, "time = -1.0 | 0 < time"),
        ({"time": 1e-300}, "1e-300 | one communication step"),
        ({"stay": 0}, "stay = 0 | from 1"),
        ({"over": "D"}, "over = 'D' | both"),
        ({"over": "colour", "values": [1.0]}, "colour | no parameter"),
        ({"over": "rotor_inertia", "values": [-1.0]}, "rotor_inertia = -1.0 | <="),
        ({"over": "D", "values": [0.1, 0.1]}, "values = [0.1, 0.1] | each once"),
        ({"over": "D", "values": ["x"]}, "values = ['x'] | numbers"),
        ({"step": 9.0}, "step = 9.0 | <= 1"),
        ({"control": 3}, "control = 3 | SpeedControl"),
    ],
    orchestrate.drive_branch: [
        ({"speed": (1.4, 1.2)}, "speed = (1.4, 1.2) rad/s"),
        ({"most": 1}, "most = 1 | from 2"),
        ({"period": True}, "period = True | whole number"),
        ({"longest": 2.0}, "longest = 2.0"),
        ({"settle": -1.0}, "settle = -1.0"),
    ],
    drive_spectra: [
        ({"points": 3}, "points = 3 | from 4"),
        ({"revolutions": True}, "revolutions = True | from 1"),
        ({"points": 64, "highest": 99}, "highest = 99 | points/2 = 32"),
        ({"voltage": 0.001, "begin": 0.0009, "hold": 1.0}, "no two revolutions"),
    ],
    lambda structure, drive, progress: voltage_at_resonance(structure, STRONG): [({}, "voltage")],
    lambda *_, progress, **of: orchestrate.waterfall(**of): [
        ({"found": xr.Dataset({"x1": ("time", [0.0])})}, "no angle in the dataset"),
        ({"found": xr.Dataset(), "mass": 3}, "mass = 3 | 1 or 2"),
        ({"found": xr.Dataset(), "revolutions": 0}, "revolutions = 0 | from 1"),
        ({"found": xr.Dataset(), "highest": 0.0}, "highest = 0.0 | 0 < highest"),
    ],
    lambda one, drive, progress, **of: orchestrate.couple_all({"one": (one, drive)}, **of): [
        ({"rates": [0.0]}, "rate = 0.0 | > 0"),
        ({"rates": []}, "expected one of each"),
        ({"kinds": ["glued"]}, "kinds = 'glued' | bonded or delaminated"),
    ],
    lambda *_, progress, **of: SpeedControl(**{"speed": 1.0, "gain": 1.0, **of}): [
        ({"speed": NAN}, "speed = nan | finite"),
        ({"gain": 0.0}, "gain = 0.0 V.s/rad | 0 < gain"),
        ({"gain": "1"}, "gain = 1 | 0 < gain"),
        ({"reset_time": 0.0}, "0 < reset_time"),
        ({"rise": -1.0}, "0 < rise"),
    ],
    lambda *_, progress, **of: SpeedGradient(**{"filter_time": 1.0, "passed": 1.0, **of}): [
        ({"filter_time": -1.0}, "0 < filter_time"),
        ({"passed": 0.0}, "0 < passed"),
        ({"low": 1.5}, "0 <= low <= 1"),
    ],
    lambda *both, progress, **of: write_ssp("nowhere/x.ssp", *both, **of): [
        ({"voltage": 1.0, "step": 0.0}, "step = 0.0 s | 0 < step"),
        ({"voltage": NAN}, "voltage = nan V | finite"),
        ({"voltage": 1.0, "version": "3.0"}, "version = '3.0' | '1.0' or '2.0'"),
        ({}, "voltage: expected with a motor"),
        ({"voltage": 1.0}, "nowhere"),
    ],
}
USUAL = {orchestrate.capture: {"voltage": (1.4, 1.6)}}


@pytest.mark.parametrize(
    ("function", "given", "words"),
    [(function, *row) for function, rows in MISTAKES.items() for row in rows],
)
def test_a_mistake_is_one_line(function, given, words):
    structure, drive = QUICK
    asked = {"drive": drive, **USUAL.get(function, {}), **given}
    with pytest.raises((InputError, orchestrate.errors.StoreError)) as caught:
        function(structure, asked.pop("drive"), progress=False, **asked)
    assert all(part.strip() in str(caught.value) for part in words.split("|")), str(caught.value)
    assert "\n" not in str(caught.value)
