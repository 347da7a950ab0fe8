"""Phasors from the nodes are those of the closed form, and depend on the age alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fmu_src.kernels.numerics.elementary import sincos_turns
from fmu_src.kernels.oscillator import memory as at
from fmu_src.kernels.oscillator import nodes

from .kernel import examples, flight, structures

AGES = st.lists(st.floats(0.0, 300.0), min_size=2, max_size=8)
STEEP = {"m2": 0.35, "k2": 0.468, "d1": 0.03, "d2": 0.9765, "box_frequency": 1.111}


def closed_form(m, age):
    """All phasors by elementary functions."""
    sine, cosine = sincos_turns(m[at.TURN] + m[at.ETA_TURNS] * age)
    x_a, v_a = nodes.free_part_after(m, at.OSCILLATOR_1, m[at.FREE_A], m[at.FREE_A + 1], age)
    x_b, v_b = nodes.free_part_after(m, at.OSCILLATOR_2, m[at.FREE_B], m[at.FREE_B + 1], age)
    return x_a, x_b, v_a, v_b, cosine, sine


@examples(60)
@given(structures() | st.just({**STEEP, "phase_start": 0.35}), AGES)
def test_they_are_those_of_the_closed_form(values, ages):
    m = flight(-0.9, 0.95, 0.7, 0.24, **values)
    size = max(1.0, *(abs(m[i]) for i in range(at.FREE_A, at.FREE_A + 4)))
    rate = m[at.RATE]
    for age in (0.45 * m[at.SPACING], 0.55 * m[at.SPACING], 0.999 * m[at.SPACING], *ages):
        found, expected = nodes.phasors_at(m, age), closed_form(m, age)
        for k in range(6):
            error = abs(found[k] - expected[k])
            if k >= 4:
                assert error <= 1e-15 * (8.0 + m[at.ETA] * age), k
            else:
                assert error <= 4e-15 * size * (rate if k >= 2 else 1.0) * (8.0 + rate * age), k


@examples(40)
@given(structures())
def test_what_a_quintic_misses_is_bounded_closely(values):
    """A sixth derivative that stays 1 is missed by s^3 (1 - s)^3 h^6/720, against b_2 and b_3."""
    m = flight(-0.9, 0.95, 0.7, 0.24, **values)
    s = np.linspace(0.01, 0.99, 99)
    missed = (s * (1.0 - s)) ** 3 * m[at.SPACING] ** 6 / 720.0
    lowered = 10.0 * s**2 * (1.0 - s) ** 3 + 10.0 * s**3 * (1.0 - s) ** 2
    assert m[at.HERMITE + 2] == pytest.approx((missed / lowered).max(), rel=1e-12, abs=0.0)
