"""Branches over responses: at their place in the responses' units, and of the same question."""

import functools

import numpy as np
import pytest

from orchestrate.constants import GRAVITY
from orchestrate.dynamics.branches import branch
from orchestrate.model import Structure
from orchestrate.response.sweep import sweep
from orchestrate.show.plot import plot

PAPER = Structure.nondimensional()
BEAM = PAPER.replace(omega=75.0)
SHORT = {"transient": 20, "samples": 4, "progress": False}


@functools.cache
def window():
    return branch(PAPER, eta=2.5, limits=(2.4, 2.8), progress=False)


@functools.cache
def over(name):
    """A branch over another parameter, or of another structure."""
    if name == "beam":
        return branch(BEAM, eta=2.5, limits=(2.4, 2.8), progress=False)
    if name == "gap":
        gap = PAPER.replace(clearance=1e-3)
        return branch(gap, eta=2.5, limits=(2.45, 2.55), progress=False)
    limits = {"e": (0.65, 0.75), "amplitude": (0.1, 0.2)}[name]
    box = {"frequency": 2.5, "amplitude": 0.16} if name == "amplitude" else {"eta": 2.5}
    return branch(PAPER, over=name, **box, limits=limits, progress=False)


def blue(plane):
    """The line of stable orbits, or that of unstable ones where there is no stable one."""
    return next(line for line in plane.get_lines() if line.get_label() in ("stable", "unstable"))


def test_branches_lie_over_the_samples_of_a_sweep():
    responses = sweep(PAPER, eta=[2.45, 2.5, 2.55], **SHORT)
    top, _ = plot(responses, window()).axes
    assert blue(top).get_xdata() == pytest.approx(window().eta.values)
    stable = window().stable.values == 1
    assert blue(top).get_ydata()[stable] == pytest.approx(window().xi_rel.values[stable, 0])
    assert top.get_xlim() == (2.45, 2.55)
    marks = [line for line in top.get_lines() if line.get_markerfacecolor() == "white"]
    assert [float(mark.get_xdata()[0]) for mark in marks] == list(window().bifurcation_value)


def test_a_branch_is_in_hertz_and_metres_where_the_responses_are():
    """A settled response lies on its branch, whatever level the box is held at."""
    turns = 75.0 * np.linspace(2.45, 2.55, 21)
    level = {"amplitude": 0.02 * GRAVITY / turns**2}
    responses = sweep(BEAM, frequency=turns, **level, transient=3000, samples=1, progress=False)
    top, _ = plot(responses, over("beam")).axes
    metres = (responses.xi_rel[:, 0] * responses.amplitude * responses.eta**2).values
    line, unit = blue(top), {"nm": 1e-9, "µm": 1e-6}[top.get_ylabel().split()[5].strip(",")]
    there = np.interp(turns / (2.0 * np.pi), line.get_xdata(), line.get_ydata()) * unit
    assert there == pytest.approx(metres, rel=2e-3)
