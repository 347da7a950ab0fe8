"""The paper's own jobs: curves, limits over gamma, and what is derived from other results."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from orchestrate.access import OSCILLATOR, find, finder
from orchestrate.dynamics.attractors import AttractorsJob
from orchestrate.dynamics.basins import PlaneAxis
from orchestrate.dynamics.clusters import AttractorSettings
from orchestrate.dynamics.lyapunov import LyapunovJob
from orchestrate.paper.cases import CASES
from orchestrate.paper.claims.results import impacts_in_response, is_orbit
from orchestrate.paper.contact_limits import ContactLimitJob
from orchestrate.paper.curves import CurvesAtFrequencies, CurvesAtPeaks, CurvesInWindows
from orchestrate.paper.low_speed import LowSpeedJob
from orchestrate.paper.settled_responses import SettledJob
from orchestrate.paper.spectra import PeakSpectraJob
from orchestrate.paper.stability_limits import BranchSpec, LimitsJob, stable_windows_of
from orchestrate.paper.two_attractor_basin import TwoAttractorBasinJob
from orchestrate.response.simulate import simulate
from orchestrate.response.sweep import SweepJob
from orchestrate.running.runner import gather
from orchestrate.structures import Excitation, Structure

PAPER = CASES["elastic"]
DAMPED = CASES["damped"]


@pytest.fixture(scope="module")
def swept(exported):
    """Sweeps of the damped structure: past its main peak, and towards a peak not reached."""
    short = {"structure": DAMPED, "transient": 60, "samples": 20}
    peak = SweepJob(name="peak", eta=tuple(np.arange(1.03, 1.1, 0.01).round(3)), **short)
    rising = SweepJob(name="rising", eta=(1.85, 1.9), **short)
    return peak, rising


def ask(*jobs):
    """The last job's result."""
    return gather(jobs, {"progress": False, "jobs": 1}, finder({}))[-1]


def curves(kind, sweep, **more):
    return kind(
        name="curves",
        sweeps=(sweep.name,),
        structures=(sweep.structure,),
        **{"skip": 5, "keep": 2, "points": 50, **more},
    )


def test_curves_at_frequencies_and_peaks(swept):
    sweep = swept[0]
    found = ask(sweep, curves(CurvesAtFrequencies, sweep, etas=(1.05, 1.09)))
    assert found.eta.values.tolist() == [1.05, 1.09]
    assert found.panel_of.values.tolist() == sorted(found.panel_of.values)
    at_peak = ask(sweep, curves(CurvesAtPeaks, sweep))
    assert at_peak.eta.values.tolist() == [1.06]
    state = at_peak.state.values
    assert (state[:, 1] - state[:, 0] >= -1e-6).all()
    assert (at_peak.kind.values == 0).any()
    assert at_peak.D.values.tolist() == [0.05]


def test_a_window_without_a_peak_is_followed_beyond_the_sweep(swept):
    sweep = swept[1]
    job = curves(CurvesInWindows, sweep, windows=1)
    panel = job.panels([ask(sweep)])[0]
    assert panel.multiplicity == -1 and panel.eta == 1.9
    settled = job.settle_panel(find(OSCILLATOR).path, panel)
    assert (settled.multiplicity, settled.eta) == (1, pytest.approx(2.054, abs=0.0015))


def test_the_limit_of_permanent_contact_does_not_depend_on_gamma(exported):
    job = ContactLimitJob(
        name="gamma",
        structures=(PAPER,),
        ranges=((0.415, 0.421),),
        gammas=(1e-4, 1e-2),
        transient=100,
        samples=10,
    )
    table = job.work({OSCILLATOR: find(OSCILLATOR).path}, job.items({})[:1], None)
    other = job.work({OSCILLATOR: find(OSCILLATOR).path}, job.items({})[1:], None)
    assert table["last"].tolist() == other["last"].tolist() == [0.417]


def test_impacts_of_a_settled_response_are_those_of_its_own_period(exported):
    """The mean over 48 periods of this 11T with 32 impacts is that of 33 or 34."""
    structure, eta = Structure.nondimensional(mu=2.1943, kappa=0.4061, D=0.0116, e=0.4291), 3.0952
    found = ask(SettledJob(name="settled", structure=structure, eta=(eta,)))
    n = int(found.multiplicity[0])
    state = found.end_state.values[0]
    motion = simulate(structure, eta=eta, start=state, periods=n, points=1)
    assert (n, motion.sizes["impact"]) == (11, 32)
    assert float(found.impacts_per_period[0]) == 32.0 / 11.0


def test_impacts_in_a_response_of_a_sweep_are_counted_exactly(exported):
    """Of 200 periods of this 3T, a mean of 3.305 impacts a period was no whole number of them."""
    structure = Structure.nondimensional(mu=0.879, kappa=1.838, D=0.0194, e=0.372)
    found = ask(SweepJob(name="sweep", structure=structure, eta=(3.26,)))
    assert is_orbit(found, 3, 10).all()
    assert impacts_in_response(found).tolist() == [10]


def test_exact_limits_of_a_branch_through_a_sweep(swept):
    """The period doubling that ends T/2 at D = 0.05, eight digits as in the manual's table."""
    sweep, branches = swept[0], (BranchSpec("damped", "T/2", 1.05, 1, (1.0, 1.1)),)
    names = (sweep.name,) * len(CASES)
    found = ask(sweep, LimitsJob(name="limits", sweeps=names, branches=branches))
    (window,) = stable_windows_of(found, "damped", "T/2")
    assert window.high == pytest.approx(1.07716438, abs=1e-8)
    assert (window.below, window.above) == ("limit", "period doubling")


def test_a_response_is_followed_on_from_what_it_settles_to(exported):
    """At D = 0.05 T/1 is unstable at 1.116, which 500 periods from 1.115 do not see."""
    sweep = SweepJob(
        name="sweep", structure=DAMPED, eta=(1.09, 1.115, 1.116), transient=500, samples=40
    )
    settled = SettledJob(name="settled", structure=DAMPED, eta=sweep.eta, follows="sweep")
    found = ask(sweep, settled)
    assert ask(sweep).multiplicity.values.tolist() == [1, 1, 1]
    assert found.multiplicity.values.tolist() == [1.0, 1.0, 2.0]
    assert found.impacts_per_period.values.tolist() == [1.0, 1.0, 1.5]
    on = LyapunovJob(
        name="exponent",
        structure=DAMPED,
        eta=sweep.eta,
        transient=0,
        periods=100,
        follows="settled",
    )
    assert (ask(sweep, settled, on).verdict < 1).all()


def test_masses_that_are_alike_do_not_knock(exported):
    points = LowSpeedJob(name="low_speed").points[-3:]
    found = ask(LowSpeedJob(name="low_speed", points=points, periods=50))
    assert (found.impacts.values == 0).tolist() == [True, True, False]
    assert found.mu.values.tolist() == [1.0, 2.0, 2.0]


def test_spectra_at_the_peak(swept):
    sweep = swept[0]
    job = PeakSpectraJob(name="spectra", sweep=sweep.name, structure=DAMPED, others=(0.4,))
    asked = job.derived_job({sweep.name: ask(sweep)})
    assert asked.eta == (1.06, 0.4) and asked.count() == job.count()


def test_basins_where_starts_are_shared(exported):
    sweep = SweepJob(name="sweep", structure=PAPER, eta=(1.29, 1.315), transient=60, samples=20)
    settings = AttractorSettings(transient=100, settle=100.0)
    starts = AttractorsJob(
        name="starts",
        structure=PAPER,
        eta=(1.29, 1.315),
        starts=12,
        seed=2026,
        follows="sweep",
        settings=settings,
    )
    plane = TwoAttractorBasinJob(
        name="basin",
        structure=PAPER,
        excitation=Excitation.nondimensional(1.0, PAPER),
        x=PlaneAxis("x_rel", 0.0, 3.0, 4),
        y=PlaneAxis("v_rel", -3.0, 3.0, 3),
        settings=settings,
        attractors="starts",
        sweep="sweep",
    )
    found = ask(sweep, starts, plane)
    gap = float(ask(sweep).xi_rel_max.sel(eta=float(found.eta)))
    assert found.x_rel.values.tolist() == pytest.approx(np.linspace(0.0, 3.0 * gap, 4))
    assert found.attractor_of.shape == (3, 4)
    assert replace(plane, low=1.3).frequency({"starts": ask(sweep, starts)}) == 1.315
