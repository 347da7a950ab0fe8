"""Mistakes with ``MotorShaker``, and what the message must name; read by test and fresh process."""

import math

MISTAKES = [
    (lambda f: f.start(box_mass=0.0), ["box_mass = 0.0 kg", "1e-30 <= box_mass <= 1e+30"]),
    (lambda f: f.start(armature_resistance=-1.0), ["armature_resistance = -1.0 Ohm", "1e-30 <="]),
    (lambda f: f.start().set(voltage=math.nan), ["voltage = nan V", "-1e+30 <= voltage <= 1e+30"]),
    (lambda f: f.start().set(box_force_2=math.inf), ["box_force_2 = inf N/s2", "expected"]),
    (lambda f: f.start().set(rotor_inertia=1.0), ["rotor_inertia = 1.0", "fixed parameter"]),
    (lambda f: f.start().set(speed=1.0), ["speed = 1.0", "output"]),
    (
        lambda f: f.start(rotor_inertia=1e-9),
        ["rotor_inertia = 1e-09 kg.m2", "unbalance_mass = 0.025 kg", "expected rotor_inertia >= "],
    ),
    (
        lambda f: f.start(armature_inductance=1e-9, voltage=5.0).step(1.0),
        ["armature_inductance = 1e-09 H", "expected 0 H", "cannot finish", "reached 0.0 s"],
    ),
    (
        lambda f: f.start().step(math.nan),
        ["communicationStepSize = nan s", "expected every finite number >= 0"],
    ),
    (lambda f: f.start().step(-1.0), ["communicationStepSize = -1.0 s", "expected"]),
    (
        lambda f: f.start(voltage=1e30).step(1.0),
        ["range of floating-point numbers"],
    ),
]
