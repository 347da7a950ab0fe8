"""Figure 3 through the coupled system: at the resonance, its lines, and no folding back."""

from contextlib import closing

import numpy as np
import pytest

from orchestrate.response.spectra import amplitude_spectrum
from orchestrate.weak_drive import averaged
from orchestrate.weak_drive.couple import make_couple_job
from orchestrate.weak_drive.drive_spectra import drive_spectra, voltage_between_jumps
from orchestrate.weak_drive.master import Scheme
from orchestrate.weak_drive.run import MotorRun
from orchestrate.weak_drive.schedule import Ramp

from .coupled import QUICK, instances, state_of
from .monolithic import Monolith

RATE, HOLD = 4e-4, 400.0


def whole_lines(speed):
    """The monolithic solution from the end of the same approach, sampled eight times as densely."""
    voltage, revolutions, points = voltage_between_jumps(*QUICK), 8, 2048
    ramp = Ramp(0.85 * voltage, voltage, RATE, settle=300.0, back=False)
    job = make_couple_job(*QUICK, ramp, Scheme(0.1))
    with instances() as fmus, closing(MotorRun(job, *fmus)) as run:
        run.run_steps_by_revolution(range(round((ramp.duration + HOLD) / 0.1)))
        state = state_of(run.master)
    interval = 2.0 * np.pi / speed / points
    times = interval * np.arange(revolutions * points)
    states, impacts = Monolith(*QUICK, voltage).solve(state, times)
    frequency, amplitude = amplitude_spectrum(states[:, 0] + states[:, 4], interval)
    assert impacts == 12  # three in two revolutions
    return lambda order: (frequency**2 * amplitude)[round(order * revolutions)]


def test_lines_of_both_structures():
    """One line where the masses are glued, by the averaged theory; all harmonics and halves of
    them where they knock, as of the whole system; next to nothing between lines.
    """
    short = {"jobs": 1, "rate": RATE, "hold": HOLD, "revolutions": 32, "progress": False}
    quick = drive_spectra(*QUICK, points=256, **short)
    parts = [quick.sel(kind=kind) for kind in ("bonded", "delaminated")]
    bonded, parted = (one.acceleration.sel(mass=1) for one in parts)
    glued, opened = (float(one.speed) for one in parts)
    up, _ = averaged.folds(*QUICK)
    for speed in (glued, opened):  # the default voltage is at the resonance
        half = 0.5 * averaged.relative_amplitude(*QUICK, up.Omega)
        assert speed < up.Omega and averaged.relative_amplitude(*QUICK, speed) > half
    H, ratio = averaged.transfer_functions(*QUICK, glued)
    expected = abs(H * (1.0 + ratio)) * glued**4 * QUICK.drive.length
    main = float(bonded.sel(order=1.0))
    assert main == pytest.approx(expected, rel=0.01)
    assert bonded.sel(order=[0.5, 2.0, 3.0]).max() < 1e-3 * main
    assert parted.sel(order=np.arange(0.5, 12.5, 0.5)).min() > 0.01 * main
    for lines, floor in ((parted, 1e-5), (bonded, 1e-7)):
        between = lines.sel(order=slice(1.1, 11.9))
        assert between.where(between.order % 0.5 != 0).median() < floor * main
    truth = whole_lines(opened)
    for order in (0.5, 1.0, 1.5, 2.0, 4.5, 8.0, 12.0):
        assert float(parted.sel(order=order)) == pytest.approx(truth(order), rel=0.01), order
