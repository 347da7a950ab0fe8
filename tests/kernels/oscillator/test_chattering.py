"""Chattering ends where it should, also where its last flights are lower than the rounding of the
displacements; stops on the way do no harm.
"""

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
    while 2 * parting(closing) >= gamma * (1 - e) / 1.2**0.5 * 0.2:
        flown += 2 * parting(closing) / 0.2
        impacts, closing = impacts + 1, parting(closing)
    assert m[at.IN_CONTACT] == 1.0
    # f varies by some per cent meanwhile
    assert m[at.IMPACT_COUNT] == pytest.approx(impacts, abs=1 + 0.02 * impacts)
    assert m[at.IMPACT_TIME] == pytest.approx(flown, rel=0.1, abs=1e-12)
    # almost all of the closing energy
    assert m[at.IMPACT_ENERGY] == pytest.approx(0.25e-6, rel=0.01)
