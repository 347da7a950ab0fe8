"""The passage at full resolution, and spectra over revolutions."""

import numpy as np
import pytest
import xarray as xr

from orchestrate import Course, cosimulate, couple, passage, waterfall

from .coupled import BEAM, QUICK

FAST = {"voltage": (1.54, 1.66), "rate": 4e-4, "back": False, "settle": 50.0, "step": 0.2}
FAST |= {"progress": False}


@pytest.fixture(scope="module")
def whole():
    return passage(*QUICK, **FAST, hold=0.0)


def test_it_is_the_run_that_couple_makes(whole):
    """Jumps, energies, and the speed of each revolution are the same; then around the jump only."""
    run, near = couple(*QUICK, **FAST), passage(*QUICK, **FAST, around=40.0)
    for name in ("jump_low", "jump_time", "jump_speed_before"):
        assert near[name].values == pytest.approx(run[name].values, nan_ok=True), name
    ends = np.interp(2.0 * np.pi * run.revolution, whole.angle, whole.time)
    assert run.time.values == pytest.approx(ends, abs=1e-3)
    for name in ("motor", "dampers", "impact_loss"):
        at = np.interp(run.time[-5:], whole.time, whole[name])
        assert run[name].values[-5:] == pytest.approx(at, rel=1e-3), name
    assert (whole.x2 - whole.x1).min() > -1e-9
    expected = whole.sel(time=slice(*(float(near.jump_time[0]) + np.array([-40.0, 40.0]))))
    assert expected.sizes["time"] == 400
    assert near.attrs["kept"] == "around jumps" and whole.attrs["kept"] == "the whole run"
    assert near.x1.equals(expected.x1) and near.speed.equals(expected.speed)


@pytest.mark.parametrize(
    ("volts", "kept", "middle"), [(1.2, "the end", 180.0), (2.4, "around the passage", None)]
)
def test_without_a_jump_the_passage_or_the_end_is_kept(volts, kept, middle):
    run = {"duration": 200.0, "speed_start": 0.6, "step": 0.2, "progress": False}
    found = passage(*QUICK.as_bonded(), voltage=volts, around=20.0, **run)
    centre = float(found.passage_time) if middle is None else middle
    assert found.attrs["kept"].startswith(kept)
    assert np.abs(found.time - centre).max() == pytest.approx(20.0, abs=0.21)


def test_a_course_acts_as_in_cosimulate():
    """With a kink and a step within communication steps: the same bits of the speed."""
    structure, drive = BEAM
    unit, volts, h = 1.0 / structure.omega, drive.volts(structure), 0.1 / structure.omega
    times, values = np.array([0.0, 20.3, 47.77, 47.77, 60.0]), [1.0, 1.3, 1.2, 1.6, 1.55]
    course = Course(tuple(times * unit), tuple(np.array(values) * volts))
    mine = passage(*BEAM, voltage=course, step=h, hold=0.0, progress=False)
    how = {"duration": 60.0 * unit, "step": h, "estimate": False, "progress": False}
    begun = {"speed_start": volts / drive.motor_constant}
    other = cosimulate(*BEAM, parameters=begun, inputs={"voltage": course}, record="speed", **how)
    assert (mine.speed.values == other.speed.values[1:]).all()
    assert mine.x1.values == pytest.approx(other.x1.values[1:], abs=1e-14)


def test_lines_of_known_motions(whole):
    """Mass and box at three times a speed that rises: one line, A (3 w)^2, all the time. `quick`
    repeats after two revolutions at its resonance: lines at halves of the speed.
    """
    time = np.arange(0.0, 300.0, 0.05)
    angle, speed = time + 2e-4 * time**2, 1.0 + 4e-4 * time
    wave, slope = np.cos(3.0 * angle), -3.0 * speed * np.sin(3.0 * angle)
    columns = {"angle": angle, "x2": 0.7 * wave, "v2": 0.7 * slope, "voltage": 2.0 * time}
    columns |= {"box_position": 0.3 * wave, "box_velocity": 0.3 * slope, "x1": 0.0 * time}
    columns["v1"] = 0.0 * time
    made = xr.Dataset({name: ("time", values) for name, values in columns.items()}, {"time": time})
    found = waterfall(made, mass=2, revolutions=8)
    expected = (3.0 * found.speed.values) ** 2
    assert found.acceleration.sel(order=3.0).values == pytest.approx(expected, rel=2e-3)
    assert found.acceleration.sel(order=[1.0, 2.0, 5.0]).max() < 1e-3 * expected.max()
    assert found.speed.values == pytest.approx(1.0 + 4e-4 * found.time.values, rel=1e-3)
    assert found.voltage.values == pytest.approx(2.0 * found.time.values, rel=1e-9)
    assert found.order[-1] == 6.0 and found.order[1] == 1 / 8
    halves = waterfall(whole.sel(time=slice(0, 250)), revolutions=8).isel(time=-1).acceleration
    assert halves.sel(order=1.0) > 10.0 * halves.sel(order=2.5) > 100.0 * halves.sel(order=2.25)
