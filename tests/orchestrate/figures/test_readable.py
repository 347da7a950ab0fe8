"""Pictures that people can read: all is drawn, told with its unit, and covered by nothing."""

from __future__ import annotations

import functools
import itertools
import json

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb

from orchestrate.figures import (
    analysis,
    attractors,
    basin,
    labels,
    lyapunov,
    manifold,
    maps,
    marks,
    motion,
    orbit_diagram,
    resonance,
    resonance_levels,
    scales,
    spectra,
    style,
)
from orchestrate.structures import Structure

BEAM = {"m1": 1.5, "m2": 1.4, "k1": 8437.5, "k2": 9450.0, "d1": 1.125, "d2": 1.95}
PAPER = {"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.2, "d1": 0.01, "d2": 0.01}
RANDOM = np.random.default_rng(1)


def known(si: bool) -> dict:
    """Attributes of a dataset."""
    gamma = 2e-4 if si else 1e-4
    return {**(BEAM if si else PAPER), "e": 0.7, "gamma": gamma, "bonded": 0}


def along(count: int, si: bool) -> dict:
    """A frequency axis, as questions give it."""
    eta = np.linspace(0.9, 1.3, count)
    name, omega = ("frequency", 75.0) if si else ("eta", 1.0)
    amplitude = np.full(count, 1e-3) if si else 1.0 / eta**2
    values = {"eta": eta, "frequency": omega * eta, "amplitude": amplitude}
    return {key: (name, column) for key, column in values.items()}


def sweep(count: int = 40, si: bool = False, both: bool = False, samples: int = 8) -> xr.Dataset:
    """Samples over twelve decades, zeros among them."""
    name = "frequency" if si else "eta"
    gap = 10.0 ** RANDOM.uniform(-11, 1, (2, count, samples))
    gap[:, ::3, 0] = 0.0
    found = xr.Dataset(
        {
            "xi_rel": (("direction", name, "sample"), gap),
            "impacts_per_period": (("direction", name), 1.0 + (gap[..., 1] > 1e-3)),
        },
        {**along(count, si), "sample": np.arange(501, 501 + samples), "direction": ["up", "down"]},
        known(si),
    )
    return found if both else found.sel(direction="up", drop=True)


def exponents(si: bool) -> xr.Dataset:
    """Exponents of all verdicts, some far below zero."""
    name, count = "frequency" if si else "eta", 30
    flags = {"flag_values": [-1, 0, 1], "flag_meanings": "periodic neutral chaotic"}
    found = {
        "exponent": (name, np.linspace(-0.5, 0.2, count)),
        "standard_error": (name, np.full(count, 0.01)),
        "verdict": (name, np.arange(count) % 3 - 1, flags),
    }
    return xr.Dataset(found, along(count, si), known(si))


def coexisting(si: bool) -> xr.Dataset:
    """Two attractors at each frequency."""
    name, count = "frequency" if si else "eta", 20
    over = (name, "attractor")
    found = {
        "number": (name, np.full(count, 2)),
        "share": (over, np.tile([0.9, 0.1], (count, 1))),
        "multiplicity": (over, np.tile([1.0, 0.0], (count, 1))),
        "impacts_per_period": (over, np.tile([2.0, 1.4], (count, 1))),
        "xi_rel_max": (over, RANDOM.uniform(0.1, 9.0, (count, 2))),
    }
    return xr.Dataset(found, along(count, si), known(si))


def plane(si: bool) -> xr.Dataset:
    """More attractors than there are colours, and starts that settle on none."""
    kinds = np.arange(-1, 7).repeat(2).reshape(4, 4)
    over = "attractor"
    found = {
        "attractor_of": (("v_rel", "x_rel"), kinds),
        "share": (over, np.full(7, 1 / 8)),
        **{name: (over, np.ones(7)) for name in ("multiplicity", "xi_rel_max")},
        "impacts_per_period": (over, np.ones(7)),
    }
    sides = {"x_rel": np.arange(4.0), "v_rel": np.arange(4.0), "eta": 1.3}
    return xr.Dataset(found, sides, known(si))


def curves(si: bool) -> xr.Dataset:
    """Resonance curves of both structures in both directions."""
    name, count = "frequency" if si else "eta", 60
    over = ("structure", "direction", name)
    peak = 1e-2 / (0.01 + np.abs(np.linspace(0.9, 1.3, count) - 1.05))
    shape = peak * np.array([[[1.0], [1.1]], [[1.2], [1.2]]])
    found = dict.fromkeys(("x1_max", "x2_max", "a1_max", "a2_max"), (over, shape))
    found["x_rel_max"] = (over, shape * np.array([1.0, 0.0])[:, None, None])
    names = {"structure": ["delaminated", "bonded"], "direction": ["up", "down"]}
    told = {f"peak_{key}": ("peak", [0.9, 1.1]) for key in found}
    told |= {f"{what}_{name}": (what, [75.0, 80.0]) for what in ("peak", "jump")}
    told |= {"peak_structure": ("peak", ["delaminated", "bonded"])}
    told |= {"jump_before": ("jump", [0.4, 0.1]), "jump_after": ("jump", [0.1, 0.4])}
    told |= {"jump_direction": ("jump", ["up", "down"])}
    return xr.Dataset(found | told, {**along(count, si), **names}, known(si))


def lines(si: bool) -> xr.Dataset:
    """Spectra of three kinds, the first line of all at one place."""
    name = "frequency" if si else "eta"
    acceleration = np.full((2, 3, 2, 81), 1e-9)
    acceleration[..., 2] = 5.0
    acceleration[:, 1:, :, 4::2] = 0.1
    kinds = ["bonded", "delaminated", "sampled"]
    names = {"kind": kinds, "mass": [1, 2], "order": np.arange(81) / 2}
    found = {"acceleration": ((name, "kind", "mass", "order"), acceleration)}
    return xr.Dataset(found, {**along(2, si), **names}, known(si))


def moving(si: bool, impacts: int = 8) -> xr.Dataset:
    """A motion over eight periods."""
    turns = np.linspace(0.0, 8.0, 801)
    time = turns * (0.08 if si else 6.0)
    wave = 1e-3 * np.sin(2.0 * np.pi * turns)
    names = ("x1", "x2", "v1", "v2", "x_rel", "v_rel")
    found = dict.fromkeys(names, ("time", wave))
    found |= {"v_rel": ("time", wave), "contact_force": ("time", 0.0 * wave)}
    at = time[1] + np.arange(impacts) * (time[-1] / 9.0)
    found |= {"impact_time": ("impact", at), "impact_velocity": ("impact", 0.0 * at + 2.0)}
    found["sticks"] = ("impact", np.arange(impacts) % 2)
    return xr.Dataset(found, {"time": time, "periods_done": ("time", turns)}, known(si))


def mapped(si: bool) -> xr.Dataset:
    """A map with frequencies without impacts."""
    values = RANDOM.uniform(0.5, 20.0, (5, 6))
    found = {
        "impacts_per_period": (("e", "eta"), np.where(values > 15.0, 0.0, values)),
        "multiplicity": (("e", "eta"), values.round() % 10),
        "xi_rel_max": (("e", "eta"), values),
        "exponent": (("e", "eta"), values - 10.0),
    }
    sides = {"e": np.linspace(0.1, 0.9, 5), "eta": np.linspace(0.5, 2.0, 6)}
    return xr.Dataset(found, sides, {**known(si), "e": "0.1 ... 0.9"})


def tracked(size: float = 1.0) -> xr.Dataset:
    """Orders of a swept sine; beside large ones a small record is visible at its start alone."""
    hertz = np.linspace(9.0, 16.0, 60)
    amplitude = size * np.ones((1, 2, 1)) * np.where(hertz < 9.2, 3e-3 / size, 1.0)
    variables = {
        "amplitude": (("channel", "order", "time"), amplitude, {"units": "m/s2"}),
        "phase": (("channel", "order", "time"), 0.0 * amplitude, {"units": "rad"}),
        "sweep_rate": ("time", np.ones(60)),
    }
    sides = {"channel": ["acceleration1"], "order": [1.0, 2.0], "time": np.arange(60.0)}
    sides["frequency"] = ("time", hertz, {"units": "Hz"})
    structure = Structure.from_halves(m1=1.5, m2=1.2, f1=11.9, f2=13.5, zeta1=0.005, zeta2=0.01)
    title = f"Orders: Shaken by swept sine 9 to 16 Hz in 100 s: {structure.label()}"
    return xr.Dataset(variables, sides, {"analysis": "orders", "title": title})


PICTURES = {
    "orbit": lambda si: orbit_diagram.draw(sweep(si=si)),
    "both ways": lambda si: orbit_diagram.draw(sweep(700, si, both=True)),
    "exponents": lambda si: lyapunov.draw(exponents(si)),
    "attractors": lambda si: attractors.draw(coexisting(si)),
    "basin": lambda si: basin.draw(plane(si)),
    "resonance": lambda si: resonance.draw(curves(si)),
    "spectra": lambda si: spectra.draw(lines(si)),
    "motion": lambda si: motion.draw(moving(si)),
    "map": lambda si: maps.draw(mapped(si)),
    "levels": lambda si: resonance_levels.draw(levels(si)),
    "orders": lambda si: analysis.draw(tracked(), "delaminated", {"bonded": tracked(1e-7)}),
}


@functools.cache
def picture(name: str):
    """One of them, in SI."""
    return rendered(PICTURES[name](True))


def rendered(figure):
    """A figure that knows where everything is."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return figure, canvas.get_renderer()


def words(figure, renderer) -> dict[str, object]:
    """Boxes of all titles and names of axes."""
    found = [*figure.texts, *([figure._suptitle] if figure._suptitle else [])]
    for axes in figure.axes:
        found += [axes.xaxis.label, axes.yaxis.label, axes._left_title, *axes.texts]
    return {
        text.get_text(): text.get_window_extent(renderer)
        for text in found
        if text.get_text() and text.get_visible()
    }


@pytest.mark.parametrize("name", PICTURES)
def test_nothing_is_cut_off_or_covered(name):
    figure, renderer = picture(name)
    texts = words(figure, renderer)
    for text, box in texts.items():
        assert box.x0 >= 0 and box.y0 >= 0, text
        assert box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1, text
    legends = [*figure.legends, *(a.get_legend() for a in figure.axes if a.get_legend())]
    for legend in legends:
        box = legend.get_window_extent(renderer)
        assert box.x0 >= 0 and box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1
        inside = [axes.bbox.padded(-1).overlaps(box) for axes in figure.axes]
        assert not any(inside), "covers data"
        assert [text for text, other in texts.items() if other.padded(-1).overlaps(box)] == []


def words_on_lines(figure, renderer) -> list[str]:
    """Words inside of panels that a line runs through, or a mark lies on."""
    found = []
    for axes in figure.axes:
        texts = [text for text in axes.texts if text.get_text() and text.get_visible()]
        for text, line in itertools.product(texts, axes.lines):
            box, path = text.get_window_extent(renderer), line.get_transform()
            path = path.transform_path(line.get_path())
            bare = line.get_linestyle() == "None"
            inside = [box.contains(*point) for point in path.vertices]
            if len(path.vertices) and (any(inside) if bare else path.intersects_bbox(box, False)):
                found.append(text.get_text())
    return found


@pytest.mark.parametrize("name", PICTURES)
def test_no_words_lie_on_a_line(name):
    assert words_on_lines(*picture(name)) == []


def colliding_numbers(figure, renderer) -> list[tuple[str, str]]:
    """Numbers along one axis that lie on each other."""
    found = []
    for axis in (side for axes in figure.axes for side in (axes.xaxis, axes.yaxis)):
        low, high = sorted(axis.get_view_interval())
        ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
        inside = [t.label1 for t in ticks if low <= t.get_loc() <= high and t.label1.get_visible()]
        boxes = [(t.get_text(), t.get_window_extent(renderer)) for t in inside if t.get_text()]
        pairs = itertools.combinations(boxes, 2)
        found += [(a, b) for (a, one), (b, other) in pairs if one.overlaps(other)]
    return found


def levels(si: bool) -> xr.Dataset:
    """Accelerations over one and a half decades, as resonance_levels gives them."""
    hertz = np.linspace(30.0, 60.0, 40)
    size = 2.0 + 60.0 / (1.0 + (hertz - 45.0) ** 2)
    over = ("level", "structure", "direction", "frequency")
    level = 9.80665 * np.array([0.3, 0.7, 1.1])
    shape = level[:, None, None, None] * size * np.ones((3, 2, 2, 40))
    variables = dict.fromkeys(("a1_max", "a2_max", "x_rel_max"), (over, shape))
    names = {"structure": ["delaminated", "bonded"], "direction": ["up", "down"], "level": level}
    sides = {"frequency": 2.0 * np.pi * hertz, "hertz": ("frequency", hertz)}
    threshold = ("frequency", level[0] * 30.0 / size, {"event": "opens"})
    variables["threshold_acceleration"] = threshold
    return xr.Dataset(variables, {**sides, **names}, {**known(si), "clearance": -2e-5})


@pytest.mark.parametrize("name", PICTURES)
def test_numbers_of_an_axis_lie_apart(name):
    assert colliding_numbers(*picture(name)) == []


@pytest.mark.parametrize("name", [name for name in PICTURES if name != "orders"])
def test_every_axis_is_named_and_every_picture_says_what_it_shows(name):
    figure, renderer = picture(name)
    for axes in figure.axes:
        shown = axes.xaxis.get_ticklabels() and axes.xaxis.get_tick_params().get("labelbottom")
        if axes.get_label() != "<colorbar>" and shown:
            assert axes.get_xlabel(), axes
    texts = " ".join(words(figure, renderer))
    assert "$f_1$ = 11.94 Hz" in texts  # not the usual scale, so it is told
    assert r"\zeta_2" in texts and r"$\mu$" in texts and r"$\gamma$" in texts
    if name not in ("basin", "map", "motion"):
        assert " in Hz" in texts


def test_all_samples_are_in_an_orbit_diagram():
    for count in (40, 700):
        data = sweep(count)
        figure, _ = rendered(orbit_diagram.draw(data))
        top = figure.axes[0]
        marked = np.concatenate([line.get_xydata() for line in top.lines if len(line.get_xdata())])
        low, high = top.get_ylim()
        assert low < 0.0 < data.xi_rel.max() < high
        place = top.transLimits.transform(top.transScale.transform(marked))
        x = np.repeat(data.eta.values, data.sizes["sample"])
        points = np.column_stack([x, data.xi_rel.values.ravel()])
        wanted = top.transLimits.transform(top.transScale.transform(points))
        have = set(map(tuple, (place * marks.CELLS).astype(int).tolist()))
        need = set(map(tuple, (wanted * marks.CELLS).astype(int).tolist()))
        assert need <= have
        assert len(marked) <= len(points)


def test_what_a_logarithm_has_no_place_for_is_told():
    figure = orbit_diagram.draw(sweep())
    assert figure.axes[0].get_yscale() == "symlog"
    assert "linear" in [text.get_text() for text in figure.axes[0].texts]
    data = sweep()
    data.xi_rel[:] = data.xi_rel * 0.0 + 0.5
    assert orbit_diagram.draw(data).axes[0].get_yscale() == "log"
    data.xi_rel[:] = 0.0
    data.impacts_per_period[:] = 0.0
    bottom = orbit_diagram.draw(data).axes[1]
    assert [text.get_text() for text in bottom.texts] == ["no impacts"]


def test_marks_grow_where_they_are_few():
    sizes = [
        marks.marker_keywords(count, marks.MarkStyle("k"))["markersize"] for count in (20, 151, 600)
    ]
    assert sizes == sorted(sizes, reverse=True) and sizes[1] > 2.0
    assert marks.marker_keywords(601, marks.MarkStyle("k"))["marker"] == ","


@pytest.mark.parametrize("count", [40, 700])
def test_down_does_not_hide_up(count):
    top, bottom = orbit_diagram.draw(sweep(count, both=True)).axes
    up, down = (
        [line for line in top.lines if line.get_color() == c] for c in (style.BLUE, style.RED)
    )
    assert up and down and top.lines.index(up[0]) < top.lines.index(down[0])
    if count < marks.MAX_DISTINCT:
        assert up[0].get_markersize() > down[0].get_markersize()
        assert up[0].get_markerfacecolor() == "none"
    else:
        assert up[0].get_markersize() > 1.0 and down[0].get_marker() == ","
    wide, thin = (line for line in bottom.lines if line.get_drawstyle() == "steps-mid")
    assert wide.get_linewidth() > 2.0 * thin.get_linewidth()


def test_both_sides_of_a_line_are_visible():
    figure, _ = rendered(spectra.draw(lines(False)))
    left, right = figure.axes[:2]
    assert left.get_ylim() == right.get_ylim()
    assert [stems.get_label() for stems in left.collections] == ["bonded"]
    wide, thin = right.collections
    assert wide.get_linewidth() > 2.0 * thin.get_linewidth()
    (first, *_) = wide.get_segments()  # a stem: it stands on the axis, at one frequency
    assert first[0, 0] == first[1, 0] == 1.0 and first[0, 1] == left.get_ylim()[0]
    legend = figure.legends[0]
    assert legend.get_title().get_text().endswith("of the largest line is left out")


def test_a_structure_in_si_is_told_in_hertz_and_metres():
    for si in (False, True):
        top, bottom = orbit_diagram.draw(sweep(si=si)).axes
        assert (bottom.get_xlabel() == scales.FREQUENCIES["Hz"]) == si
        assert (top.get_ylabel() == "gap $x_2 - x_1$ in mm, at $t = nT$") == si
    data = sweep(si=True)
    expected = float((data.xi_rel * 1e-3 * data.eta**2).max()) / 1e-3
    drawn = max(line.get_ydata().max() for line in orbit_diagram.draw(data).axes[0].lines)
    assert drawn == pytest.approx(expected)
    axis = orbit_diagram.draw(data).axes[1].lines[0].get_xdata()
    assert axis[-1] == pytest.approx(1.3 * 75.0 / (2.0 * np.pi))


def test_resonance_has_all_curves_and_their_peaks():
    data = curves(True)
    figure = resonance.draw(data)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        *(f"{structure}, {way}" for structure in resonance.COLOURS for way in ("up", "down")),
        *("jump up", "jump down"),
    ]
    first, *_, gap = figure.axes
    told = [text.get_text() for text in first.texts]
    assert [words.partition(":")[0] for words in told] == ["delaminated", "bonded"]
    assert told[0] == f"delaminated: {float(data.x1_max[0].max()):.4g} m at 12.523 Hz"
    assert len([line for line in first.lines if line.get_marker() == "v"]) == 2
    assert gap.get_title("left") == "jump up at 11.937 Hz; jump down at 12.732 Hz"  # 75, 80 rad/s
    assert [line.get_color() for line in gap.lines].count(style.BLUE) == 1  # glued: no gap
    labelled = [bool(plane.get_xlabel()) for plane in figure.axes]
    assert labelled == [False, False, True, True, True]  # two widths, each with its numbers
    assert all(plane.xaxis.get_tick_params()["labelbottom"] for plane in figure.axes[2:])
    noisy = resonance.draw(data.assign(peak_irregular=("peak", [1, 0])))  # chance has no triangle
    assert len([line for line in noisy.axes[0].lines if line.get_marker() == "v"]) == 1
    alone = curves(True).sel(structure="delaminated", direction="up", drop=True)
    assert len(resonance.draw(alone).axes[0].texts) == 1


def test_a_motion():
    figure = motion.draw(moving(True))
    named = {axes.get_ylabel(): axes for axes in figure.axes}
    gap, rate = named["gap velocity in mm/s"].lines[0].get_data()
    at_impacts = sorted(rate[(gap == 0.0) & (np.abs(rate) > 1.0)])
    assert at_impacts == pytest.approx([-2e3] * 8 + [1.4e3] * 4)  # every second sticks
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert words == ["no permanent contact"]
    beside = motion.draw(moving(True), bonded=moving(True, impacts=0)).axes
    assert [len(axes.lines) for axes in beside] == [3, 3, 2, 1, 0, 0]
    assert len(beside[-1].collections) == 3  # stems of both masses and of the bonded structure
    quiet = motion.draw(moving(True, impacts=0))
    legends = [axes.get_legend() for axes in quiet.axes if axes.get_legend()]
    assert "no impacts" in [text.get_text() for legend in legends for text in legend.get_texts()]


def test_a_motions_spectrum_has_its_amplitude():
    time = np.arange(1, 1601) / 200.0
    frequency, amplitude = motion.acceleration_spectrum(
        3.0 * np.sin(2.0 * np.pi * 5.0 * time), 1.0 / 200.0
    )
    assert amplitude.max() == pytest.approx(3.0 * (10.0 * np.pi) ** 2)
    assert frequency[amplitude.argmax()] == pytest.approx(5.0)


def test_exponents_beyond_the_axis_are_marked():
    figure = lyapunov.draw(exponents(False))
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "periodic, below -0.1" in texts
    assert figure.legends[0].get_title().get_text() == "bars: one standard error"
    below = [line for line in figure.axes[0].lines if line.get_marker() == "v"]
    assert len(below[0].get_xdata()) == int((exponents(False).exponent < -0.1).sum())


def test_a_map_says_where_there_is_none():
    figure = maps.draw(mapped(False))
    bars = [axes for axes in figure.axes if axes.get_label() == "<colorbar>"]
    assert bars[0].get_xlabel() == "grey: none" and bars[2].get_xlabel() == ""
    figure.canvas.draw()
    first, second = (axes for axes in figure.axes[:2])
    assert first.get_position().width == pytest.approx(second.get_position().width)
    assert bars[0].get_position().x1 < second.get_position().x0  # a long title pushes none away


def test_a_basin_names_all_that_is_in_it():
    texts = [text.get_text() for text in basin.draw(plane(False)).legends[0].get_texts()]
    assert len(texts) == len(basin.COLOURS) + 2
    assert texts[-2:] == ["25.0%: 2 others", "no states: the gap would be below 0"]


def test_titles_tell_what_is_not_usual():
    data = xr.Dataset(attrs={**PAPER, "e": 0.3, "gamma": 1e-4, "bonded": 1})
    assert labels.title_from_attributes(data) == "$e$ = 0.3, $D$ = 0.005, bonded"
    data.attrs |= {"d2": 0.1, "gamma": 1e-3, "k2": 2.0}
    told = r"$e$ = 0.3, $D_1$ = 0.005, $D_2$ = 0.05, $\kappa$ = 2, $\gamma$ = 0.001"
    assert labels.title_from_attributes(data.assign_attrs(bonded=0)) == told
    swept = data.assign_attrs(bonded=0).assign_coords(D=[0.1, 0.2])
    assert labels.title_from_attributes(swept) == r"$e$ = 0.3, $\kappa$ = 2, $\gamma$ = 0.001"
    assert labels.title_from_attributes(xr.Dataset()) == ""
    shaken = data.assign_attrs(frequency=20.0 * np.pi, amplitude=2.5e-5)
    assert labels.title_from_attributes(shaken).endswith(r"$\Omega/2\pi$ = 10 Hz, $a$ = 25 µm")
    held = sweep(si=True).assign_coords(amplitude=lambda data: 3.0 / data.frequency**2)
    assert labels.title_from_attributes(held).endswith(r"$a\,\Omega^2$ = 3 m/s$^2$ (0.306 g)")


def test_titles_of_a_real_beam_tell_hertz_and_per_cent():
    halves = {"f1": 42.0, "f2": 55.0, "zeta1": 0.007, "zeta2": 0.007}
    beam = Structure.from_halves(m1=1.5, m2=1.2, **halves)
    data = xr.Dataset(attrs=beam.parameters())
    told = r"$f_1$ = 42 Hz, $f_2$ = 55 Hz, $\zeta_1$ = 0.7 %, $\zeta_2$ = 0.7 %, $\mu$ = 0.8"
    assert labels.title_from_attributes(data) == f"{told}, $e$ = 0.7"
    swept = data.assign_coords(kappa=[1.0, 2.0])  # what varies is no half's
    assert r"\zeta" not in labels.title_from_attributes(
        swept
    ) and "$D_1$ = 0.007" in labels.title_from_attributes(swept)


DEUTERAN = np.array([[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]])
PROTAN = np.array([[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]])


@pytest.mark.parametrize("seen", [np.eye(3), DEUTERAN, PROTAN], ids=["all", "deuteran", "protan"])
def test_colours_are_told_apart_by_everyone(seen):
    """Machado, Oliveira and Fernandes (2009): what people see who lack a cone, in linear RGB."""
    used = (style.BLACK, style.BLUE, style.RED, style.GREEN, style.ORANGE)
    linear = [seen @ np.array(to_rgb(colour)) ** 2.2 for colour in used]
    light = [np.clip(rgb, 0.0, 1.0) ** (1 / 2.2) for rgb in linear]
    for one, other in itertools.combinations(light, 2):
        assert np.linalg.norm(one - other) > 0.2, json.dumps([one.tolist(), other.tolist()])


HALVES = {"m1": 1.5, "m2": 1.2, "f1": 42.0, "f2": 55.0, "zeta1": 0.007, "zeta2": 0.01}


@pytest.mark.parametrize(
    "structure",
    [
        Structure(),
        Structure.from_halves(**HALVES, e=0.6, clearance=-2e-5),
        Structure.nondimensional(mu=0.5, D1=0.01, D2=0.02, gamma=1e-5),
        Structure.from_halves(**HALVES).as_bonded(),
    ],
    ids=lambda structure: structure.label(),
)
def test_titles_have_no_names_of_files(structure):
    """Titles of stored results end with the short name of a structure."""
    title = labels.plain_title(f"Orders: swept sine: {structure.label()}")
    assert title.startswith("Orders: swept sine, ")
    assert "_" not in "".join(title.split("$")[::2])  # outside of formulas
    told = ("0.6", "= 42 Hz", "= 55 Hz", "= 0.7 %", "= 1 %", "-2e-05 m")
    for number in told if structure.clearance else ():
        assert number in title


def test_a_map_has_impulses_in_newton_seconds_where_the_structure_is_in_si():
    """m1 omega a eta^2 of 1.5 kg, 75 rad/s, 1 mm at eta 1 and 2."""
    sides = {"e": [0.3, 0.5], "frequency": [75.0, 150.0], "eta": ("frequency", [1.0, 2.0])}
    attributes = {**known(True), "amplitude": 1e-3}
    names = ("impacts_per_period", "multiplicity", "xi_rel_max", "impulse_max")
    data = xr.Dataset({name: (("e", "frequency"), np.ones((2, 2))) for name in names}, sides)
    values, label = maps.shown_values(data.assign_attrs(attributes), "impulse_max")
    assert label == "largest impulse in mN s"
    assert values.transpose("e", "frequency").values[0] == pytest.approx([112.5, 450.0])
    assert maps.shown_values(data.assign_attrs(attributes), "xi_rel_max")[1].endswith("in mm")
    by_ratio = mapped(False)
    by_ratio["impulse_max"] = by_ratio.xi_rel_max
    assert maps.shown_values(by_ratio, "impulse_max")[1] == maps.COLUMNS["impulse_max"]


def test_a_manifold_has_the_unit_asked_for():
    over = ("side", "point")
    gaps = xr.Dataset(
        {"x_rel": (over, np.full((2, 3), 2e-5)), "v_rel": (over, np.full((2, 3), 1e-3))},
        {"side": ["+", "-"]},
        {**known(True), "shown_in": "mm"},
    )
    axes = manifold.draw(gaps).axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("gap in mm", "gap velocity in mm/s")
    assert axes.lines[0].get_xdata()[0] == pytest.approx(0.02)


def test_numbers_without_a_unit_have_their_letter():
    assert scales.AxisValues(np.ones(1), scales.ETA).text(1.04) == r"$\eta$ = 1.04"
    many = scales.AxisValues(np.ones(1), scales.FREQUENCIES["Hz"]).text(*range(10))
    assert many == "0, 1, 2, 3, 4, 5 Hz and 4 more"
