"""Clusters of responses against SciPy's single linkage, and each threshold of irregular ones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.cluster.hierarchy import fcluster, linkage

from orchestrate.dynamics.clusters import irregular_clusters, single_linkage
from orchestrate.dynamics.settling import AttractorSettings


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


@pytest.mark.parametrize(
    ("other", "alike"),
    [
        *(([0, 1.0, np.exp(0.249), 0.0, 0.0], True), ([0, 1.0, np.exp(0.251), 0.0, 0.0], False)),
        *(([0, 1.0, 1.0, 0.249, 0.0], True), ([0, 1.0, 1.0, 0.0, 0.251], False)),
        *(([0, 2.24, 1.0, 0.0, 0.0], True), ([0, 2.26, 1.0, 0.0, 0.0], False)),  # a fifth counts
        *(([0, 1.5, 1.0, 0.2, 0.1], True), ([0, 1.5, 1.0, 0.2, 0.12], False)),  # of both
    ],
)
def test_each_threshold_of_irregular_responses(other, alike):
    rows = [[0, 1.0, 1.0, 0.0, 0.0], other]
    assert irregular_clusters(rows, AttractorSettings()).tolist() == [0, 0 if alike else 1]
