"""A shaker's table held at a level: against the linear response."""

import math
from dataclasses import replace

import numpy as np
import pytest

import orchestrate
from orchestrate.weak_drive import cosimulate

HALVES = {"m1": 0.10, "m2": 0.08, "f1": 42.0, "f2": 55.0, "zeta1": 0.02, "zeta2": 0.02, "e": 0.6}
BEAM = orchestrate.Structure.from_halves(**HALVES)
SHAKER = orchestrate.Shaker.from_file("shaker_100N").replace(table_mass=0.4)
LEVEL = 4.0
STEPS = orchestrate.SteppedSine(
    frequencies=(40.0, 46.0), acceleration=LEVEL, settle_cycles=60, measured_cycles=10
)


def impedance(shaker, structure, frequency):
    """Command and current for a unit acceleration of the table, as complex amplitudes."""
    s, n = 2j * math.pi * frequency, structure
    m, d, k = n.m1 + n.m2, n.d1 + n.d2, n.k1 + n.k2
    force = (d * s + k) * -m / (m * s**2 + d * s + k)  # of the beam on the table
    y = 1.0 / s**2
    own = shaker.table_mass + (shaker.suspension_damping * s + shaker.suspension_stiffness) * y
    current = (own - force) / shaker.force_factor
    coil = shaker.coil_resistance + s * shaker.coil_inductance
    return current * coil + shaker.force_factor * s * y, current


def fundamental(run, name, window, sine):
    """Complex amplitude of a signal over a measured part."""
    part = run.sel(time=slice(*window))
    phase = sine.phase(part.time.values)
    basis = np.column_stack([np.sin(phase), np.cos(phase), np.ones(len(phase))])
    a, b, _ = np.linalg.lstsq(basis, part[name].values, rcond=None)[0]
    return complex(a, b)


@pytest.mark.usefixtures("exported")
def test_the_level_is_held_and_the_current_is_that_of_the_linear_system():
    run = orchestrate.shake(BEAM.as_bonded(), STEPS, shaker=SHAKER, progress=False)
    for window, frequency in zip(STEPS.measured_times(), STEPS.frequencies, strict=True):
        table, current, voltage = (
            fundamental(run, name, window, STEPS)
            for name in ("box_acceleration", "current", "voltage")
        )
        expected = impedance(SHAKER, BEAM, frequency)
        assert abs(table) == pytest.approx(LEVEL, rel=0.02)
        assert voltage / table == pytest.approx(expected[0], rel=2e-3)
        assert current / table == pytest.approx(expected[1], rel=2e-3)


@pytest.mark.usefixtures("exported")
def test_it_aborts_where_the_amplifier_cannot():
    weak, one = SHAKER.replace(voltage_limit=0.05), {"frequencies": (40.0,), "settle_cycles": 118}
    run = orchestrate.shake(BEAM, replace(STEPS, **one), shaker=weak, progress=False)
    end = float(run.control_aborted)
    assert 100.0 < 40.0 * end < 125.0  # periods of `rise` and `patience`
    assert abs(run.voltage.sel(time=slice(end + 0.01, None))).max() == 0.0
    assert abs(run.voltage).max() == pytest.approx(0.05, rel=0.01)


def test_the_command_of_a_rigid_load_is_that_of_the_equations():
    rigid = BEAM.replace(k1=1e9, k2=1e9, d1=0.0, d2=0.0)
    for shaker in (SHAKER, SHAKER.replace(current_control=True)):
        voltage, current = impedance(shaker, rigid, 40.0)
        command = abs(current if shaker.current_control else voltage)
        assert shaker.command_for(2.0, 40.0, 0.18) == pytest.approx(2.0 * command, rel=1e-4)


@pytest.mark.usefixtures("exported")
def test_a_controlled_run_resumes_with_the_same_bits(monkeypatch):
    control = orchestrate.LevelControl(sine=STEPS, start=0.05)
    run = {"inputs": {"command": control}, "duration": 0.2, "step": 1e-3, "record": ["current"]}
    run |= {"progress": False}
    whole = orchestrate.cosimulate(BEAM, SHAKER, **run)
    monkeypatch.setattr(cosimulate.CosimulateJob, "chunk_size", 57)
    parts = orchestrate.cosimulate(BEAM, SHAKER, **run)
    for name in ("x1", "current", "box_acceleration", "coupling_error"):
        assert parts[name].values.tobytes() == whole[name].values.tobytes(), name
    assert float(abs(whole.box_acceleration).max()) > 0.1 * LEVEL
