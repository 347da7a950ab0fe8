"""The Sommerfeld effect: jumps, capture, the energy balance of a whole run; what is refused."""

import numpy as np
import pytest

from orchestrate import InputError, SpeedControl, couple
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, find
from orchestrate.weak_drive.couple import couple_job
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.schedule import Ramp

from .coupled import QUICK


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


def test_a_jump_on_a_ramp_is_late_by_the_rate_to_two_thirds():
    """At rate 0 it is at the fold of the averaged theory."""
    quick, rates, asked = QUICK.as_bonded(), (1e-4, 3e-5), {"back": False, "hold": 0.0}
    ramps = [run(quick, (1.535, 1.62), rate, speed_start=0.0, **asked) for rate in rates]
    found = [float(each.eta0[np.argmax(each.Omega.values > 1.45)]) for each in ramps]
    assert found == pytest.approx([1.606, 1.593], abs=5e-4)
    lags = np.array([[1.0, rate ** (2 / 3)] for rate in rates])
    assert np.linalg.solve(lags, found)[0] == pytest.approx(1.5831, abs=2e-3)


def test_energy_balance_of_a_whole_run():
    """Up and down through both jumps: nothing is missing, and nothing is counted twice."""
    more = {"settle": 200.0, "speed_start": 1.26, "step": 0.1, "hold": 0.0}
    found = run(QUICK, (1.34, 1.68), 2e-4, **more)
    beyond = np.flatnonzero(np.diff(found.Omega.values > 1.36))
    up, down = found.eta0.values[beyond[[0, -1]]]
    assert 1.58 < up < 1.65
    assert 1.36 < down < 1.43
    assert found.decided.values.tolist() == ["undecided"] * 2  # no voltage is held
    end = found.isel(revolution=-1)
    assert abs(end.missing) < 1e-6 * end.motor
    assert end.defect_sizes < 1e-6 * end.motor
    assert min(end.dampers, end.box_damper) > 0.0
    assert end.impact_loss > 0.0


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


def test_it_goes_on_with_the_same_bits():
    """In one go, and from chunk to chunk with the states of both FMUs and of the controller."""
    control = SpeedControl(speed=1.4, gain=3.0, reset_time=20.0)
    ramp, scheme = Ramp(1.4, 1.41, 2e-4, 50.0), Scheme(0.4, tolerance=1e-8)
    job = couple_job(*QUICK, ramp, scheme, 1.25, control)
    fmus = {model: find(model).path for model in (OSCILLATOR, MOTOR_SHAKER)}
    steps = job.items()
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
    for name in ("master_memory", "control_memory", "oscillator_state"):
        assert carry[name].tobytes() == expected[name].tobytes(), name


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
        ({"fmu": {MOTOR_SHAKER: "nowhere.fmu"}}, ["nowhere.fmu: no such file"]),
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
