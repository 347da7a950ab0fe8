"""Chattering ends where it should, also where its last flights are lower than the rounding of the
displacements; stops on the way do no harm.
"""

import math

import pytest

from fmu_src.kernels.oscillator import memory as at

from .kernel import advanced, least_work, started

# f = -0.2, closing with 1 mm/s
PRESSED = {
    "x1_start": 1.0,
    "x2_start": 1.0,
    "v1_start": 5e-4,
    "v2_start": -5e-4,
    "box_amplitude": 0.0,
}


@pytest.mark.parametrize(
    ("e", "e_slope"), [(0.0, 0.0), (0.3, 0.0), (0.7, 0.0), (0.95, 0.0), (0.7, 500.0), (0.95, 2e3)]
)
@pytest.mark.parametrize("gamma", [1e-9, 1e-8, 1e-7, 1e-6, 1e-4])
@least_work
def test_a_bouncing_mass_comes_to_rest_after_as_many_impacts_as_a_ball(gamma, e, e_slope):
    m = advanced(started(**PRESSED, gamma=gamma, e=e, e_slope=e_slope), 0.3)

    def parting(closing):
        return e * closing / (1 + e_slope * closing)

    impacts, closing, flown = 1, 1e-3, 0.0
    while 2 * parting(closing) >= gamma * 0.2:
        flown += 2 * parting(closing) / 0.2
        impacts, closing = impacts + 1, parting(closing)
    assert m[at.IN_CONTACT] == 1.0
    # f varies by some per cent meanwhile
    assert m[at.IMPACT_COUNT] == pytest.approx(impacts, abs=1 + 0.02 * impacts)
    assert m[at.IMPACT_TIME] == pytest.approx(flown, rel=0.1, abs=1e-12)
    # almost all of the closing energy
    assert m[at.IMPACT_ENERGY] == pytest.approx(0.25e-6, rel=0.01)


@pytest.mark.parametrize(
    "values",
    [
        {"m2": 0.644, "k2": 0.16, "d1": 0.0, "d2": 4e-4, "gamma": 1.5e-6, "phase_start": math.pi},
        {
            "m2": 1.69,
            "k2": 2.32,
            "d1": 1e-3,
            "d2": 0.0,
            "e": 0.9,
            "gamma": 1.7e-6,
            "phase_start": -4.92,
        },
        {"m2": 0.144, "k2": 3.23, "d1": 2.6e-4, "d2": 0.0, "e": 0.3, "gamma": 1.7e-5},
    ],
)
@least_work
def test_parted_by_damping_and_pressed_by_stiffness_from_rest(values):
    m = advanced(started(box_frequency=0.8, **values), 0.5)
    assert m[at.IMPACT_COUNT] < 150.0
    assert m[at.IN_CONTACT] == 1.0
