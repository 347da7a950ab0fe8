"""The paper's datasets through the FMU: small ones, each of a call of the public functions."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.paper.cases import CASES
from orchestrate.paper.curves import CONTACT, FLIGHT, SEQUENCE, Panel, trace
from orchestrate.paper.datasets import Datasets, most_even
from orchestrate.paper.resolution import QUICK

pytestmark = pytest.mark.usefixtures("exported")
RUNNING = {"jobs": 1, "progress": False}
DAMPED = CASES["damped"]


@pytest.fixture
def data(tmp_path):
    """Datasets of few periods, the damped case in place of all sweeps."""
    stages = {"stages": (0, 4500), "skip": 5, "keep": 2, "transient": 500, "samples": 39}
    return Datasets(tmp_path, replace(QUICK, **stages), RUNNING)


def swept(etas, structure=DAMPED, **more):
    """A short sweep upwards."""
    settings = {"transient": 60, "samples": 20, **RUNNING, **more}
    return orchestrate.sweep(structure, eta=etas, **settings)


def test_a_response_is_run_on_until_it_repeats(data):
    """At D = 0.05 T/1 is unstable at 1.116, which 500 periods from 1.115 do not see."""
    etas = np.round(np.arange(1.101, 1.1165, 0.0015), 4)
    data.sweep = lambda *_: swept(etas, transient=500, samples=40)
    found, before = data.settled("damped"), data.up("damped")
    assert before.multiplicity.values[-1] == 1
    assert found.eta.values.tolist() == [1.101, 1.1085, 1.116]
    assert found.multiplicity.values.tolist() == [1, 1, 2]
    assert found.impacts_per_period.values.tolist() == [1.0, 1.0, 1.5]
    assert found.periods.values.tolist()[::2] == [48, 4596]
    stored = {path.name for path in data.folder.glob("*.nc")}
    assert stored == {f"settled_e0.7_D0.05_up_{stage}.nc" for stage in (0, 1)}
    exponents = data.exponent("damped")
    assert (exponents.verdict < 0).all() and exponents.eta.equals(found.eta)


def test_what_does_not_repeat_is_run_on_and_irregular_in_the_end(data):
    data.sweep = lambda *_: swept(np.linspace(0.8, 1.3, 6), CASES["elastic"])
    found = data.settled("elastic")
    assert found.multiplicity.values[0] == 0 and found.multiplicity.values[1] > 0
    assert found.periods.values[0] == 4596 and np.isfinite(found.end_state).all()


@pytest.mark.slow
def test_exact_limits_of_a_branch_through_a_sweep(data):
    """The period doubling that ends T/2 at D = 0.05, eight digits as in the manual's table."""
    data.sweep = lambda *_: swept([1.05, 1.06])
    window = data.window("damped", "T/2", 1.06)
    assert window.high == pytest.approx(1.07716438, abs=1e-8)
    assert window.above == "period doubling"
    again = Datasets(data.folder, data.size, RUNNING)
    again.sweep = data.sweep
    assert again.window("damped", "T/2", 1.0) == window  # as stored


def test_a_curve_has_both_sides_of_each_impact():
    start = orchestrate.sweep(CASES["elastic"], eta=[0.4], transient=200, **RUNNING).end_state[0]
    found = trace(Panel(CASES["elastic"], 0.4, start.values, 1), 1, 500, RUNNING)
    tau, state, kind = found["tau"], found["state"], found["kind"]
    gap, rate = state[:, 1] - state[:, 0], state[:, 3] - state[:, 2]
    assert (np.diff(tau) >= 0.0).all() and tau[0] == 0.0 and (gap > -1e-12).all()
    assert set(kind.tolist()) == {FLIGHT, SEQUENCE, CONTACT}
    jumps = (np.diff(tau) == 0.0) & (np.diff(state[:, 2]) != 0.0)
    assert jumps.sum() == 30
    assert (np.abs(np.diff(state, axis=0)[jumps][:, :2]) < 1e-9).all(), "displacements jump"
    before, after = rate[:-1][jumps], rate[1:][jumps]
    assert (before < 0.0).all()
    assert after[after != 0.0] == pytest.approx(-0.7 * before[after != 0.0], rel=1e-6)
    assert np.abs(np.diff(state[:, 2] + state[:, 3])[jumps]).max() < 1e-12  # momentum


def test_curves_at_each_case_s_peak(data):
    data.sweep = lambda case, _: swept(np.arange(1.03, 1.1, 0.01).round(3), CASES[case])
    found = data.figure("12")
    assert found.eta.values.tolist() == [1.05, 1.06, 1.05]
    assert found.D.values.tolist() == [0.005, 0.05, 0.005]
    assert found.panel_of.values.tolist() == sorted(found.panel_of.values)
    state = found.state.values
    assert (state[:, 1] - state[:, 0] >= -1e-6).all()
    assert xr.load_dataset(data.folder / "figure12.nc").equals(found)


def test_chattering_shrinks_by_the_restitution_and_has_no_end(data, monkeypatch):
    """Each factor of gamma gives as many impacts more as its logarithm over that of e says."""
    monkeypatch.setattr("orchestrate.paper.datasets.RESTITUTIONS", (0.05, 0.8, 1.0))
    monkeypatch.setattr("orchestrate.paper.datasets.STICKING_GAMMAS", (1e-4, 1e-6))
    found = data.chattering()
    assert found.sticks.values.tolist() == [[1.0, 1.0], [1.0, 1.0], [0.0, 0.0]]
    assert found.ratio_error.sel(e=[0.05, 0.8], gamma=1e-6).max() < 1e-6
    for e in (0.05, 0.8):
        more = np.diff(found.impacts.sel(e=e).values)[0]
        assert more == pytest.approx(np.log(1e-2) / np.log(e), abs=1.0)


def test_masses_that_are_alike_do_not_knock(data):
    counts = [
        data.count_impacts(DAMPED.replace(mu=mu, kappa=k), 1.3) for mu, k in ((2, 2), (2, 2.2))
    ]
    assert [row[:2] for row in counts] == [[2.0, 2.0], [2.0, 2.2]]
    assert counts[0][2:] == [0, 0, 0, 0] and counts[1][2] > 1000


def test_the_limit_of_permanent_contact_does_not_depend_on_gamma(data, monkeypatch):
    monkeypatch.setattr("orchestrate.paper.datasets.CONTACT_RANGES", {"elastic": (0.415, 0.421)})
    monkeypatch.setattr("orchestrate.paper.datasets.GAMMAS", (1e-4, 1e-2))
    assert data.last_contact("elastic").tolist() == [0.417, 0.417]


def test_the_frequency_at_which_two_attractors_share_starts_most_evenly():
    share = [[0.9, 0.1, 0.0], [0.5, 0.5, 0.0], [0.6, 0.3, 0.1], [0.55, 0.45, 0.0]]
    n = [[1, 2, 0], [1, 0, 0], [1, 2, 2], [2, 2, 0]]
    impacts = [[1.0, 1.5, 0], [1.0, 1.5, 0], [1.0, 1.5, 1.2], [1.5, 1.6, 0]]
    names = {"share": share, "multiplicity": n, "impacts_per_period": impacts}
    found = xr.Dataset({name: (("eta", "attractor"), rows) for name, rows in names.items()})
    assert most_even(found) == 2  # not 1, one is irregular, and not 3, their impacts are alike
