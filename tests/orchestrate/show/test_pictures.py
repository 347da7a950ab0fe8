"""Each picture shows what its dataset holds, and leaves the user's matplotlib alone."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrate.constants import GRAVITY, TURN
from orchestrate.dynamics.branches import branch
from orchestrate.errors import StoreError
from orchestrate.model import Structure
from orchestrate.response.sweep import sweep
from orchestrate.show import lines, scales
from orchestrate.show.figure_files import save
from orchestrate.show.plot import plot
from orchestrate.show.style import XI_REL, make_panels

from . import made


def small_picture():
    """A small picture with letters, made anew."""
    return make_panels(1, 1, (2.0, 1.0), XI_REL)[0]


def test_the_same_figure_is_the_same_bytes(tmp_path):
    for name in ("one", "two"):
        save(small_picture(), tmp_path / name, ("png", "pdf", "svg"), dpi=30)
    for kind in ("png", "pdf", "svg"):
        assert (tmp_path / f"one.{kind}").read_bytes() == (tmp_path / f"two.{kind}").read_bytes()


def test_a_picture_is_written_whole_or_not_at_all(tmp_path):
    (tmp_path / "there.png").mkdir()
    with pytest.raises(StoreError, match=r"there\.png"):
        save(small_picture(), tmp_path / "there")
    assert [path.name for path in tmp_path.iterdir()] == ["there.png"]


def test_all_samples_are_in_an_orbit_diagram():
    for count in (40, 700):
        data = made.sweep(count)
        top = lines.draw_sweep(data).axes[0]
        marked = np.concatenate([line.get_xydata() for line in top.lines if len(line.get_xdata())])
        low, high = top.get_ylim()
        assert low < 0.0 < data.xi_rel.max() < high
        x = np.repeat(data.eta.values, data.sizes["sample"])
        points = np.column_stack([x, data.xi_rel.values.ravel()])
        places = [(top.transScale + top.transLimits).transform(xy) for xy in (points, marked)]
        cells = [(place * lines.CELLS).astype(int).tolist() for place in places]
        need, have = (set(map(tuple, each)) for each in cells)
        assert need <= have
        assert len(marked) <= len(points)


def test_a_structure_in_si_is_told_in_hertz_and_metres():
    for si in (False, True):
        data = made.sweep(si=si)
        top, bottom = lines.draw_sweep(data).axes
        assert (bottom.get_xlabel() == scales.FREQUENCIES["Hz"]) == si
        assert (top.get_ylabel() == "gap $x_2 - x_1$ in mm, at $t = nT$") == si
    expected = float((data.xi_rel * 1e-3 * data.eta**2).max()) / 1e-3
    assert max(line.get_ydata().max() for line in top.lines) == pytest.approx(expected)
    assert bottom.lines[0].get_xdata()[-1] == pytest.approx(1.3 * 75.0 / TURN)


BEAM = Structure.nondimensional().replace(omega=75.0)


def test_a_branch_is_in_hertz_and_metres_where_the_responses_are():
    """A settled response lies on its branch, whatever level the box is held at; what is stable is
    solid and ends at the bifurcation, what is not is dashed.
    """
    turns = 75.0 * np.linspace(2.45, 2.55, 21)
    level = {"amplitude": 0.02 * GRAVITY / turns**2}
    branches = branch(BEAM, eta=2.5, limits=(2.4, 2.8), progress=False)
    responses = sweep(BEAM, frequency=turns, **level, transient=3000, samples=1, progress=False)
    top, _ = plot(responses, branches).axes
    metres = (responses.xi_rel[:, 0] * responses.amplitude * responses.eta**2).values
    lines = {line.get_label(): line for line in reversed(top.get_lines())}
    solid, dashed = lines["stable"], lines["unstable"]
    unit = {"nm": 1e-9, "µm": 1e-6}[top.get_ylabel().split()[5].strip(",")]
    there = np.interp(turns / TURN, *solid.get_data()) * unit
    assert there == pytest.approx(metres, rel=2e-3)
    assert (solid.get_linestyle(), dashed.get_linestyle()) == ("-", "--")
    etas = [x[np.isfinite(y)] * TURN / 75.0 for x, y in (solid.get_data(), dashed.get_data())]
    assert etas[0].max() < branches.bifurcation_value[0] < etas[1].max() == pytest.approx(2.8)
    assert len(etas[1]) > 3
