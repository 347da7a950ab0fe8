"""Maxima and jumps of curves whose maxima and jumps are known."""

import numpy as np
import pytest

from orchestrate.response.turns_and_jumps import jump_indices, prominent_maxima

GRID = np.linspace(0.5, 1.5, 401)


def test_the_peak_of_a_linear_oscillator():
    damping = 0.02
    curve = 1.0 / np.hypot(1.0 - GRID**2, 2.0 * damping * GRID)
    exact = np.sqrt(1.0 - 2.0 * damping**2)
    assert GRID[prominent_maxima(curve, 0.1)] == pytest.approx([exact], abs=0.0013)


def test_ripples_are_no_peaks_and_zeros_do_no_harm():
    ripples = 1.0 + 0.04 * np.sin(80.0 * GRID)
    assert len(prominent_maxima(ripples, 0.1)) == 0 and len(prominent_maxima(ripples, 0.05)) > 10
    assert len(prominent_maxima(np.zeros(5), 0.1)) == 0


@pytest.mark.parametrize("size", [1, 2, 3])
def test_curves_of_few_values(size):
    assert len(prominent_maxima(np.ones(size), 0.1)) == len(jump_indices(np.ones(size), 0.1)) == 0


def test_a_jump_and_what_is_none():
    steep, jumping = np.exp(6.0 * GRID), np.where(GRID > 1.2, 0.6, 1.0) * GRID
    assert len(jump_indices(steep, 0.01)) == 0
    (at,) = jump_indices(jumping, 0.15)
    assert GRID[at] <= 1.2 < GRID[at + 1]
    irregular = np.random.default_rng(1).uniform(1.0, 1.5, 400)
    assert len(jump_indices(irregular, 0.15)) < 8
