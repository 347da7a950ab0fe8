"""A step ends, whatever is allowed: with success, or with a message that says why."""

import pytest

from .driver import FORMS, MODELS, path_of, run

OSCILLATOR, MOTOR, COIL = MODELS
PRESSED = {"bonded": True}
AT_REST = {"box_amplitude": 0.0}
LIGHT = {"m1": 1e-24, "m2": 1e-24}
STIFF = {"k1": 1e24, "sample_count": 1, "evaluation_limit": 20000}
FAST = {"box_frequency": 1e24, "box_jerk": -5.4e12, "sample_count": 61}
STEEP = {"d2": 1e24, "m2": 1e-24, "k1": 1e-24, "m1": 1e24}
COUNTED = "too long; numbers that count by one"
STEPS = [  # model, start time, what is set, length of the step, and what the message names
    (OSCILLATOR, 0.0, PRESSED, 1e17, f"{COUNTED}; k1 = 1.0 N/m"),
    (OSCILLATOR, 0.0, PRESSED, 1e15, ""),
    (OSCILLATOR, 0.0, PRESSED | LIGHT, 1e10, f"{COUNTED}; m1 = 1e-24 kg"),
    (OSCILLATOR, 0.0, STIFF, 1e10, f"{COUNTED}; k1 = 1e+24 N/m"),
    (OSCILLATOR, 0.0, STIFF, 100.0, "is discarded: evaluation_limit = 20000"),
    (OSCILLATOR, 0.0, FAST, 1e5, f"{COUNTED}; box_frequency = 1e+24 rad/s"),
    (OSCILLATOR, 0.0, AT_REST | {"clearance": 1.0}, 1e17, COUNTED),
    (OSCILLATOR, 0.0, AT_REST | PRESSED | {"box_frequency": 1e24}, 1e6, COUNTED),
    (OSCILLATOR, 0.0, STEEP, 1.0, "d2 = 1e+24 N.s/m; d/m of at most 1e36 sqrt(k1/m1)"),
    (OSCILLATOR, 0.0, STEEP | {"d2": 1.0, "box_frequency": 1e24}, 1.0, "box_frequency = 1e+24"),
    (OSCILLATOR, -1e308, PRESSED, 1e308, COUNTED),
    (OSCILLATOR, 1e308, PRESSED, 1e308, "expected a step that ends at a finite time"),
    (MOTOR, 0.0, {"armature_inductance": 1e-300}, 1.0, "armature_inductance = 1e-300 H; 0 H"),
    (MOTOR, 1e308, {}, 1e308, "expected a step that ends at a finite time"),
    (COIL, 0.0, {"coil_inductance": 1e-300}, 1.0, "coil_inductance = 1e-300 H; expected 0 H, or"),
    (COIL, 1e308, {}, 1e308, "expected a step that ends at a finite time"),
]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("model", MODELS)
def test_a_step_of_any_length_ends(exported, tmp_path, form, model):
    steps = [step[1:] for step in STEPS if step[0] == model]
    asked, where = [step[:-1] for step in steps], {"cwd": tmp_path, "timeout": 60}
    messages = run("runs.refusals", path_of(model, form), asked, **where)
    for message, (*_, words) in zip(messages, steps, strict=True):
        assert all(part in message for part in words.split("; ")), message
        assert bool(message) == bool(words)
