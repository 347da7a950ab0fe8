"""What is read off datasets: runs, windows, edges, peaks, regions, crossings of curves."""

import math

import numpy as np
import pytest

from orchestrate.paper.measures.windows import count_changes, count_self_crossings
from orchestrate.paper.reading import (
    are_windows_separated,
    edges_of_run_around,
    impacts_in_response,
    is_on_orbit,
    list_regions,
    relative_peak_eta,
    runs_of_true,
    window_edges,
)

from .known import known, responses


def sweep_of(n, impacts, gaps=None):
    """A sweep over eta = 1, 2, ..."""
    etas = np.arange(1.0, len(n) + 1)
    return responses(etas, n, impacts, xi_rel_max=np.array(gaps or [1.0] * len(n)))


def test_runs():
    assert runs_of_true([0, 1, 1, 0, 1]) == [(1, 2), (4, 4)]
    assert runs_of_true([]) == runs_of_true([0, 0]) == []


def test_windows_and_their_peaks():
    n, impacts = [2, 2, 2, 2, 2, 1, 0, 3, 3], [1, 1, 1, 1, 2, 1, 1, 1, 1]
    sweep = sweep_of(n, impacts, [9.0, 1.0, 3.0, 2.0, 8.0, 7.0, 9.0, 1.0, 2.0])
    assert window_edges(sweep)[1] == ((1.0, 1.0), (4.0, 5.0))
    assert relative_peak_eta(sweep, 2) == 3.0  # not the higher end
    assert relative_peak_eta(sweep, 1) is None and relative_peak_eta(sweep, 4) is None
    in_order, out_of_order = sweep_of([1, 0, 2, 3], [1] * 4), sweep_of([2, 0, 1, 0, 3], [1] * 5)
    assert are_windows_separated(in_order) == [True, False, False]
    assert are_windows_separated(out_of_order) == [False, True, False]


def test_edges():
    sweep = sweep_of([1, 1, 2, 2, 0], [1, 1, 3, 3, 3])
    assert impacts_in_response(sweep).tolist() == [1, 1, 3, 3, 0]
    assert edges_of_run_around(sweep, is_on_orbit(sweep, "T/1"), 1.0)[1] == (2.0, 3.0)
    assert edges_of_run_around(sweep, is_on_orbit(sweep, "2T/3"), 4.0)[0] == (2.0, 3.0)
    assert all(map(math.isnan, edges_of_run_around(sweep, is_on_orbit(sweep, "T/1"), 4.0)[1]))


def test_regions_are_windows_and_what_lies_between():
    window = known().window_nearest
    found = list_regions(lambda orbit, inside: window("elastic", orbit, inside))
    assert [region.is_window for region in found] == [False, True] * 5
    assert [region.name for region in found][-2:] == ["3T/1 to 4T/1", "4T/1"]
    assert (found[0].low, found[0].high, found[-1].high) == (0.42, 0.89, 8.0)


def test_what_becomes_of_responses_later():
    first = sweep_of([1, 1, 0, 2, 1, 0], [1, 1, 1, 1, 1, 1])
    later = sweep_of([1, 0, 1, 2, 1, 0], [1, 1, 1, 3, 1, 1], [1.0, 1, 1, 1, 1.05, 2.0])
    assert count_changes(first, later) == (
        4,
        " (1 irregular, later periodic, 1 periodic, later irregular, 1 periodic, later with "
        "another period or other impacts, 1 of another size later)",
    )


@pytest.mark.parametrize(("turns", "expected"), [(1, 0), (2, 1), (3, 2)])
def test_crossings_of_closed_curves(turns, expected):
    angle = np.linspace(0.1, 0.1 + 2.0 * np.pi, 300)
    assert count_self_crossings(np.sin(angle), np.cos(turns * angle + 0.3)) == expected
