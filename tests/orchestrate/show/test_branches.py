"""Branches and borders as pictures: what is solid, what is dashed, where the marks are."""

import functools

import numpy as np
import pytest

from orchestrate.constants import GRAVITY
from orchestrate.dynamics.branches import branch
from orchestrate.model import Structure
from orchestrate.response.sweep import sweep
from orchestrate.show.lines import draw_branch
from orchestrate.show.plot import plot

PAPER = Structure.nondimensional()
BEAM = PAPER.replace(omega=75.0)


@functools.cache
def window():
    return branch(PAPER, eta=2.5, limits=(2.4, 2.8))


def test_stable_is_solid_and_unstable_dashed():
    figure = draw_branch(window())
    lines = figure.axes[0].get_lines()
    solid = next(line for line in lines if line.get_linestyle() == "-")
    dashed = next(line for line in lines if line.get_linestyle() == "--")
    border_at = window().bifurcation_value.values[0]
    shown = np.isfinite(solid.get_ydata())
    assert (solid.get_xdata()[shown] < border_at).all()
    assert np.isfinite(dashed.get_ydata()).sum() > 3
    assert dashed.get_xdata()[np.isfinite(dashed.get_ydata())].max() == pytest.approx(2.8)


def test_a_branch_is_in_hertz_and_metres_where_the_responses_are():
    """A settled response lies on its branch, whatever level the box is held at."""
    turns = 75.0 * np.linspace(2.45, 2.55, 21)
    level = {"amplitude": 0.02 * GRAVITY / turns**2}
    branches = branch(BEAM, eta=2.5, limits=(2.4, 2.8), progress=False)
    responses = sweep(BEAM, frequency=turns, **level, transient=3000, samples=1, progress=False)
    top, _ = plot(responses, branches).axes
    metres = (responses.xi_rel[:, 0] * responses.amplitude * responses.eta**2).values
    line = next(one for one in top.get_lines() if one.get_label() == "stable")
    unit = {"nm": 1e-9, "µm": 1e-6}[top.get_ylabel().split()[5].strip(",")]
    there = np.interp(turns / (2.0 * np.pi), line.get_xdata(), line.get_ydata()) * unit
    assert there == pytest.approx(metres, rel=2e-3)
