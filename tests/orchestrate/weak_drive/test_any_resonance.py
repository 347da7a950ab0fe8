"""Verdicts where the box's own resonance is near the structure's, or this is far above omega."""

import numpy as np
import pytest

from orchestrate import Drive, Structure, capture
from orchestrate.weak_drive import averaged

from .coupled import System
from .test_couple import run


def system(mu, kappa, **drive):
    """A bonded structure on a drive that is given by its numbers."""
    structure = Structure.nondimensional(mu=mu, kappa=kappa, D=0.02, e=0.7, bonded=True)
    return System(structure, Drive.nondimensional(beta=0.1, **drive, structure=structure))


NEAR = system(1.0, 1.2, epsilon=1e-3, b=0.05, Omega_b=0.9, D_b=0.03)
HIGH = system(0.2, 9.0, epsilon=3e-4, b=0.05, Omega_b=0.1, D_b=0.02)
BRANCH = {  # folds of the branches that `drive_branch` follows, up and down
    "near": (1.38133, 1.35001),
    "high": (3.24400, 3.14545),
}


@pytest.mark.parametrize("one", [NEAR, HIGH])
def test_folds_are_the_extrema_of_the_voltage_above_the_calm_speed(one):
    Omega = np.linspace(0.3, 6.0, 400_001)
    eta0 = averaged.no_load_speed(*one, Omega)
    turns = Omega[1:-1][np.diff(np.sign(np.diff(eta0))) != 0.0]
    calm = averaged.calm_speed(*one)
    for speeds, folds in (
        (turns[turns > calm], averaged.folds(*one)),
        (turns[turns < calm], averaged.folds(*one, low=0.3, high=calm)),
    ):
        assert [fold.Omega for fold in folds] == pytest.approx(speeds, abs=3e-5)
    assert averaged.smallest_slope(*one) < 0.0


def test_the_least_torque_divides_both_resonances():
    low, high = sorted(set(np.abs(averaged.free_vibration_roots(*NEAR)).round(9)))
    speeds = np.linspace(low, high, 1001)
    torque = averaged.no_load_speed(*NEAR, speeds) - speeds
    assert averaged.calm_speed(*NEAR) == pytest.approx(speeds[torque.argmin()], abs=1e-3)
    folds = [*averaged.folds(*NEAR, low=0.0, high=1.0), *averaged.folds(*NEAR)]
    assert [low < fold.Omega < high for fold in folds] == [True, True, False, False]
    assert averaged.dividing_speed(*NEAR) == pytest.approx(0.5 * (1.25575 + 1.30321), abs=1e-4)


@pytest.mark.slow
def test_between_both_resonances_the_motor_is_captured():
    """It was said that it passes: the threshold lay between the resonances."""
    volts = NEAR.drive.volts(NEAR.structure)
    ends = 1.3 * volts, 1.45 * volts
    found = capture(*NEAR, voltage=ends, count=2, tolerance=volts, step=0.2, progress=False)
    assert found.passes.values.tolist() == [0, 1]
    assert float(found.fold) / volts == pytest.approx(BRANCH["near"][0], abs=1e-4)
    speed = run(NEAR, 1.3, duration=3000.0, speed_start=1.1).Omega.values[-50:].mean()
    assert found.speed.values[0] == pytest.approx(speed, abs=1e-3) and speed < 1.24
    assert found.decision.values.tolist() == ["converged"] * 2
