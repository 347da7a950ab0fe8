"""The averaged theory: known folds, zeros of the slope, growth by the motion's own equations."""

import numpy as np
import pytest

from orchestrate.model import Drive, Structure
from orchestrate.weak_drive import averaged

from ...sparing import ordinary
from .coupled import BEAM, QUICK


def test_known_numbers():
    up, down = averaged.folds(*QUICK)
    assert (up.eta0, down.eta0) == pytest.approx((1.58306, 1.43571), abs=6e-5)
    assert up.Omega == pytest.approx(1.3089, abs=1e-3)
    assert averaged.relative_amplitude(*QUICK, 1.3089) == pytest.approx(19.99, abs=0.05)
    assert averaged.folds(*BEAM)[0].eta0 == pytest.approx(1.5419, abs=2e-4)
    strong = QUICK.drive.replace(armature_resistance=1e-3 * QUICK.drive.armature_resistance)
    assert averaged.folds(QUICK.structure, strong) == []
    assert averaged.bonded_dividing_speed(*QUICK) == 0.5 * (up.Omega + down.Omega)
    assert averaged.bonded_dividing_speed(QUICK.structure, strong) == averaged.bonded_resonance(
        *QUICK
    )
    assert averaged.stability_limits(*QUICK.as_bonded()) == (up, down)
    limits = averaged.stability_limits(*BEAM.as_bonded())  # its upper branch: not by its fold
    assert [place.kind for place in limits] == ["fold", "Neimark-Sacker"]
    assert limits[1].eta0 == pytest.approx(1.3731, abs=1e-4)


@pytest.mark.parametrize("changes", [{"D1": 0.01, "D2": 0.03}, {"mu": 2.0, "kappa": 2.4}])
def test_folds_are_extrema_of_the_voltage(changes):
    system = QUICK.with_structure(**changes)
    found, Omega = averaged.folds(*system), np.linspace(0.5, 3.0, 200_001)
    eta0 = averaged.stationary_voltage(*system, Omega)
    turns = np.flatnonzero(np.diff(np.sign(np.diff(eta0))))
    assert [fold.Omega for fold in found] == pytest.approx(Omega[turns + 1], abs=2e-5)
    assert [fold.eta0 for fold in found] == pytest.approx(eta0[turns + 1], abs=1e-8)
    width = averaged.bonded_resonance_half_width(*system)
    peak = Omega[np.argmax(averaged.relative_amplitude(*system, Omega))]
    sizes = averaged.relative_amplitude(*system, np.array([peak - width, peak, peak + width]))
    assert sizes[[0, 2]].mean() == pytest.approx(sizes[1] / np.sqrt(2.0), rel=0.02)


@pytest.mark.parametrize("name", ordinary(["beam", "rig", "quick"]))
def test_stability_is_that_of_slow_disturbances(name):
    """Between the points it does not change; at a fold and at a Neimark-Sacker point it does."""
    system = Structure.from_file(name), Drive.from_file(name)
    points, stable = averaged.bifurcations_and_stable_parts(*system)
    assert stable[0] and stable[-1] and not all(stable)
    speeds = [point.Omega for point in points]
    assert speeds == sorted(speeds) and {"fold"} <= {point.kind for point in points}
    curve = averaged.stationary_curve(*system)
    for Omega in np.linspace(0.9 * speeds[0], 1.1 * speeds[-1], 25):
        grows = averaged.growth_rates(*system, float(Omega))[0].real > 0.0
        assert stable[int(np.searchsorted(speeds, Omega))] != grows
        near = curve.sel(speed=Omega * system[0].omega, method="nearest")
        assert bool(near.stable) != grows or min(abs(np.array(speeds) - Omega)) < 2e-4
        volts = averaged.stationary_voltage(*system, Omega) * system[1].volts(system[0])
        assert float(near.voltage) == pytest.approx(float(volts), rel=1e-3)
