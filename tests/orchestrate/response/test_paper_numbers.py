"""The paper's numbers, found by sweeps through the exported FMU.

Peaks of max xi_Rel lie on a grid of 0.001 in eta; single responses are reached by a sweep from a
bit below.
"""

import numpy as np
import pytest

from orchestrate.model import Structure
from orchestrate.response.sweep import sweep

PEAKS = [(0.7, 0.005, 21.558, 1.047), (0.7, 0.05, 2.6347, 1.057), (0.3, 0.005, 16.410, 1.048)]


@pytest.fixture(scope="module")
def responses(exported):
    """Single responses, each approached in small steps; at high eta transients decay slowly."""
    paths = [[0.4], np.arange(140, 256, 5), np.arange(390, 401, 2), np.arange(612, 621, 2)]
    etas = np.concatenate([paths[0], *(path / 100 for path in paths[1:])])
    return sweep(Structure.nondimensional(), eta=etas, transient=1500, samples=300)


@pytest.mark.parametrize(("e", "D", "highest", "eta"), PEAKS)
def test_resonance_peak(exported, e, D, highest, eta):
    etas = np.arange(1030, 1066) / 1000
    structure = Structure.nondimensional(e=e, D=D)
    gaps = sweep(structure, eta=etas, transient=200, samples=40).xi_rel_max
    assert gaps.max() == pytest.approx(highest, rel=1e-3)
    assert gaps.idxmax() == pytest.approx(eta, abs=1e-9)


def test_eta_0_4_repeats_every_period_with_permanent_contact(responses):
    response = responses.sel(eta=0.4)
    assert (int(response.multiplicity), bool(response.permanent_contact)) == (1, True)
    assert np.ptp(response.xi_rel.values) <= 1e-2 * np.abs(response.xi_rel.values).max()


def test_eta_1_40_to_2_55_has_one_impact_per_period(responses):
    response = responses.sel(eta=slice(1.40, 2.55))
    assert response.sizes["eta"] == 24
    np.testing.assert_array_equal(response.multiplicity, 1)
    np.testing.assert_array_equal(response.impacts_per_period, 1.0)
    np.testing.assert_array_equal(response.permanent_contact, 0)


@pytest.mark.parametrize(("eta", "multiplicity"), [(4.0, 2), (6.2, 3)])
def test_subharmonic_response_has_one_impact_in_its_period(responses, eta, multiplicity):
    response = responses.sel(eta=eta)
    assert int(response.multiplicity) == multiplicity
    assert float(response.impacts_per_period) == pytest.approx(1.0 / multiplicity, abs=1e-12)
    assert not response.permanent_contact
