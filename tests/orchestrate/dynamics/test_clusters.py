"""Responses told apart: clusters against SciPy's single linkage, and cases with a known answer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.cluster.hierarchy import fcluster, linkage

from orchestrate.access import OSCILLATOR, REST, Instance, find
from orchestrate.dynamics.clusters import (
    AttractorSettings,
    irregular_clusters,
    response_features,
    run_until_settled,
    single_linkage,
    transient_periods,
)
from orchestrate.response.questions import Point
from orchestrate.response.respond import Response, respond
from orchestrate.response.sweep import sweep
from orchestrate.structures import Excitation, Structure

PAPER = Structure.nondimensional()


@given(st.integers(0, 10_000), st.integers(2, 60), st.floats(0.01, 0.5))
def test_chains_are_single_linkage(seed, count, radius):
    points = np.random.default_rng(seed).uniform(size=(count, 3))
    found = single_linkage(points, radius)
    expected = fcluster(linkage(points, "single"), radius, "distance")
    assert ((found[:, None] == found) == (expected[:, None] == expected)).all()


def test_labels_are_in_the_order_in_which_clusters_are_met():
    points = np.array([[0.0], [5.0], [0.1], [9.0], [5.1], [0.2]])
    assert single_linkage(points, 0.15).tolist() == [0, 1, 0, 2, 1, 0]
    assert single_linkage(np.empty((0, 2)), 1.0).tolist() == []


def test_memory_does_not_grow_with_the_square_of_the_starts():
    points = np.zeros((50_000, 4))  # all pairs would be ten gigabytes
    assert (single_linkage(points, 0.1) == 0).all()


def test_irregular_responses_are_grouped_by_their_means():
    chain = [[0, 1.4 + 0.02 * k, 2.0 + 0.1 * k, 0.5, 0.3] for k in range(5)]
    rows = [*chain[:2], [0, 1.4, 0.5, 0.1, 0.1], *chain[2:]]
    assert irregular_clusters(rows, AttractorSettings()).tolist() == [0, 0, 1, 0, 0, 0]
    assert irregular_clusters(rows, AttractorSettings(alike_irregular=0.01)).max() == 5
    assert irregular_clusters(np.empty((0, 5)), AttractorSettings()).tolist() == []


def test_features_of_periodic_responses_are_over_whole_periods():
    samples = np.zeros((48, 4))
    samples[:, 1] = [3.0, 6.0, 9.0, 12.0, 15.0] * 9 + [3.0, 6.0, 9.0]
    given = {"x_rel_max": 16.0, "permanent_contact": False, "frequency": 1.0, "tolerance": 1e-2}
    given |= {"impacts_per_period": 19.0 / 48.0, "impact_count": 19}
    periodic = Response(samples=samples, **given)
    assert response_features(periodic, 3.0) == pytest.approx(
        [5, 0.4, 16.0 / 3.0, 3.0, np.sqrt(2.0)]
    )
    irregular = Response(samples=np.arange(192.0).reshape(48, 4), **given)
    assert response_features(irregular, 3.0)[:2] == [0, 19.0 / 48.0]


@pytest.mark.parametrize(
    ("eta", "multiplicity", "least", "most"),
    [
        (1.047, 1, 0, 5_000),
        (2.06, 1, 0, 5_000),  # a deviation turns by half as it dies: 2T repeats earlier than T
        (2.655, 0, 20_000, 21_000),  # a torus, which T nearly is
        (0.8, 0, 20_000, 21_000),  # chaos
    ],
)
def test_a_response_is_run_on_until_it_is_known(exported, eta, multiplicity, least, most):
    point = Point(PAPER, Excitation.nondimensional(eta, PAPER))
    with Instance(find(OSCILLATOR).path) as instance:
        response, periods = run_until_settled(instance, point, REST, AttractorSettings())
    assert response.multiplicity == multiplicity
    assert least <= periods <= most


def test_a_long_transient_is_not_what_it_settles_to(exported):
    """At D = 0.05 T/1 is unstable at 1.116: deviations take thousands of periods to grow."""
    damped = PAPER.replace(D=0.05)
    point = Point(damped, Excitation.nondimensional(1.116, damped))
    near = sweep(damped, eta=1.115, transient=3000, samples=10).end_state.values[0]
    with Instance(find(OSCILLATOR).path) as instance:
        early = respond(instance, *point, near, 500, 200, 1e-2)
        response, periods = run_until_settled(instance, point, near, AttractorSettings())
    assert (early.multiplicity, early.impacts_per_period) == (1, 1.0)
    assert (response.multiplicity, response_features(response, 1.0)[1]) == (2, 1.5)
    assert periods > 2_000


def test_short_periods_take_more_of_them():
    assert [transient_periods(400, 300.0, eta) for eta in (0.5, 1.5, 8.0)] == [400, 450, 2400]
