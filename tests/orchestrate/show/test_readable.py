"""Pictures that people can read: all is drawn, told with its unit, and covered by nothing."""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.transforms import Bbox

import orchestrate
from orchestrate.show import colours

from ...exports import once
from ...sparing import ordinary
from ..laboratory.analysis.records import ANALYSES, analyses
from ..test_public_face import OWN, questions
from . import made

PICTURES = (  # real answers; those of a resonance are made up, with many frequencies
    *("simulate", "resonance", "resonance levels", "sweep", "sweep both", "sweep over", "map"),
    *("map exponent", "lyapunov", "attractors", "basin", "spectra", "poincare", "manifold"),
    *("branch", "cosimulate", "couple", *ANALYSES),
)

SCALED = ("resonance levels", "sweep", "sweep both", "lyapunov", "attractors")


@pytest.fixture(scope="module")
def answers(exported, tmp_path_factory):
    """Small answers of all public questions."""
    found = once(tmp_path_factory, "answers", questions)
    return found | analyses() | {"resonance": made.curves(True)}


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


@pytest.mark.parametrize("name", ordinary(PICTURES, {*PICTURES[::3], "branch"}))
def test_a_picture_is_readable_and_says_what_it_shows(answers, name):
    figure = orchestrate.plot(answers[name])
    texts = " ".join(all_is_readable(figure))
    for axes in figure.axes:
        shown = axes.xaxis.get_ticklabels() and axes.xaxis.get_tick_params().get("labelbottom")
        if axes.get_label() != "<colorbar>" and shown:
            assert axes.get_xlabel(), axes
    if name in SCALED:  # not the usual scale, so it is told
        assert f"$f_1$ = {OWN.f1:.2f} Hz" in texts and " in Hz" in texts


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
