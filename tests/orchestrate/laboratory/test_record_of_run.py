"""The run of a weak drive as a record, against the motion that it comes from."""

import warnings

import numpy as np

from orchestrate import Drive, Sensor, Structure, SweptSine, measure, passage, record_of_run, shake

QUICK = Structure.from_file("quick"), Drive.from_file("quick")


def test_mass_times_acceleration_of_the_box_is_the_force_on_it():
    """Newton's law for all that moves, delaminated: masses, box and unbalance (M_t is with it)."""
    structure, drive = QUICK
    data = passage(*QUICK, voltage=1.4, duration=200.0, progress=False)
    made = record_of_run(data)
    s, w = drive.unbalance_mass * drive.unbalance_radius, data.speed.values
    angle = data.angle.values
    turning = np.gradient(w, data.time.values)
    unbalance = s * (w**2 * np.sin(angle) - turning * np.cos(angle))
    spring = -drive.box_stiffness * data.box_position - drive.box_damping * data.box_velocity
    total = drive.box_mass * made.box_acceleration.values
    total = total + structure.m1 * made.acceleration1.values
    total = total + structure.m2 * made.acceleration2.values
    inner = slice(2, -2)  # of the differences
    peak = np.abs(total).max()
    away = np.abs(total - spring.values - unbalance)[inner] / peak
    assert np.median(away) < 1e-3 and len(made.time) == 2000


def test_simulated_numbers_have_their_unit():
    """No question whether they are in g, however small."""
    sweep = SweptSine(first=10.0, last=14.0, duration=1.0, acceleration=1e-4)
    history = shake(Structure.from_file("beam"), sweep, progress=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        measure(history, Sensor(bandwidth=200.0), excitation=sweep)
