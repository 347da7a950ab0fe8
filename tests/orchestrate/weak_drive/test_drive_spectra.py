"""Figure 3 through the coupled system: at the resonance, its lines, and no folding back."""

import numpy as np
import pytest

from orchestrate.errors import InputError
from orchestrate.fmu import MOTOR_SHAKER, OSCILLATOR, Instance, find
from orchestrate.response.spectra import amplitude_spectrum
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple import couple_job
from orchestrate.weak_drive.drive_spectra import drive_spectra, voltage_at_resonance
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.run import MotorRun
from orchestrate.weak_drive.schedule import Ramp

from .coupled import BEAM, QUICK, state_of
from .monolithic import Monolith

SHORT = {"jobs": 1, "rate": 4e-4, "hold": 400.0, "revolutions": 32, "progress": False}


@pytest.fixture(scope="module")
def quick():
    return drive_spectra(*QUICK, points=256, **SHORT)


def line(found, kind, order):
    return float(found.acceleration.sel(kind=kind, mass=1, order=order))


def floor(found, kind):
    """What is between lines: a record of 1.003 times as many revolutions has a hundred times it."""
    between = found.acceleration.sel(kind=kind, mass=1, order=slice(1.1, 11.9))
    return float(between.where(between.order % 0.5 != 0).median())


def test_lines(quick):
    """One line where the masses are glued; all harmonics and halves of them where they knock."""
    bonded = [line(quick, "bonded", order) for order in (1.0, 2.0, 3.0, 0.5)]
    assert max(bonded[1:]) < 1e-3 * bonded[0]
    delaminated = [line(quick, "delaminated", order) for order in np.arange(0.5, 12.5, 0.5)]
    assert min(delaminated) > 0.01 * bonded[0]
    assert floor(quick, "delaminated") < 1e-5 * bonded[0]
    assert floor(quick, "bonded") < 1e-7 * bonded[0]


def test_the_line_is_that_of_the_averaged_theory(quick):
    speed = float(quick.speed.sel(kind="bonded"))
    H, ratio = averaged.transfer_functions(*QUICK, speed)
    expected = abs(H * (1.0 + ratio)) * speed**4 * QUICK.drive.length
    assert line(quick, "bonded", 1.0) == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
def test_lines_are_those_of_the_whole_system(quick):
    """The monolithic solution from the end of the same approach, sampled eight times as densely."""
    voltage, revolutions, points = voltage_at_resonance(*QUICK), 8, 2048
    ramp = Ramp(0.85 * voltage, voltage, SHORT["rate"], settle=300.0, back=False)
    job = couple_job(*QUICK, ramp, Scheme(0.1))
    with Instance(find(OSCILLATOR).path) as oscillator, Instance(find(MOTOR_SHAKER).path) as shaker:
        run = MotorRun(job, oscillator, shaker)
        run.revolve(range(round((ramp.duration + SHORT["hold"]) / 0.1)))
        state = state_of(run.master)
        run.close()
    interval = 2.0 * np.pi / float(quick.speed.sel(kind="delaminated")) / points
    times = interval * np.arange(revolutions * points)
    states, impacts = Monolith(*QUICK, voltage).solve(state, times)
    frequency, amplitude = amplitude_spectrum(states[:, 0] + states[:, 4], interval)
    assert impacts == 12  # three in two revolutions
    for order in (0.5, 1.0, 1.5, 2.0, 4.5, 8.0, 12.0):
        at = round(order * revolutions)
        expected = frequency[at] ** 2 * amplitude[at]
        assert line(quick, "delaminated", order) == pytest.approx(expected, rel=0.01), order


@pytest.mark.parametrize("system", [QUICK, BEAM], ids=["quick", "beam"])
def test_the_default_voltage_is_at_the_resonance(system):
    """The speed hangs between that of the fold and the amplitude's half, bonded and delaminated."""
    omega, volts = system.structure.omega, system.drive.volts(system.structure)
    quickly = {"rate": 4e-4 * volts * omega, "hold": 100.0 / omega}
    found = drive_spectra(*system, points=64, **{**SHORT, **quickly})
    up, _ = averaged.folds(*system)
    Omega = found.speed.values / omega
    assert np.all(averaged.amplitude(*system, Omega) > 0.5 * averaged.amplitude(*system, up.Omega))
    assert np.all(Omega < up.Omega)


def test_mistakes():
    strong = QUICK.drive.replace(armature_resistance=1e-3 * QUICK.drive.armature_resistance)
    with pytest.raises(InputError, match="voltage: expected one"):
        voltage_at_resonance(QUICK.structure, strong)
    with pytest.raises(InputError, match="points = 3: expected a whole number from 4"):
        drive_spectra(*QUICK, points=3)
    with pytest.raises(InputError, match="revolutions = True: expected a whole number from 1"):
        drive_spectra(*QUICK, revolutions=True)
    with pytest.raises(InputError, match="highest = 99: expected 0 < highest <= points/2 = 32"):
        drive_spectra(*QUICK, points=64, highest=99)
    with pytest.raises(InputError, match="completed no two revolutions"):
        drive_spectra(*QUICK, voltage=0.001, begin=0.0009, hold=1.0, progress=False)
