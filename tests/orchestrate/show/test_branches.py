"""Branches and borders as pictures: what is solid, what is dashed, where the marks are."""

import functools

import numpy as np
import pytest
import xarray as xr

from orchestrate.dynamics.branches import branch
from orchestrate.model import Structure
from orchestrate.show.lines import draw_branch
from orchestrate.show.planes import draw_border, draw_map

from .made import mapped

PAPER = Structure.nondimensional()


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


def test_a_border_is_a_line_over_both_parameters_with_its_points():
    sides = {"eta": ("point", [2.7, 2.8, 2.9]), "e": ("point", [0.69, 0.7, 0.71])}
    kinds = {"flag_values": [0, 1], "flag_meanings": "cusp fold_flip"}
    made = {"codimension_two_kind": ("codimension_two", [1], kinds)}
    made |= {"codimension_two_eta": ("codimension_two", [2.8])}
    made |= {"codimension_two_e": ("codimension_two", [0.7])}
    attributes = {**PAPER.parameters(), "over": ["eta", "e"], "kind": "period doubling"}
    curve = xr.Dataset(made, sides, attributes)
    figure = draw_border(curve)
    line, point = figure.axes[0].get_lines()
    assert line.get_xdata() == pytest.approx([2.7, 2.8, 2.9])
    assert line.get_ydata() == pytest.approx([0.69, 0.7, 0.71])
    assert (point.get_xdata()[0], point.get_ydata()[0]) == (2.8, 0.7)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert words == ["period doubling", "fold flip"]
    figure = draw_map(mapped(False), overlay=[curve])
    marks = [plane.get_lines()[2] for plane in figure.axes if plane.get_lines()]
    assert len(marks) == 4 and len({round(plane.get_position().y0, 2) for plane in figure.axes}) > 1
    assert all(mark.get_xdata()[0] == 2.8 and mark.get_ydata()[0] == 0.7 for mark in marks)
