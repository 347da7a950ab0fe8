"""The paper's numbers, found by sweeps through the exported FMU and read from the result files.

Peaks of max xi_Rel lie on a grid of 0.001 in eta; single responses are reached by a sweep from a bit below.
"""

import numpy as np
import pytest
import xarray

from .command import Sweeps

PEAKS = [("e0.7_D0.005", 21.558, 1.047), ("e0.7_D0.05", 2.6347, 1.057), ("e0.3_D0.005", 16.410, 1.048)]


@pytest.fixture(scope="module")
def sweeps(tmp_path_factory, fmu):
    """Sweeps of this module."""
    commands = Sweeps(tmp_path_factory.mktemp("paper"), fmu)
    yield commands
    commands.clean_up()


@pytest.fixture(scope="module")
def resonance(sweeps):
    """Sweep the neighbourhood of the resonance peak for three parameter sets, side by side."""
    cases = [option for label, _, _ in PEAKS for option in ("--case", label.replace("e", "e=").replace("_D", ",D="))]
    sweeps.run(*cases, "--eta", "1.030:1.065:0.001", "--transient", "200", "--samples", "40").success()
    return {label: xarray.load_dataset(sweeps.result(f"orbit_{label}_up")) for label, _, _ in PEAKS}


@pytest.fixture(scope="module")
def responses(sweeps):
    """Single responses, each approached from below in small steps; long transients, because at high eta they decay slowly."""
    paths = [[0.4], np.arange(140, 256, 5) / 100, np.arange(390, 401, 2) / 100, np.arange(612, 621, 2) / 100]
    etas = ",".join(f"{eta:g}" for eta in np.concatenate(paths))
    sweeps.run("--eta", etas, "--transient", "1500", "--samples", "300").success()
    return xarray.load_dataset(sweeps.result("orbit_e0.7_D0.005_list"))


@pytest.mark.parametrize(("label", "highest", "eta"), PEAKS)
def test_resonance_peak(resonance, label, highest, eta):
    gaps = resonance[label].xi_rel_max
    assert gaps.max() == pytest.approx(highest, rel=1e-3)
    assert gaps.idxmax() == pytest.approx(eta, abs=1e-9)
    assert 1.030 < gaps.idxmax() < 1.065


def test_eta_0_4_repeats_every_period_with_permanent_contact(responses):
    response = responses.sel(eta=0.4)
    assert (int(response.multiplicity), bool(response.permanent_contact)) == (1, True)
    assert np.ptp(response.xi_rel.values) <= 1e-2 * np.abs(response.xi_rel.values).max()


def test_eta_1_40_to_2_55_has_one_impact_per_period(responses):
    response = responses.sel(eta=slice(None))
    response = response.where((response.eta >= 1.40) & (response.eta <= 2.55), drop=True)
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
