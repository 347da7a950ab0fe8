"""What the paper's parts are made of: impacts, curves, windows, attractors, spectra, claims."""

import numpy as np
import pytest
import xarray

from orchestrate.attractors import clusters
from orchestrate.curves import CONTACT, FLIGHT, SEQUENCE, Panel, curve
from orchestrate.fmu import Instance
from orchestrate.jobs import identities
from orchestrate.paper import plan
from orchestrate.paper.claims import CLAIMS
from orchestrate.paper.claims.claim import NO, PARTLY, YES, half_unit, holds, limit_at, number_at
from orchestrate.paper.resolution import FULL, QUICK
from orchestrate.paper.spectra import PERIODS, POINTS, amplitudes, spectrum
from orchestrate.paper.windows import followed, longest, relative_peak, runs, window
from orchestrate.sweep import Case
from orchestrate.trace import STATE, EventInstance, begin, period, sampled

from .conftest import exported


@pytest.fixture(scope="module")
def fmi3():
    """The FMU with events."""
    return exported("fmi3") or pytest.skip("no fmi3 here")


def test_impacts_are_those_the_fmu_counts(fmi3):
    case, end = Case(), 30 * period(0.4)
    with EventInstance(fmi3) as eventful, Instance(fmi3) as plain:
        begin(eventful, case, 0.4)
        impacts = eventful.impacts(0.0, end)
        begin(plain, case, 0.4)
        plain.step(0.0, end)
        assert plain.get("impact_count", "contact_count") == [len(impacts.time), impacts.sticks.sum()]
        assert eventful.get(*STATE) == plain.get(*STATE)  # the last bit: events are no disturbance
        energy = 0.25 * (1.0 - case.e**2) * impacts.closing**2
        sticking = 0.25 * impacts.closing**2
        lost = np.where(impacts.sticks, sticking, energy).sum()
        assert plain.get("impact_energy")[0] == pytest.approx(lost, rel=1e-3)
    before = impacts.before(case)
    np.testing.assert_allclose(before[:, 2] - before[:, 3], impacts.closing, atol=1e-12)
    np.testing.assert_allclose(before[:, 2:].sum(axis=1), impacts.state[:, 2:].sum(axis=1), atol=1e-12)


def test_a_curve_has_both_sides_of_each_impact(fmi3):
    start = (0.0, 0.0, 0.0, 0.0)
    points = curve(fmi3, Panel(Case(), 0.4, start), 200, 1, 500)
    tau, state, kind = points["tau"], points["state"], points["kind"]
    assert (np.diff(tau) >= 0.0).all() and tau[0] == 0.0
    assert (state[:, 1] - state[:, 0] > -1e-6).all()
    assert {FLIGHT, SEQUENCE, CONTACT} == set(kind.tolist())
    jumps = (np.diff(tau) == 0.0) & (np.diff(state[:, 2]) != 0.0)
    assert jumps.sum() == 30
    assert (np.abs(np.diff(state, axis=0)[jumps][:, :2]) < 1e-6).all(), "displacements do not jump"


def sweep_of(multiplicity, impacts, gaps):
    """A sweep's dataset from lists, eta = 1, 2, ..."""
    etas = np.arange(1.0, len(gaps) + 1)
    along = {"multiplicity": ("eta", multiplicity), "impacts_per_period": ("eta", impacts), "xi_rel_max": ("eta", gaps)}
    return xarray.Dataset({**along, "xi_rel": (("eta", "sample"), np.zeros((len(gaps), 200)))}, {"eta": etas})


def test_runs():
    assert runs([0, 1, 1, 0, 1]) == [(1, 2), (4, 4)]
    assert longest([0, 1, 1, 0, 1]) == (1, 2)
    assert longest([0, 0]) is None and runs([]) == []


def test_windows_and_their_peaks():
    sweep = sweep_of([2, 2, 2, 2, 2, 1, 2], [0.5, 0.5, 0.5, 0.5, 1.0, 1.0, 0.5], [9.0, 1.0, 3.0, 2.0, 8.0, 7.0, 9.0])
    assert window(sweep, 2) == (1.0, 4.0)
    assert relative_peak(sweep, 2) == 3.0  # not the higher end
    assert window(sweep, 3) is None and relative_peak(sweep, 3) is None and relative_peak(sweep, 1) is None


def test_a_window_is_followed_to_its_peak(fmi3):
    with Instance(fmi3) as instance:
        begin(instance, Case(D=0.05), 1.9)
        instance.step(0.0, 300 * period(1.9))
        start = tuple(instance.get(*STATE))
    eta, _ = followed(fmi3, Panel(Case(D=0.05), 1.9, start), 1)
    assert eta == pytest.approx(2.054, abs=0.0015)


def test_attractors_are_told_apart():
    one, two = [1, 1.0, 0.25, 0.1, 0.0], [2, 1.5, 0.43, 0.2, 0.1]
    wild = [[0, 1.4 + 0.02 * k, 2.0 + 0.1 * k, 0.5, 0.3] for k in range(5)]
    labels = clusters([one, two, [1, 1.0, 0.2501, 0.1, 0.0], one, *wild, [1, 1.0, 0.35, 0.1, 0.0]])
    assert labels.tolist() == [1, labels[1], 1, 1, 0, 0, 0, 0, 0, labels[-1]]
    assert {int(labels[1]), int(labels[-1])} == {2, 3}


def test_spectrum_holds_the_impulses(fmi3):
    """Against the sum over the impacts, whose times and velocities the FMU reports."""
    case, eta = Case(), 1.047
    span, first = period(eta), 1200 * period(eta)
    with Instance(fmi3) as plain, EventInstance(fmi3) as eventful:
        begin(plain, case, eta)
        plain.step(0.0, first)
        states = sampled(plain, first, first + PERIODS * span, PERIODS * POINTS)
        begin(eventful, case, eta)
        eventful.advance(0.0, first)
        impacts = eventful.impacts(first, first + span)
    orders, whole, smooth = spectrum(states, eta, case)
    turns = np.exp(-1j * eta * np.outer(np.arange(1, 31), impacts.time))
    impulses = -(1 + case.e) / 2 * impacts.closing
    acceleration = -2 * case.D * states[:, 2] - states[:, 0]
    tau = first + np.arange(1, len(states) + 1) * span / POINTS
    fourier = [np.mean(acceleration[:POINTS] * np.exp(-1j * k * eta * tau[:POINTS])) for k in range(1, 31)]
    expected = 2 * np.abs(np.array(fourier) + turns @ impulses / span)
    lines = np.searchsorted(orders, np.arange(1, 31) - 1e-9)
    np.testing.assert_allclose(whole[lines], expected, rtol=0.01)
    assert smooth[lines[19]] < 0.02 * whole[lines[19]], "sampled accelerations have next to nothing there"


def test_amplitude_of_a_sine():
    signal = 3.0 * np.sin(2 * np.pi * 5 * np.arange(256) / 256)
    assert amplitudes(signal)[5] == pytest.approx(3.0)


def test_what_rounds_to_a_printed_number():
    assert half_unit("0.43") == pytest.approx(0.005) and half_unit("1.1") == pytest.approx(0.05)
    assert number_at(21.558, "21.56", 3).verdict == YES
    assert number_at(1.047, "1.045", 3).verdict == NO
    assert limit_at((1.224, 1.225), "1.23").verdict == YES
    assert limit_at((1.223, 1.224), "1.23").verdict == NO
    assert limit_at((0.436, 0.437), "0.43").verdict == NO
    assert limit_at((float("nan"), float("nan")), "0.43").verdict == NO
    assert [holds(parts, "").verdict for parts in ([True], [True, False], [False])] == [YES, PARTLY, NO]


def test_claims_are_of_all_sections():
    assert {claim.section for claim in CLAIMS} == {"3", "3.1", "3.2", "4.1", "4.2", "5"}
    printed = " ".join(claim.printed for claim in CLAIMS)
    numbers = "0.43 1.37 0.89 21.56 1.045 1.07 2.61 3.77 0.48 0.85 1.08 2.63 1.056 1.1 1.11 1.33 0.97 1.02 1.23 16.41 1.048"
    for number in numbers.split():
        assert number in printed.split(), number


def test_jobs_come_after_what_they_need():
    for resolution in (FULL, QUICK):
        whole = plan.make(resolution, "guid")
        known = identities(whole.jobs.values())
        assert list(known) == list(whole.jobs)
        assert {"claims", *map(str, range(5, 13)), "lyapunov", "attractors", "basin", "maps", "spectra"} == set(whole.parts)
        assert [job.name for job in whole.needed(whole.choose("5"))] == ["orbit_e0.7_D0.005_up", "figure5"]
    assert plan.make(FULL, "guid").jobs["basin"].identity() != plan.make(QUICK, "guid").jobs["basin"].identity()
