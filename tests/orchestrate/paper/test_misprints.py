"""Misprints: the corrected form fulfils what the printed one does not; curves with known loops."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.paper.claims import section2
from orchestrate.paper.claims.claim import NO
from orchestrate.paper.claims.results import Results
from orchestrate.paper.claims.section3 import crossings


@pytest.mark.parametrize(
    "check",
    [
        section2.check_scale,
        section2.check_free_part,
        section2.check_momentum,
        section2.check_period,
    ],
)
def test_an_equation_holds_as_corrected_only(check):
    found = check(Results({}))
    assert found.verdict == NO
    assert found.why == ""  # what the corrected form leaves is rounding


def test_both_misprints_of_the_solution_matter():
    nu = np.sqrt(section2.STIFFNESS - section2.D**2)
    assert section2.residual(section2.solution(nu, section2.D)) < 1e-6
    assert section2.residual(section2.solution(nu, 1.0)) > 0.1
    assert section2.residual(section2.solution(section2.STIFFNESS, section2.D)) > 0.1


@pytest.mark.parametrize(("turns", "expected"), [(1, 0), (2, 1), (3, 2)])
def test_crossings_of_closed_curves(turns, expected):
    angle = np.linspace(0.1, 0.1 + 2.0 * np.pi, 300)
    assert crossings(np.sin(angle), np.cos(turns * angle + 0.3)) == expected
