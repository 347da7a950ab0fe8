"""Branches and bifurcations against closed forms, and the branches that leave there."""

import functools
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestrate.dynamics import manifolds
from orchestrate.dynamics.attractors import attractors
from orchestrate.dynamics.branches import branch, complete_excitation
from orchestrate.dynamics.orbits import orbit
from orchestrate.flags import flag_words
from orchestrate.model import Excitation, Structure
from orchestrate.response import signatures
from orchestrate.response.questions import Point

from ...sparing import ordinary
from .single_impact import SingleImpact, border
from .stroboscopic import after

PAPER = Structure.nondimensional(e=0.7, D=0.005)
DOCS = Path(__file__).resolve().parents[3] / "docs"
FOLD, FLIP, TORUS, GRAZING, TOUCHING, CONTACT_LOST = range(6)
HALVING = 8
WINDOWS = {  # with one impact in so many periods: eta, its limit, borders of stability
    **{1: (1.5, 8.0, [(2.5, 2.7)]), 2: (4.0, 8.0, [(3.55, 3.65), (4.7, 4.8)])},
    **{3: (6.0, 8.0, [(5.65, 5.75), (6.8, 6.9)]), 4: (8.0, 9.5, [(7.7, 7.85), (8.9, 9.0)])},
}
LOWEST = 1.37  # of eta
PERIODS = ordinary(WINDOWS, [2])  # of the others nothing is written otherwise


@functools.cache
def windows(period):
    """The branch with one impact in so many periods, for Figure 6."""
    eta, high, _ = WINDOWS[period]
    return branch(PAPER, eta=eta, period=period, limits=(LOWEST, high), longest=0.3)


def values(found, kind):
    return found.bifurcation_value.values[found.bifurcation_kind.values == kind]


@pytest.mark.parametrize("period", PERIODS)
def test_all_orbits_of_a_branch_are_those_of_the_closed_form(period):
    found = windows(period)
    eta = found.eta.values
    assert (np.diff(eta) > 0.0).all() and len(eta) < 250  # steps are long
    for i in range(0, len(eta), 10):
        truth = SingleImpact(float(eta[i]), period)
        assert found.node_closing.values[i, 0] == pytest.approx(truth.closing, abs=1e-10)
        assert np.abs(found.multipliers.values[i] @ [1, 1j] - truth.multipliers).max() < (
            1e-8 * truth.largest
        )
    assert found.fmu_same_impacts.values.mean() > 0.99  # but where a flight grazes
    for low, high in WINDOWS[period][2]:
        assert np.abs(values(found, TORUS) - border(period, low, high)).min() < 1e-9


def test_period_doubling_against_a_wall():
    """At omega = 2.5 and restitution 0.8 the orbit doubles its period at a wall 0.07667521 away."""
    structure = Structure(d1=0.0, e=0.8, wall=True)
    start = orbit(structure, eta=2.5, guess={"impact_time": [2.0]})
    for over, pushed in (("box_acceleration", {}), ("clearance", {"clearance": 1e-3})):
        given = {"start": start, "over": over, "limits": (0.0, 0.1), "longest": 0.3}
        found = branch(structure.replace(**pushed), **given)
        assert np.abs(values(found, FLIP) - 0.07667521).min() < 1e-8


def test_impacts_begin_where_the_linear_response_touches():
    """At the force 0.1 for k = 1, c = 0.1, omega = 1 and a wall at 1."""
    structure = Structure(d1=0.1, e=0.8, wall=True)
    given = {"over": "amplitude", "box_acceleration": 1.0, "longest": 0.3}
    known = {"frequency": 1.0, "amplitude": 0.2, "box_acceleration": 1.0}
    start = orbit(structure, guess={"impact_time": [2.0]}, **known)
    above = branch(structure, start=start, limits=(0.08, 0.22), **given)
    assert values(above, GRAZING) == pytest.approx([0.1], abs=1e-9)
    first = int(np.flatnonzero(above.bifurcation_kind.values == GRAZING)[0])
    below = branch(structure, start=above, switch=first, limits=(0.08, 0.22), **given)
    assert not (below.node_kind.values >= 0).any()
    assert below.amplitude.values.min() == 0.08


def test_a_doubled_branch_leaves_at_a_period_doubling():
    first = windows(2)
    number = int(np.flatnonzero(first.bifurcation_kind.values == FLIP)[0])
    found = branch(PAPER, start=first, switch=number, limits=(1.37, 9.5), most=40)
    assert found.sizes["sample"] == 4
    assert found.eta.values[0] == pytest.approx(first.bifurcation_value.values[number], abs=1e-12)
    assert abs(found.multipliers.values[0]).max() > 1.0 - 1e-6
    assert not bool(found.stable[0])  # a multiplier is -1 to rounding there
    later = found.isel(point=slice(3, None))
    assert (np.abs(later.xi.values[:, :2] - later.xi.values[:, 2:]).max(axis=(1, 2)) > 1e-6).all()
    assert later.fmu_same_impacts.values.mean() > 0.9


DOUBLED = Structure.nondimensional(mu=2.28789, kappa=1.83161, D1=0.0228225, D2=0.0282898, e=0.2628)
DOUBLED = DOUBLED.replace(e_slope=0.0434816)


@pytest.mark.slow
def test_a_doubled_branch_ends_where_it_has_half_its_period_again():
    """It turns there, and was said to fold; beyond are the same orbits, begun a period later."""
    eta = 2.6198833
    found = attractors(DOUBLED, eta=[eta], starts=6)
    twice = orbit(DOUBLED, eta=eta, period=2, guess=found.state.values[0, 0])
    over = {"over": "e", "limits": (0.06, 0.46)}
    doubled = branch(DOUBLED, start=twice, **over)
    assert doubled.attrs["first_end"] == "period halving"
    (place,) = values(doubled, HALVING)
    assert not len(values(doubled, FOLD))
    below = DOUBLED.replace(e=float(place) - 0.02)
    single = branch(below, start=orbit(below, eta=eta, period=1), **over)
    (expected,) = values(single, FLIP)
    assert place == pytest.approx(expected, abs=1e-7)
    away = np.abs(doubled.state.values[:, 0] - doubled.state.values[:, 1]).max(axis=-1)
    assert away.argmin() == 0 and (doubled.e.values > place - 1e-6).all()


def test_an_orbit_with_one_impact_more_leaves_at_a_grazing():
    first = windows(2)
    assert first.attrs["first_end"] == "grazing of a flight" != first.attrs["last_end"]
    number = int(np.flatnonzero(first.bifurcation_kind.values == TOUCHING)[0])
    found = branch(PAPER, start=first, switch=number, limits=(1.37, 9.5))
    assert ((found.node_kind.values == 0).sum(axis=1) == 2).all()
    assert found.node_closing.values[0].min() == pytest.approx(0.0, abs=1e-12)
    assert (found.node_closing.values[1:].min(axis=1) > 0.0).all()
    assert found.fmu_same_impacts.values[1:-1].all()
    fold = found.isel(bifurcation=found.bifurcation_kind.values == FOLD)
    assert fold.sizes["bifurcation"] == 1
    assert fold.bifurcation_value.item() == pytest.approx(found.eta.values.max(), abs=1e-5)
    assert np.abs(fold.bifurcation_multipliers.values[0] @ [1, 1j] - 1.0).min() < 1e-6


@pytest.mark.slow
def test_permanent_contact_is_followed_until_it_is_lost(instances):
    found = branch(PAPER, eta=0.413, limits=(0.412, 0.43))
    assert found.attrs["last_end"] == "loss of permanent contact"
    assert found.permanent_contact.values.all()
    assert found.fmu_same_impacts.values.mean() > 0.95
    (lost,) = values(found, CONTACT_LOST)
    for away in (-1e-5, 1e-5):
        point = Point(PAPER, Excitation.nondimensional(lost + away, PAPER))
        settled = after(instances[0], point, found.state.values[-1, 0], 500)
        after(instances[0], point, settled, 20)
        assert (instances[0].get("contact_count")[0] > 0) == (away < 0.0)


@pytest.mark.parametrize("period", PERIODS)
def test_the_table_in_the_documentation_is_this(period):
    """Eight digits each; the T/1 branch is followed further down there."""
    lines = (DOCS / "bifurcations.md").read_text("utf-8").splitlines()
    label = f"| {period if period > 1 else ''}T/1 |"
    rows = [line.split("|")[1:] for line in lines if line.startswith(label)]
    found = windows(period)
    names = flag_words(found.bifurcation_kind.attrs)
    kinds = [names[kind] for kind in found.bifurcation_kind.values]
    own = sorted(zip(kinds, found.bifurcation_value.values, strict=True))
    printed = sorted((row[2].strip(), float(row[1])) for row in rows if float(row[1]) > LOWEST)
    assert [name for name, _ in own] == [name for name, _ in printed]
    assert [v for _, v in own] == pytest.approx([v for _, v in printed], abs=1.1e-8)


@pytest.mark.parametrize("longest", ordinary([1.0, 0.2, 0.03]))
def test_two_bifurcations_of_a_kind_within_a_step_are_found(longest):
    """Two period doublings that damping has all but merged: no step ends between them."""
    structure, limits = PAPER.replace(D=0.06876), (1.1, 1.4)
    found = branch(structure, eta=1.4, limits=limits, longest=longest)
    assert found.bifurcation_kind.values.tolist() == [FLIP, FLIP]
    places = np.floor(found.bifurcation_place.values)
    assert places[0] == places[1] or longest == 0.03
    for value in found.bifurcation_value.values:
        truth = SingleImpact(float(value), 1, D=0.06876)
        assert np.abs(truth.multipliers + 1.0).min() < 1e-9


@pytest.mark.parametrize("over", ["k1", "m1", "omega", "f1"])
def test_where_omega_varies_the_frequency_is_kept_that_was_asked_for(over):
    beam, at = Structure.from_file("beam"), {"eta": 1.3, "frequency": 97.4, "amplitude": 1e-4}
    asked = (("frequency", 97.4), ("amplitude", 1e-4)), (("eta", 1.3),)
    for one in asked:
        start = xr.Dataset(coords=at, attrs={"excitation": json.dumps(one)})
        for varied in ((over,), ("e", over)):
            assert complete_excitation(start, varied, (), (0.0, 1.0), beam, {}) == one
        assert complete_excitation(start, ("e",), (), (0.0, 1.0), beam, {}) == asked[1]


def test_what_pushes_at_the_start_is_kept(monkeypatch):
    """Of an orbit that is stable, whose manifold is refused after that."""
    pushes = {"box_acceleration": 0.05, "force1": 0.02}
    start = orbit(PAPER, eta=1.7, **pushes)
    monkeypatch.setattr(signatures, "compute_dataset", lambda job, *rest: job)
    kept = branch(PAPER, start=start, limits=(1.6, 1.8))
    assert dict(kept.setting.excitation) == pushes
    given = branch(PAPER, start=start, limits=(1.6, 1.8), box_acceleration=0.0)
    assert dict(given.setting.excitation) == {"force1": 0.02}
    along = branch(PAPER, start=start, over="box_acceleration", limits=(0.0, 0.1))
    assert along.value == 0.05 and dict(along.setting.excitation)["force1"] == 0.02
    monkeypatch.setattr(manifolds.ManifoldJob, "solve_saddle", lambda job: None)
    kept = manifolds.manifold(PAPER, start=start)
    assert {name: getattr(kept, name) for name in pushes} == pushes
