"""What is read off the results: runs, windows, edges, peaks, what rounds to a printed number."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr

from orchestrate.paper.claims.claim import (
    BOTH,
    EXACT,
    NEITHER,
    NO,
    PARTLY,
    SWEPT,
    UNDECIDED,
    YES,
    Claim,
    Finding,
    check_limit,
    check_number,
    check_parts,
    half_unit,
)
from orchestrate.paper.claims.results import (
    Limit,
    Results,
    impacts_in_response,
    is_orbit,
    lower_edge,
    upper_edge,
)
from orchestrate.paper.sweep_windows import longest_run, relative_peak, runs, window


def sweep_of(multiplicity, impacts, gaps):
    """A sweep's dataset from lists, eta = 1, 2, ..."""
    along = {"multiplicity": multiplicity, "impacts_per_period": impacts, "xi_rel_max": gaps}
    variables = {name: ("eta", np.array(values)) for name, values in along.items()}
    samples = (("eta", "sample"), np.zeros((len(gaps), 200)))
    etas = np.arange(1.0, len(gaps) + 1)
    return xr.Dataset({**variables, "xi_rel": samples}, {"eta": etas})


def test_runs():
    assert runs([0, 1, 1, 0, 1]) == [(1, 2), (4, 4)]
    assert longest_run([0, 1, 1, 0, 1]) == (1, 2)
    assert longest_run([0, 0]) is None and runs([]) == []


def test_windows_and_their_peaks():
    impacts = [0.5, 0.5, 0.5, 0.5, 1.0, 1.0, 0.5]
    sweep = sweep_of([2, 2, 2, 2, 2, 1, 2], impacts, [9.0, 1.0, 3.0, 2.0, 8.0, 7.0, 9.0])
    assert window(sweep, 2) == (1.0, 4.0)
    assert relative_peak(sweep, 2) == 3.0  # not the higher end
    assert window(sweep, 3) is None and relative_peak(sweep, 3) is None
    assert relative_peak(sweep, 1) is None


def test_edges():
    sweep = sweep_of([1, 1, 2, 2, 0], [1.0, 1.0, 1.5, 1.5, 1.5], [1.0] * 5)
    assert impacts_in_response(sweep).tolist() == [1, 1, 3, 3, 0]
    assert upper_edge(sweep, is_orbit(sweep, 1, 1), 1.0) == (2.0, 3.0)
    assert lower_edge(sweep, is_orbit(sweep, 2, 3), 4.0) == (2.0, 3.0)
    assert all(map(math.isnan, upper_edge(sweep, is_orbit(sweep, 1, 1), 4.0)))


def test_what_rounds_to_a_printed_number():
    assert half_unit("0.43") == pytest.approx(0.005) and half_unit("1.1") == pytest.approx(0.05)
    assert check_number(21.558, "21.56", 3).verdict == YES
    assert check_number(1.047, "1.045", 3).verdict == NO


@pytest.mark.parametrize(
    ("edges", "exact", "printed", "verdict", "agrees"),
    [
        ((0.891, 0.892), 0.89135, "0.89", YES, BOTH),
        ((1.226, 1.227), 1.22421, "1.23", PARTLY, SWEPT),
        ((1.224, 1.225), 1.22421, "1.23", NO, NEITHER),  # touches what rounds to 1.23, no more
        ((1.117, 1.118), 1.10659, "1.11", PARTLY, EXACT),
        ((0.417, 0.418), 0.41739, "0.43", NO, NEITHER),
        ((1.223, 1.224), 1.22421, "1.23", NO, NEITHER),
        ((math.nan, math.nan), 0.41739, "0.43", NO, NEITHER),
    ],
)
def test_a_limit_is_read_twice(edges, exact, printed, verdict, agrees):
    found = check_limit(edges, Limit(exact, "fold", "T/2"), printed)
    assert (found.verdict, found.agrees) == (verdict, agrees)
    assert f"exact: {exact:.8f} (fold of T/2)" in found.value and agrees in found.value


def test_what_takes_the_full_resolution_is_not_decided_at_another():
    claim = Claim("3", "", "", "", "", lambda results: Finding("1", YES, "so"), full=True)
    assert claim.row(Results({}))["verdict"] == YES
    row = claim.row(Results({}, full=False))
    assert (row["verdict"], row["found"]) == (UNDECIDED, "1")


@pytest.mark.parametrize(
    ("parts", "verdict"), [([True], YES), ([True, False], PARTLY), ([False], NO)]
)
def test_what_holds_in_part(parts, verdict):
    assert check_parts(parts, "").verdict == verdict
