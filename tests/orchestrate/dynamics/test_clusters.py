"""Responses told apart: clusters against SciPy's single linkage, and cases with a known answer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.cluster.hierarchy import fcluster, linkage

from orchestrate.dynamics.clusters import (
    Telling,
    attractors_of,
    clusters,
    connected,
    features,
    settling,
)
from orchestrate.response.respond import Response


@given(st.integers(0, 10_000), st.integers(2, 60), st.floats(0.01, 0.5))
def test_chains_are_single_linkage(seed, count, radius):
    points = np.random.default_rng(seed).uniform(size=(count, 3))
    found = connected(points, radius)
    expected = fcluster(linkage(points, "single"), radius, "distance")
    assert ((found[:, None] == found) == (expected[:, None] == expected)).all()


def test_labels_are_in_the_order_in_which_clusters_are_met():
    points = np.array([[0.0], [5.0], [0.1], [9.0], [5.1], [0.2]])
    assert connected(points, 0.15).tolist() == [0, 1, 0, 2, 1, 0]
    assert connected(np.empty((0, 2)), 1.0).tolist() == []


def test_memory_does_not_grow_with_the_square_of_the_starts():
    points = np.zeros((50_000, 4))  # all pairs would be ten gigabytes
    assert (connected(points, 0.1) == 0).all()


def test_attractors_are_told_apart():
    one, two = [1, 1.0, 0.25, 0.1, 0.0], [2, 1.5, 0.43, 0.2, 0.1]
    wild = [[0, 1.4 + 0.02 * k, 2.0 + 0.1 * k, 0.5, 0.3] for k in range(5)]
    rows = [one, two, [1, 1.0, 0.2501, 0.1, 0.0], one, *wild, [1, 1.0, 0.35, 0.1, 0.0]]
    labels = clusters(rows, Telling())
    assert labels.tolist() == [1, 3, 1, 1, 0, 0, 0, 0, 0, 2]
    assert clusters(rows, Telling(alike=1.0)).max() == 2
    assert clusters(rows, Telling(alike_irregular=0.01)).max() == 7


def test_attractors_have_shares_medians_and_a_state():
    rows = np.array([[1, 1, 0.2, 0, 0], [2, 1, 0.4, 0, 0], [1, 1, 0.3, 0, 0]], dtype=float)
    ends = np.arange(12.0).reshape(3, 4)
    first, second = attractors_of(np.array([0, 1, 0]), rows, ends)
    assert first.share == pytest.approx(2 / 3)
    assert first.about.tolist() == [1.0, 1.0, 0.25]
    assert first.state.tolist() == ends[0].tolist()
    assert second.state.tolist() == ends[1].tolist()


def test_impacts_that_do_not_repeat_make_a_response_irregular():
    samples = np.zeros((48, 4))
    samples[:, 1] = 3.0
    settled = {"samples": samples, "x_rel_max": 6.0, "permanent_contact": False}
    whole = Response(**settled, impacts_per_period=1.5, multiplicity=2)
    assert features(whole, 3.0) == [2, 1.5, 2.0, 1.0, 0.0]
    uneven = Response(**settled, impacts_per_period=1.7, multiplicity=2)
    assert features(uneven, 3.0)[0] == 0


def test_short_periods_take_more_of_them():
    assert [settling(400, 300.0, eta) for eta in (0.5, 1.5, 8.0)] == [400, 450, 2400]
