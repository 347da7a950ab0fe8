"""Each picture shows what its dataset holds, and leaves the user's matplotlib alone."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.constants import GRAVITY
from orchestrate.errors import StoreError
from orchestrate.figures import (
    attractors,
    basin,
    labels,
    lyapunov,
    maps,
    motion,
    orbit_diagram,
    phase_curves,
    phase_grid,
    shaken,
    time_histories,
)
from orchestrate.figures.files import save
from orchestrate.units import with_units

from .drawing import sweep as small_sweep

PAPER = orchestrate.Structure.nondimensional()
QUICK = (orchestrate.Structure.from_file("quick"), orchestrate.Drive.from_file("quick"))
HERE = {"progress": False, "jobs": 1}


def drawn(axes) -> list[np.ndarray]:
    """Points of all lines of a panel."""
    return [line.get_xydata() for line in axes.lines if len(line.get_xydata())]


def texts(place) -> list[str]:
    """Texts of the legend of a panel, or of a figure."""
    legends = place.legends if hasattr(place, "legends") else [place.get_legend()]
    return [text.get_text() for legend in legends if legend for text in legend.get_texts()]


def test_our_pictures_leave_theirs_alone(tmp_path):
    root = Path(__file__).resolve().parents[3]
    command = [sys.executable, "-m", "tests.orchestrate.figures.drawing", str(tmp_path)]
    environment = {**os.environ, "MPLBACKEND": "agg"}
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    names = [f"{name}.{kind}" for name in ("orbit", "scheme", "shaker") for kind in ("png", "pdf")]
    assert all((tmp_path / name).stat().st_size > 1000 for name in names)


def test_the_same_figure_is_the_same_bytes(tmp_path):
    for name in ("one", "two"):
        save(orbit_diagram.draw(small_sweep()), tmp_path / name, ("png", "pdf", "svg"))
    for kind in ("png", "pdf", "svg"):
        assert (tmp_path / f"one.{kind}").read_bytes() == (tmp_path / f"two.{kind}").read_bytes()


def test_a_picture_is_written_whole_or_not_at_all(tmp_path):
    (tmp_path / "there.png").mkdir()
    with pytest.raises(StoreError, match=r"there\.png"):
        save(orbit_diagram.draw(small_sweep()), tmp_path / "there")
    assert [path.name for path in tmp_path.iterdir()] == ["there.png"]


def curves(panels: int) -> xr.Dataset:
    """Something that looks like the paper's curves."""
    count = 40
    tau = np.tile(np.linspace(0.0, 8.0 * np.pi, count), panels)
    state = np.stack([np.sin(tau), np.sin(tau) + 0.5, np.cos(tau), np.cos(tau)], axis=1)
    flags = {"flag_values": [0, 1, 2], "flag_meanings": "separate_motion a_sequence contact"}
    variables = {
        "tau": ("point", tau),
        "state": (("point", "coordinate"), state),
        "kind": ("point", np.arange(len(tau)) % 3, flags),
        "panel_of": ("point", np.repeat(np.arange(panels), count)),
        **{name: ("panel", np.full(panels, 0.5)) for name in ("e", "D", "eta")},
        "multiplicity": ("panel", np.arange(panels)),
    }
    return xr.Dataset(variables)


def test_curves():
    figure = phase_curves.draw_states(curves(1))
    left, _ = figure.axes
    assert texts(figure) == ["separate motion", "a sequence", "contact"]
    assert len(left.lines) == 6
    three = phase_curves.draw_masses(curves(3)).axes
    assert len(three) == 3 and three[0].get_xlim() == three[2].get_xlim()
    grid = phase_grid.draw(curves(6), columns=4).axes
    assert [axes.get_visible() for axes in grid] == [True] * 6 + [False] * 2
    assert grid[0].get_title(loc="left").endswith("not periodic")
    assert grid[2].get_title(loc="left").endswith("$2T$")
    *histories, excitation = time_histories.draw(curves(2)).axes
    assert len(histories) == 2
    assert np.abs(drawn(excitation)[0][:, 1]).max() == pytest.approx(1.0, abs=0.01)


def test_exponents(exported):
    asked = {"transient": 50, "periods": 300, **HERE}
    data = orchestrate.lyapunov(PAPER, eta=[0.8, 1.047], **asked)
    figure = lyapunov.draw(data)
    assert texts(figure) == ["chaotic", "neutral", "periodic"]
    assert figure.axes[0].get_title(loc="left") == "$e$ = 0.7, $D$ = 0.005"


def test_attractors_and_basins(exported):
    asked = {"transient": 60, "settle": 60.0, **HERE}
    found = orchestrate.attractors(PAPER, eta=[1.1, 1.315], starts=4, **asked)
    figure = attractors.draw(found)
    top, middle, bottom = figure.axes
    assert top.get_yscale() == "log" and len(bottom.lines) == 1
    assert middle.get_ylabel() == "share of random starts"
    assert "T, 1 impact" in texts(figure) and "irregular" in texts(figure)
    plane = {"x": ("x_rel", 0.0, 1.3, 4), "y": ("v_rel", -1.3, 1.3, 4)}
    data = orchestrate.basin(PAPER, eta=1.315, **plane, **asked)
    figure = basin.draw(data, "here", ("gap", ""))
    (axes,) = figure.axes
    assert axes.get_xlabel() == "gap" and axes.get_ylabel().endswith(" in m/s")
    assert len(texts(figure)) == data.sizes["attractor"] + 1 and "%" in texts(figure)[0]
    assert texts(figure)[-1] == "states on them"


def test_maps(exported):
    asked = {"transient": 30, "settle": 10.0, "samples": 8, **HERE}
    one = orchestrate.map(PAPER, eta=[0.9, 1.0, 1.1], D=[0.01, 0.02, 0.04], **asked)
    two = orchestrate.map(PAPER, eta=[0.9, 1.0, 1.1], e=[0.3, 0.5, 0.7], **asked)
    figure = maps.draw(one, two)
    planes = [axes for axes in figure.axes if axes.get_xlabel()]
    assert len(planes) == 8
    assert [plane.get_yscale() for plane in planes[::4]] == ["log", "linear"]
    assert planes[0].get_ylabel() == "$D$"


def test_names():
    assert labels.format_period(0) == "not periodic"
    assert [labels.format_period(n) for n in (1, 3)] == ["$T$", "$3T$"]
    assert labels.symbol("kappa") == r"$\kappa$" and labels.symbol("a_thing") == "a thing"
    assert labels.format_parameters({"e": 0.7, "omega": 75.0}) == r"$e$ = 0.7, $\omega$ = 75 rad/s"


def test_an_attractor_is_drawn_as_far_as_it_exists():
    """One attractor, T and then 2T, that ends; another one that appears beside it."""
    nan = np.nan
    over = ("eta", "attractor")
    n = np.array([[1.0, nan], [2.0, nan], [2.0, 0.0], [nan, 0.0]])
    data = xr.Dataset(
        {
            "number": ("eta", np.array([1, 1, 2, 1])),
            "multiplicity": (over, n),
            "impacts_per_period": (over, np.where(n == 2.0, 1.5, np.where(n > 0, 1.0, n + 1.3))),
            "xi_rel_max": (over, np.where(np.isnan(n), nan, [0.4, 2.0])),
            "share": (over, np.array([[1.0, 0.0], [1.0, 0.0], [0.3, 0.7], [0.0, 1.0]])),
        },
        {"eta": [1.0, 1.1, 1.2, 1.3]},
    )
    figure = attractors.draw(data)
    assert texts(figure) == ["T, 1 impact", "2T, 3 impacts", "irregular"]
    _, middle, _ = figure.axes
    shares = [line.get_ydata() for line in middle.lines if line.get_color() == "#c8c8c8"]
    np.testing.assert_array_equal(shares[0], [1.0, 1.0, 0.3, nan])  # not 0 where it is not there
    np.testing.assert_array_equal(shares[1], [nan, nan, 0.7, 1.0])


BEAM = orchestrate.Structure.from_halves(m1=1.5, m2=1.2, f1=42, f2=55, zeta1=0.007, zeta2=0.007)


def test_two_structures_have_one_unit_on_an_axis(exported):
    """The bonded one's spectrum was in m/s2 on an axis in g."""
    turn = 2.0 * np.pi * 50.0
    shaken = {"frequency": turn, "amplitude": 5.0 / turn**2, "transient": 50, "periods": 4}
    answers = [orchestrate.simulate(one, **shaken, **HERE) for one in (BEAM, BEAM.as_bonded())]
    tops = []
    for units in ("m/s2", "g"):
        figure = motion.draw(with_units(answers[0], units), bonded=answers[1])
        (panel,) = (one for one in figure.axes if one.get_ylabel().startswith("acceleration"))
        assert panel.get_ylabel().endswith({"m/s2": "in m/s$^2$", "g": "in g"}[units])
        stems = [each.get_segments() for each in panel.collections]
        tops.append([max(top for (_, _), (_, top) in lines) for lines in stems if len(lines)])
    assert len(tops[0]) == 3
    assert np.allclose(tops[0], GRAVITY * np.array(tops[1]))


def test_titles_have_the_level_in_the_unit_asked_for(exported):
    turn = 2.0 * np.pi * 50.0
    shaken = {"frequency": turn, "amplitude": 0.5 * GRAVITY / turn**2}
    data = orchestrate.simulate(BEAM, **shaken, periods=1, **HERE)
    assert r"$a\,\Omega^2$ = 0.5 g" in labels.title_from_attributes(with_units(data, "g"))
    assert "$a$ = 0.04968 mm" in labels.title_from_attributes(with_units(data, "mm"))
    turns = list(np.array([45.0, 50.0]) * 2.0 * np.pi)
    data = orchestrate.map(BEAM, frequency=turns, level=0.5 * GRAVITY, e=[0.4, 0.5], **HERE)
    figure = maps.draw(with_units(data, "Hz, mm, g"))
    assert r"$a\,\Omega^2$ = 0.5 g" in figure.get_suptitle()
    titled = {one.get_title(loc="left"): one for one in figure.axes}
    panel = titled["largest gap $x_2 - x_1$ in mm"]
    lengths = data.xi_rel_max * 0.5e3 * GRAVITY / BEAM.omega**2
    shown = panel.collections[0].get_array()
    assert np.allclose(np.sort(np.ravel(shown)), np.sort(lengths.values.ravel()))


def test_a_basin_says_its_frequency_once_and_gaps_as_asked(exported):
    plane = {"x": ("x_rel", 0.1, 0.2, 2), "y": ("v_rel", 0.0, 0.1, 2)}
    data = orchestrate.basin(PAPER, eta=1.7, **plane, **HERE)
    for units in ("", "eta"):
        figure = basin.draw(with_units(data, units))
        title = figure.get_suptitle() + figure.axes[0].get_title(loc="left")
        assert title.count(r"\eta") == 1
    (legend,) = basin.draw(with_units(data, "mm")).legends
    gap = 1e3 * float(data.xi_rel_max[0])
    assert any(f"largest gap = {gap:.4g} mm" in text.get_text() for text in legend.get_texts())


def test_what_shook_the_box_is_said_in_the_unit_asked_for(exported):
    shock = orchestrate.Shock(peak=5.0 * GRAVITY, length=0.011)
    data = orchestrate.shake(BEAM, shock, progress=False)
    assert shaken.draw(with_units(data, "g")).get_suptitle().startswith("half-sine shock, 5 g for")
    assert "49.03 m/s$^2$" in shaken.draw(data).get_suptitle()


@pytest.mark.parametrize("spacing", ["swept", "stepped"])
def test_the_level_of_a_sine_is_in_the_title(spacing):
    level = 0.02 * GRAVITY
    sine = orchestrate.SweptSine(first=9.0, last=16.0, acceleration=level, duration=60.0)
    if spacing == "stepped":
        sine = orchestrate.SteppedSine(frequencies=(9.0, 16.0), acceleration=level)
    told = {"excitation": sine.label, "excitation_description": sine.description}
    title = shaken.shaken_title(with_units(xr.Dataset(attrs=told), "g"))
    assert title.startswith(f"{sine.label} at 0.02 g; ") and "m/s2" not in sine.label
