"""Pictures of signs and of a test's plan."""

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate.diagnosis.indicators import INDICATORS
from orchestrate.show import diagnosis


def texts(figure):
    figure.canvas.draw()
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    words += [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    return words + [label.get_text() for axes in figure.axes for label in axes.get_yticklabels()]


@pytest.fixture(scope="module")
def signs():
    time = np.arange(4000) / 1000.0
    angle = 2.0 * np.pi * (20.0 * time + 5.0 * time**2)
    box, response = 2.0 * np.sin(angle), 6.0 * np.sin(angle) + 0.6 * np.sin(2.0 * angle)
    noise = 0.01 * np.random.default_rng(2).normal(size=(2, 4000))
    names = {"box_acceleration": box, "acceleration1": response + noise[0]}
    names["acceleration2"] = response + noise[1]
    record = xr.Dataset({name: ("time", values) for name, values in names.items()}, {"time": time})
    return orchestrate.signs(record, seeds=1)


def test_every_known_sign_has_its_bar_and_the_others_are_named(signs):
    figure = orchestrate.plot(signs, title="Beam A")
    words, (axes,) = texts(figure), figure.axes
    known = (signs.exceeds >= 0).any("channel").values
    names = [one.long_name for one in INDICATORS.values()]
    assert 0 < known.sum() < len(names)
    lacking = figure.legends[0].get_title().get_text().replace("\n", " ")
    for name, drawn in zip(names, known, strict=True):
        assert (name in words) == drawn and (name in lacking) == (not drawn)
    widths = {bar.get_width() for bar in axes.patches}
    order_2 = (signs.value / np.fmax(signs.floor, signs.sound_highest)).sel(sign="order_2").values
    assert all(any(np.isclose(width, wanted) for width in widths) for wanted in order_2)
    low, high = axes.get_xlim()
    assert low == diagnosis.FEWEST_DECADES[0] and high > float(order_2.max())
    assert all(text.xy[0] >= signs.attrs["factor"] for text in axes.texts)  # on no line
    assert figure.get_suptitle() == "Beam A"


def test_a_plan_shows_what_was_heard_and_the_recommended_levels():
    level = ("level", [0.1, 0.2, 0.4], {"units": "m/s2", "long_name": "level"})
    made = {"heard": ("level", [2.0, 20.0, 60.0]), "sound_heard": ("level", [1.5, 1.6, 1.7])}
    made |= {"decides": ("level", [0, 1, 1]), "recommended_level": ((), 0.4), "second_level": 0.4}
    made |= {"threshold": 10.0}
    data = xr.Dataset(made, {"level": level}, {"analysis": "plan_test", "title": "Plan"})
    figure = orchestrate.plot(data)
    assert {"guess", "sound twin", "both verdicts right"} <= set(texts(figure))
    (axes,) = figure.axes
    marks = next(line for line in axes.lines if line.get_marker() == "o")
    np.testing.assert_array_equal(marks.get_xydata(), [[0.2, 20.0], [0.4, 60.0]])
    assert sum(list(line.get_xdata()) == [0.4, 0.4] for line in axes.lines) == 1
    assert [text.get_text() for text in axes.texts] == [" recommended"]  # once of one level
