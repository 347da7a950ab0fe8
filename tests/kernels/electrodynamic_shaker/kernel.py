"""Memories of the kernel, and random shakers of every kind."""

import numpy as np

from fmu_src.kernels.electrodynamic_shaker import memory as at
from fmu_src.kernels.electrodynamic_shaker import stepper

from .truth import DEFAULTS

OUTPUTS = range(at.BOX_POSITION, at.EVALUATIONS)
INPUTS = [f"{name}{order}" for name in ("command", "box_force") for order in ("", "_1", "_2", "_3")]


def memory_of(**values):
    """A memory with values by name."""
    m = [0.0] * at.SIZE
    for name, value in {**DEFAULTS, **values}.items():
        m[getattr(at, name.upper())] = float(value)
    return m


def started(**values):
    """A memory, initialised at 0 s."""
    m = memory_of(**values)
    assert stepper.initialize(m, 0.0) == at.OK
    return m


def advanced(m, *times):
    """The memory, advanced through communication points."""
    for time in times:
        assert stepper.advance(m, time) == at.OK
    return m


def outputs(m):
    """All outputs of the motion."""
    return [m[slot] for slot in OUTPUTS]


def set_inputs(m, **values):
    """Set inputs, as the exporters do."""
    for name, value in values.items():
        m[getattr(at, name.upper())] = value
        m[at.COMMAND_SET if name.startswith("command") else at.FORCE_SET] = 1.0


def draw(seed):
    """Random values of a shaker: voltage or current control, with and without inductance, no limit,
    one or both, cubic command and force over a second, start values.
    """
    rng = np.random.default_rng(seed)
    lags, commanded, voltage, current = (bool(seed >> bit & 1) for bit in range(4))
    values = {
        "table_mass": rng.uniform(0.5, 5.0),
        "suspension_stiffness": rng.uniform(100.0, 4000.0),
        "suspension_damping": rng.uniform(0.0, 30.0),
        "force_factor": rng.uniform(5.0, 40.0),
        "coil_resistance": rng.uniform(0.5, 5.0),
        "coil_inductance": rng.uniform(2e-3, 5e-2) if lags else 0.0,
        "current_control": float(commanded),
        "voltage_limit": rng.uniform(0.5, 6.0) if voltage else 0.0,
        "current_limit": rng.uniform(1.0, 2.0) if current else 0.0,
        "position_start": 0.01 * rng.normal(),
        "velocity_start": 0.3 * rng.normal(),
        "current_start": rng.uniform(-1.0, 1.0),
    }
    for name, size in (("command", 1.0), ("box_force", 20.0)):
        for order in range(4):
            key = f"{name}_{order}" if order else name
            values[key] = size * 8.0**order * rng.normal()
    return values
