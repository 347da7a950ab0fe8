"""Mistakes with ``ElectrodynamicShaker``, and what the message must name; read by test and fresh
process.
"""

import math

LAGS = {"coil_inductance": 0.01}
MISTAKES = [
    (lambda f: f.start(table_mass=0.0), ["table_mass = 0.0 kg", "1e-30 <= table_mass <= 1e+30"]),
    (lambda f: f.start(coil_resistance=-1.0), ["coil_resistance = -1.0 Ohm", "1e-30 <="]),
    (lambda f: f.start(force_factor=math.nan), ["force_factor = nan N/A", "expected"]),
    (lambda f: f.start(voltage_limit=-5.0), ["voltage_limit = -5.0 V", "0.0 <= voltage_limit"]),
    (lambda f: f.start().set(command=math.nan), ["command = nan V", "-1e+30 <= command <= 1e+30"]),
    (lambda f: f.start().set(box_force_2=math.inf), ["box_force_2 = inf N/s2", "expected"]),
    (lambda f: f.start().set(table_mass=1.0), ["table_mass = 1.0", "fixed parameter"]),
    (lambda f: f.start().set(current=1.0), ["current = 1.0", "output"]),
    (
        lambda f: f.start(position_start=-0.02, travel_limit=0.01),
        ["position_start = -0.02 m", "within travel_limit = 0.01 m"],
    ),
    (
        lambda f: f.start(current_start=3.0, current_limit=2.0, **LAGS),
        ["current_start = 3.0 A", "within current_limit = 2.0 A"],
    ),
    (
        lambda f: f.start(command=40.0, travel_limit=0.01).step(2.0),
        ["box_position = 0.01", " m at time = 0.0", "time = 2.0 s", "travel_limit = 0.01 m"],
    ),
    (
        lambda f: f.start(coil_inductance=1e-9, command=5.0).step(1.0),
        ["coil_inductance = 1e-09 H", "expected 0 H", "cannot finish", "reached 0.0 s"],
    ),
    (
        lambda f: f.start().step(math.nan),
        ["communicationStepSize = nan s", "expected every finite number >= 0"],
    ),
    (lambda f: f.start().step(-1.0), ["communicationStepSize = -1.0 s", "expected"]),
]
