"""Branches and borders as pictures: what is solid, what is dashed, where the marks are."""

import functools

import numpy as np
import pytest
import xarray as xr

from orchestrate.dynamics.borders import border
from orchestrate.dynamics.branches import branch
from orchestrate.figures import borders, branches, held_excitation, scales
from orchestrate.structures import Structure
from orchestrate.units import with_units

PAPER = Structure.nondimensional()


@functools.cache
def window():
    return branch(PAPER, eta=2.5, limits=(2.4, 2.8))


def test_stable_is_solid_and_unstable_dashed():
    figure = branches.draw(window())
    lines = figure.axes[0].get_lines()
    solid = next(line for line in lines if line.get_linestyle() == "-")
    dashed = next(line for line in lines if line.get_linestyle() == "--")
    border_at = window().bifurcation_value.values[0]
    shown = np.isfinite(solid.get_ydata())
    assert (solid.get_xdata()[shown] < border_at).all()
    assert np.isfinite(dashed.get_ydata()).sum() > 3
    assert dashed.get_xdata()[np.isfinite(dashed.get_ydata())].max() == pytest.approx(2.8)


def test_a_branch_of_a_structure_in_si_is_drawn_in_hertz():
    told = {**window().attrs, "over": "frequency", "m1": 2.0, "m2": 2.0}
    figure = branches.draw(window().assign_attrs(told))
    solid = figure.axes[0].get_lines()[0]
    assert solid.get_xdata() == pytest.approx(window().frequency.values / (2.0 * np.pi))
    assert figure.axes[0].get_xlabel() == scales.FREQUENCIES["Hz"]


def test_bifurcations_are_marked_each_kind_once_in_the_legend():
    figure = branches.draw(window(), window())
    (plane,) = figure.axes
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert sorted(words) == ["Neimark-Sacker", "period doubling", "stable", "unstable"]
    marks = [line for line in plane.get_lines() if line.get_markerfacecolor() == "white"]
    assert {float(mark.get_xdata()[0]) for mark in marks} == set(window().bifurcation_value.values)


def test_a_border_is_a_line_over_both_parameters():
    curve = border(PAPER, start=window(), bifurcation=1, limits=[(2.7, 2.9), (0.69, 0.71)])
    figure = borders.draw(curve)
    (line,) = figure.axes[0].get_lines()
    assert line.get_xdata() == pytest.approx(curve.eta.values)
    assert line.get_ydata() == pytest.approx(curve.e.values)


def test_gaps_of_a_branch_are_lengths_where_they_are_asked_for(exported):
    beam = Structure.from_halves(m1=1, m2=1, f1=42, f2=55, zeta1=0.007, zeta2=0.007)
    ends = (50.0 * 2.0 * np.pi, 52.0 * 2.0 * np.pi)
    found = branch(beam, over="frequency", limits=ends, amplitude=5e-5, progress=False, jobs=1)
    (plane,) = branches.draw(with_units(found, "Hz, mm")).axes
    assert plane.get_ylabel() == "gap $x_2 - x_1$ in mm, at $t = nT$"
    lengths = 1e3 * (found.xi_rel * found.amplitude * found.eta**2).values
    drawn = np.concatenate([np.ravel(line.get_ydata()) for line in plane.lines])
    assert np.nanmax(drawn) == pytest.approx(lengths.max())


def test_the_title_of_a_branch_has_what_is_held_of_the_box(exported):
    beam = {"m1": 1.5, "m2": 1.4, "k1": 8437.5, "k2": 9450.0, "d1": 1.125, "d2": 1.95, "e": 0.7}
    omega = np.sqrt(beam["k1"] / beam["m1"])
    frequency = np.array([80.0, 81.0, 82.0])

    def titled(over, frequency, amplitude, units=""):
        points = {"frequency": frequency, "eta": frequency / omega, "amplitude": amplitude}
        columns = {name: ("point", values * np.ones(3)) for name, values in points.items()}
        data = xr.Dataset(coords=columns, attrs=beam)
        return held_excitation.branch_title(with_units(data, units), [over])

    assert titled("frequency", frequency, 3e-5, "Hz, mm").endswith("$a$ = 0.03 mm")
    level = titled("frequency", frequency, 0.2 / frequency**2, "Hz, mm, g")
    assert level.endswith(r"$a\,\Omega^2$ = 0.0204 g") and r"\Omega/2\pi" not in level
    both = titled("e", 80.0 * np.ones(3), 3e-5, "Hz, mm")
    assert both.endswith(r"$\Omega/2\pi$ = 12.732 Hz, $a$ = 0.03 mm") and "$e$" not in both
    assert branches.draw(window()).get_suptitle() == "$e$ = 0.7, $D$ = 0.005"
    in_si = window().assign_attrs({**window().attrs, "over": "frequency", "m1": 2.0, "m2": 2.0})
    assert branches.draw(in_si).get_suptitle().endswith(r"$a\,\Omega^2$ = 1 m/s$^2$ (0.102 g)")
