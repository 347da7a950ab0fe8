"""Pictures that people can read: all is drawn, told with its unit, and covered by nothing."""

import itertools

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.transforms import Bbox

import orchestrate
from orchestrate.show import (
    analysis,
    colours,
    histories,
    lines,
    passage,
    planes,
    resonance,
    weak_drive,
)
from orchestrate.show import spectra as spectra_pictures

from ...sparing import ordinary
from . import made

QUICK = (orchestrate.Structure.from_file("quick"), orchestrate.Drive.from_file("quick"))
HERE = {"progress": False, "jobs": 1}
SI = {  # pictures of a structure in SI
    "orbit": lambda: lines.draw_sweep(made.sweep(si=True)),
    "both ways": lambda: lines.draw_sweep(made.sweep(700, True, both=True)),
    "exponents": lambda: lines.draw_lyapunov(made.exponents(True)),
    "attractors": lambda: lines.draw_attractors(made.coexisting(True)),
    "basin": lambda: planes.draw_basin(made.plane(True)),
    "resonance": lambda: resonance.draw_resonance(made.curves(True)),
    "spectra": lambda: spectra_pictures.draw_spectra(made.lines(True)),
    "motion": lambda: histories.draw_motion(made.moving(True)),
    "map": lambda: planes.draw_map(made.mapped(True)),
    "levels": lambda: resonance.draw_levels(made.levels(True)),
}
CAPTURED = made.capture()
OTHERS = {
    "orders": lambda: analysis.draw(made.tracked(), "delaminated", {"bonded": made.tracked(1e-7)}),
    "capture": lambda: weak_drive.draw_capture({"bonded": CAPTURED, "delaminated": CAPTURED}),
    "passage times": lambda: weak_drive.draw_capture(
        {name: CAPTURED.isel(rotor_inertia=i) for i, name in enumerate(("bonded", "delaminated"))}
    ),
    "jump voltages": lambda: lines.draw_jump_voltages(
        made.late_jumps([1.5, np.nan], [4e-4, np.nan])
    ),
}


def words(figure, renderer) -> dict[str, object]:
    """Boxes of all titles and names of axes."""
    found = [*figure.texts, *([figure._suptitle] if figure._suptitle else [])]
    for axes in figure.axes:
        found += [axes.xaxis.label, axes.yaxis.label, axes._left_title, axes._right_title]
        found += axes.texts
    return {
        text.get_text(): text.get_window_extent(renderer)
        for text in found
        if text.get_text() and text.get_visible()
    }


def all_is_readable(figure):
    """Nothing is cut off, covered, or on something else; return all texts."""
    figure, renderer = made.rendered(figure)
    texts, whole = words(figure, renderer), figure.bbox
    legends = [*figure.legends, *(a.get_legend() for a in figure.axes if a.get_legend())]
    boxes = {
        **texts,
        **{f"legend {i}": one.get_window_extent(renderer) for i, one in enumerate(legends)},
    }
    for text, box in boxes.items():
        assert box.x0 >= 0 and box.y0 >= 0 and box.x1 <= whole.x1 and box.y1 <= whole.y1, text
    for legend in figure.legends:
        box = legend.get_window_extent(renderer)
        assert not any(axes.bbox.padded(-1).overlaps(box) for axes in figure.axes), "covers data"
        assert [text for text, other in texts.items() if other.padded(-1).overlaps(box)] == []
    titles = [(text, box.padded(-1)) for text, box in texts.items()]
    for (one, box), (other, its) in itertools.combinations(titles, 2):
        assert not (Bbox.intersection(box, its) and box.overlaps(its)), (one, other)
    assert colliding_numbers(figure, renderer) == [] and words_on_lines(figure, renderer) == []
    return texts


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


@pytest.mark.parametrize("name", ordinary([*SI, *OTHERS], [*SI, *OTHERS][::3]))
def test_a_picture_is_readable_and_says_what_it_shows(name):
    figure = {**SI, **OTHERS}[name]()
    texts = " ".join(all_is_readable(figure))
    for axes in figure.axes:
        shown = axes.xaxis.get_ticklabels() and axes.xaxis.get_tick_params().get("labelbottom")
        if axes.get_label() != "<colorbar>" and shown:
            assert axes.get_xlabel(), axes
    if name in SI:  # not the usual scale, so it is told
        assert "$f_1$ = 11.94 Hz" in texts
        assert r"\zeta_2" in texts and r"$\mu$" in texts and r"$\gamma$" in texts
        assert " in Hz" in texts or name in ("basin", "map", "motion")


@pytest.fixture(scope="module")
def ramps(exported):
    """Runs of both structures on the weak drive, and the same with jumps."""
    asked = {"voltage": (1.4, 1.42), "rate": 2e-4, "settle": 20.0, **HERE}
    data = orchestrate.couple(*QUICK, **asked)
    jumped = data.copy(deep=True)
    for name in ("jumps", "jump_time", "jump_speed"):
        of = {"jumps": "voltage", "jump_time": "time", "jump_speed": "speed"}[name]
        jumped[name][:] = jumped[of][-7:-5].values
    return {False: data, True: jumped}


@pytest.mark.slow
@pytest.mark.parametrize("jumps", [False, True])
def test_the_weak_drive_says_its_jumps_and_draws_them_over_time(ramps, jumps):
    runs = {"bonded": ramps[jumps], "delaminated": ramps[jumps]}
    theory = xr.Dataset(
        {"voltage": ("speed", [1.4, 1.5]), "amplitude": ("speed", [1.0, 2.0])},
        {"speed": [1.2, 1.3], "stable": ("speed", [True, False])},
    )
    figure = weak_drive.draw(runs, theory, title="set")
    names = {f"averaged theory, bonded, {what}" for what in ("stable", "unstable")}
    assert names < {*made.legend_texts(figure)}
    up, down = (f"{value:.4f} V" for value in ramps[jumps].jumps.values[:2])
    told = f"jump up at {up}, down at {down}" if jumps else "no jump"
    assert figure.axes[0].get_title(loc="left") == f"bonded: {told}\ndelaminated: {told}"
    assert len(figure.axes) == 4 and all(made.drawn(panel) for panel in figure.axes)
    all_is_readable(figure)
    second = weak_drive.draw_jumps(runs, "set")
    assert [bool(made.drawn(panel)) for panel in second.axes] == [jumps] * (4 if jumps else 2)
    all_is_readable(second)
    drawn = [line for panel in (*figure.axes, *second.axes) for line in panel.lines]
    assert not [line for line in drawn if str(line.get_color()).startswith("C")]  # a user's cycle


@pytest.mark.slow
def test_a_constant_voltage_is_drawn_over_time_and_has_no_way_back(exported):
    data = orchestrate.couple(*QUICK, voltage=1.4, duration=60.0, **HERE)
    figure = passage.draw_run({"delaminated": data}, 1.35, "set")
    assert len(figure.axes) == 5 and all(made.drawn(panel) for panel in figure.axes)
    assert figure.axes[0].get_title(loc="left") == "delaminated: the resonance is not passed"
    all_is_readable(figure)
    assert [name for _, _, name in weak_drive.split_directions(data)] == ["there"]
    weak_drive.draw({"delaminated": data})


@pytest.mark.slow
def test_a_passage_has_both_structures_side_by_side(exported):
    asked = {"voltage": 1.45, "duration": 120.0, **HERE}
    structures = {"bonded": QUICK[0].as_bonded(), "delaminated": QUICK[0]}
    found = {n: orchestrate.passage(one, QUICK[1], **asked) for n, one in structures.items()}
    waterfalls = {name: orchestrate.waterfall(data, revolutions=4) for name, data in found.items()}
    figure = passage.draw(found, waterfalls, "quick: 1.45 V")
    panels = figure.axes[:10]
    assert [panel.get_ylabel() for panel in panels[::2]][1:3] == ["voltage in V", "$x_1$ in m"]
    title = f"delaminated: {passage.format_jumps(found['delaminated'])}"
    assert panels[1].get_title(loc="left") == title
    assert all(panel.collections for panel in panels[8:])
    power = made.drawn(panels[6])[0][:, 1]
    revolution = (found["bonded"].motor[-1] - found["bonded"].motor[-300]) / 29.9
    assert np.nanmean(power[-300:]) == pytest.approx(float(revolution), rel=0.05)
    all_is_readable(figure)


DEUTERAN = np.array([[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]])
PROTAN = np.array([[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]])


@pytest.mark.parametrize("seen", [np.eye(3), DEUTERAN, PROTAN], ids=["all", "deuteran", "protan"])
def test_colours_are_told_apart_by_everyone(seen):
    """Machado, Oliveira and Fernandes (2009): what people see who lack a cone, in linear RGB."""
    used = (colours.BLACK, colours.BLUE, colours.RED, colours.GREEN, colours.ORANGE)
    linear = [seen @ np.array(to_rgb(colour)) ** 2.2 for colour in used]
    light = [np.clip(rgb, 0.0, 1.0) ** (1 / 2.2) for rgb in linear]
    for one, other in itertools.combinations(light, 2):
        assert np.linalg.norm(one - other) > 0.2, (one, other)
