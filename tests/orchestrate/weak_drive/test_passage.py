"""The passage at full resolution, and spectra over revolutions."""

import numpy as np
import pytest
import xarray as xr

from orchestrate import Course, InputError, capture, cosimulate, couple, passage, waterfall

from .coupled import BEAM, QUICK

FAST = {"voltage": (1.5, 1.7), "rate": 4e-4, "back": False, "settle": 50.0, "step": 0.1}
FAST |= {"progress": False}


@pytest.fixture(scope="module")
def whole():
    """A run through the jump."""
    return passage(*QUICK, **FAST)


def test_it_is_the_run_that_couple_makes(whole):
    """Jumps, energies, and the speed of each revolution are the same."""
    run = couple(*QUICK, **FAST)
    for name in ("jump_low", "jump_time", "jump_speed_before"):
        assert whole[name].values == pytest.approx(run[name].values, nan_ok=True), name
    assert np.isfinite(whole.jump_time[0])
    ends = np.interp(2.0 * np.pi * run.revolution, whole.angle, whole.time)
    assert run.time.values == pytest.approx(ends, abs=1e-3)
    for name in ("motor", "dampers", "impact_loss"):
        at = np.interp(run.time[-5:], whole.time, whole[name])
        assert run[name].values[-5:] == pytest.approx(at, rel=1e-3), name
    assert (whole.x2 - whole.x1).min() > -1e-9


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


def test_only_around_the_jump(whole):
    near = passage(*QUICK, **FAST, around=40.0)
    expected = whole.sel(time=slice(*(float(whole.jump_time[0]) + np.array([-40.0, 40.0]))))
    assert near.attrs["kept"] == "around jumps"
    assert near.x1.equals(expected.x1) and near.speed.equals(expected.speed)


def test_lines_of_a_known_motion():
    """Mass and box at three times a speed that rises: one line, A (3 w)^2, all the time."""
    time = np.arange(0.0, 300.0, 0.05)
    angle, speed = time + 2e-4 * time**2, 1.0 + 4e-4 * time
    wave, slope = np.cos(3.0 * angle), -3.0 * speed * np.sin(3.0 * angle)
    columns = {"angle": angle, "x1": 0.7 * wave, "v1": 0.7 * slope, "voltage": 0.0 * time}
    columns |= {"box_position": 0.3 * wave, "box_velocity": 0.3 * slope}
    made = xr.Dataset({name: ("time", values) for name, values in columns.items()}, {"time": time})
    found = waterfall(made, revolutions=8)
    expected = (3.0 * found.speed.values) ** 2
    assert found.acceleration.sel(order=3.0).values == pytest.approx(expected, rel=2e-3)
    assert found.acceleration.sel(order=[1.0, 2.0, 5.0]).max() < 1e-3 * expected.max()
    assert found.speed.values == pytest.approx(1.0 + 4e-4 * found.time.values, rel=1e-3)


def test_halves_with_impacts(whole):
    """`quick` repeats after two revolutions at its resonance: lines at halves of the speed."""
    found = waterfall(whole.sel(time=slice(0, 250)), revolutions=8).isel(time=-1).acceleration
    assert found.sel(order=1.0) > 10.0 * found.sel(order=2.5) > 100.0 * found.sel(order=2.25)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ({"mass": 3}, ["mass = 3", "1 or 2"]),
        ({"revolutions": 0}, ["revolutions = 0", "from 1"]),
        ({"revolutions": 5000}, ["revolutions = 5000", "at most"]),
        ({"highest": 0.0}, ["highest = 0.0", "0 < highest"]),
    ],
)
def test_mistakes_of_spectra(whole, arguments, parts):
    with pytest.raises(InputError) as caught:
        waterfall(whole, **arguments)
    assert all(part in str(caught.value) for part in parts), str(caught.value)


def test_mistakes():
    with pytest.raises(InputError, match="around = 0.0 s: expected 0 < around"):
        passage(*QUICK, **FAST, around=0.0)
    with pytest.raises(InputError, match="no angle in the dataset: expected one of passage"):
        waterfall(xr.Dataset({"x1": ("time", [0.0])}))


@pytest.mark.parametrize("duration", [1e-10, 0.0, 1e-300])
def test_a_run_of_no_step_is_refused(duration):
    with pytest.raises(InputError, match="duration = .* one communication step or more"):
        passage(*QUICK, voltage=1.5, duration=duration, progress=False)
    with pytest.raises(InputError, match="one communication step or more|0 < time"):
        capture(*QUICK, voltage=(1.4, 1.6), count=2, time=duration, progress=False)
