"""The Sommerfeld effect: jumps, capture, the energy balance of a whole run; what is refused."""

import numpy as np
import pytest

from orchestrate import InputError, couple
from orchestrate.access import OSCILLATOR, SHAKER, find
from orchestrate.weak_drive.couple import couple_job
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.schedule import Ramp

from .coupled import BEAM, QUICK

RATES = (1e-4, 3e-5)


def run(system, voltage, rate=None, **more):
    """A run by non-dimensional numbers: voltages over K omega, times in 1/omega."""
    structure, drive = system
    omega, volts = structure.omega, drive.volts(structure)
    times = {
        name: more.pop(name) / omega for name in ("duration", "settle", "spin_up") if name in more
    }
    speed = {"speed_start": more.pop("speed_start") * omega} if "speed_start" in more else {}
    ramp = {} if rate is None else {"rate": rate * volts * omega}
    step = more.pop("step", 0.2)
    ends = np.multiply(voltage, volts).tolist()
    return couple(
        *system,
        voltage=ends,
        step=step and step / omega,
        progress=False,
        **ramp,
        **times,
        **speed,
        **more,
    )


def ramp(system, ends, rate, speed):
    """A ramp one way, without held voltages."""
    return run(system, ends, rate, back=False, speed_start=speed, hold=0.0)


def extrapolated(system, first, last, speed, rates=RATES):
    """The jump at rate 0, and those found: it comes late by about rate^(2/3)."""
    place, volts = int(first > last), system.drive.volts(system.structure)
    found = [
        float(ramp(system, (first, last), rate, speed).ramp_voltage[place]) / volts
        for rate in rates
    ]
    lags = np.array([[1.0, rate ** (2 / 3)] for rate in rates])
    return np.linalg.lstsq(lags, np.array(found), rcond=None)[0][0], found


def test_jump_up_bonded():
    value, found = extrapolated(QUICK.as_bonded(), 1.535, 1.62, 0.0)
    assert found == pytest.approx([1.606, 1.593], abs=5e-4)
    assert value == pytest.approx(1.5831, abs=2e-3)


def test_jump_down_bonded():
    value, _ = extrapolated(QUICK.as_bonded(), 1.46, 1.39, 1.44)
    assert value == pytest.approx(1.4357, abs=2e-3)


def test_jump_up_delaminated():
    """Lower than bonded: from the branch that comes from below."""
    assert extrapolated(QUICK, 1.45, 1.61, 0.0)[0] == pytest.approx(1.5697, abs=3e-3)


@pytest.mark.slow
def test_jumps_of_the_beam():
    rates = (4e-5, 2e-5, 1e-5)
    bonded = extrapolated(BEAM.as_bonded(), 1.33, 1.57, 1.25, rates)[0]
    delaminated = extrapolated(BEAM, 1.33, 1.57, 1.25, rates)[0]
    assert (bonded, delaminated) == pytest.approx((1.5419, 1.510), abs=1e-3)


@pytest.mark.parametrize(("eta0", "caught"), [(1.540, True), (1.547, False)])
def test_capture(eta0, caught):
    """From rest at constant voltage the motor hangs at the resonance below a critical voltage."""
    found = run(QUICK.as_bonded(), eta0, duration=700.0, speed_start=0.0)
    assert (found.Omega[-1] < 1.32) == caught


@pytest.mark.parametrize("bonded", [True, False])
def test_energy_balance_of_a_whole_run(bonded):
    """Up and down through both jumps: nothing is missing, and nothing is counted twice."""
    system = QUICK.as_bonded() if bonded else QUICK
    more = {"settle": 200.0, "speed_start": 1.26, "step": 0.1, "hold": 0.0}
    found = run(system, (1.34, 1.68), 2e-4, **more)
    up, down = found.ramp_voltage.values
    assert 1.58 < up < 1.65
    assert 1.36 < down < 1.43
    end = found.isel(revolution=-1)
    assert abs(end.missing) < 1e-6 * end.motor
    assert end.defect_sizes < 1e-6 * end.motor
    assert min(end.dampers, end.box_damper) > 0.0
    assert (end.impact_loss == 0.0) == bonded
    if bonded:
        assert found.averaged_jumps.values == pytest.approx([1.58306, 1.43568], abs=1e-5)


def test_units_follow_the_system():
    """The same numbers for a structure ten times as fast and twice as heavy."""
    structure, drive = QUICK
    other = structure.replace(m1=2 * structure.m1, m2=2 * structure.m2, d1=20 * structure.d1)
    other = other.replace(d2=20 * structure.d2, k1=200 * structure.k1, k2=200 * structure.k2)
    numbers = {name: getattr(drive, name)(structure) for name in ("beta", "b", "Omega_b", "D_b")}
    numbers["epsilon"] = drive.epsilon
    faster = type(drive).nondimensional(**numbers, structure=other, length=1e-3, motor_constant=0.5)
    expected = run(QUICK, 1.5, duration=100.0)
    found = couple(other, faster, voltage=1.5 * 5.0, duration=10.0, step=0.02, progress=False)
    energy = faster.energy(other)
    assert found.sizes == expected.sizes
    for name, unit in {"speed": 10.0, "time": 0.1, "amplitude": 1e-3, "motor": energy}.items():
        assert found[name].values / unit == pytest.approx(expected[name].values, rel=1e-6), name
    assert found.box_acceleration.values / 0.1 == pytest.approx(expected.box_acceleration.values)
    assert found.eta0.values == pytest.approx(expected.eta0.values)
    assert found.Omega.values == pytest.approx(expected.Omega.values)


def test_a_motor_that_turns_backward():
    """With the voltage reversed the revolutions count, and are the mirror image."""
    forward = run(QUICK.as_bonded(), 1.3, duration=100.0)
    backward = run(QUICK.as_bonded(), -1.3, duration=100.0)
    assert backward.sizes["revolution"] == forward.sizes["revolution"] > 15
    assert backward.speed.values[5:] == pytest.approx(-forward.speed.values[5:], rel=0.02)
    assert backward.amplitude[-1] == pytest.approx(float(forward.amplitude[-1]), rel=0.02)
    assert backward.motor[-1] > 0.0


def test_it_goes_on_with_the_same_bits():
    """A run in one go, and one handed over from chunk to chunk with the states of both FMUs."""
    job = couple_job(*QUICK, Ramp(1.4, 1.41, 2e-4, 50.0), Scheme(0.4, tolerance=1e-8), 1.25)
    fmus = {model: find(model).path for model in (OSCILLATOR, SHAKER)}
    steps = job.items({})
    expected, parts, carry = job.work(fmus, steps, None), [], None
    for first in (0, 1, 70, 71, len(steps)):
        begin = sum(len(part) for _, part in parts)
        part = steps[begin:first]
        if not part:
            continue
        carry = job.work(fmus, part, carry)
        parts.append((carry, part))
    for name, values in expected.items():
        if values.shape[0] != 1:
            assert np.array_equal(np.concatenate([table[name] for table, _ in parts]), values), name
    assert carry["master_memory"].tobytes() == expected["master_memory"].tobytes()


def test_a_finished_result_is_read(tmp_path):
    """With a store the same call reads the file."""
    question = {"voltage": 1.4, "duration": 60.0, "store": tmp_path / "run.nc", "progress": False}
    first = couple(*QUICK, **question)
    stamp = (tmp_path / "run.nc").stat().st_mtime_ns
    assert couple(*QUICK, **question).identical(first)
    assert (tmp_path / "run.nc").stat().st_mtime_ns == stamp


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ({"voltage": (1.2, 1.2)}, ["voltage = (1.2, 1.2)", "different"]),
        ({"voltage": 1.2}, ["voltage = 1.2", "duration"]),
        ({"voltage": (1.2, 1.6), "duration": 3.0}, ["duration = 3.0", "rate"]),
        ({"voltage": (1.0, 1.2, 1.4)}, ["voltage = (1.0, 1.2, 1.4)", "(first, last)"]),
        ({"voltage": "high", "duration": 1.0}, ["voltage = 'high'", "a number"]),
        ({"voltage": (1.2, float("nan"))}, ["voltage = nan", "finite"]),
        ({"rate": 0.0}, ["rate = 0.0", "> 0"]),
        ({"rate": float("nan")}, ["rate = nan", "> 0"]),
        ({"rate": 1e-12}, ["steps", "at most 1e+09"]),
        ({"step": -0.1}, ["step = -0.1", "0.0001 <= step <= 1"]),
        ({"increment": 2.0}, ["increment = 2.0", "0 <= increment <= 0.4"]),
        ({"settle": -1.0}, ["settle = -1.0", "0 <= settle"]),
        ({"hold": -1.0}, ["hold = -1.0 s", "0 <= hold"]),
        ({"speed_start": float("inf")}, ["speed_start = inf", "finite"]),
        ({"tolerance": -1.0}, ["tolerance", ">= 0"]),
        ({"voltage": 1.5, "duration": 1e-10}, ["duration = 1e-10 s", "one communication step"]),
        ({"voltage": 1.5, "duration": 0.0}, ["duration = 0 s", "duration >= "]),
        (
            {"voltage": 0.001, "duration": 10.0},
            ["completed no revolution in 10 s", "raise the voltage"],
        ),
        ({"fmu": {SHAKER: "nowhere.fmu"}}, ["nowhere.fmu: no such file"]),
    ],
)
def test_mistakes(arguments, parts):
    with pytest.raises(InputError) as caught:
        couple(*QUICK, progress=False, **{"voltage": (1.2, 1.6), **arguments})
    assert all(part in str(caught.value) for part in parts), str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_motor_without_a_constant():
    with pytest.raises(InputError, match="motor_constant = 0.0 N.m/A: expected a number > 0"):
        couple(QUICK.structure, QUICK.drive.replace(motor_constant=0.0), voltage=(1.0, 2.0))
