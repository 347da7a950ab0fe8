"""Pictures of an analyser: all records are in them, and told apart."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex

import orchestrate
from orchestrate.show import analysis

from ...sparing import ordinary

ANALYSES = (
    *("frf", "psd", "track_orders", "harmonics", "spectrogram"),
    *("shock_spectrum", "probability_density"),
)
TIME = np.arange(4000) / 500.0


def record(order_2=0.0, second=True, down=False):
    """A sweep from 20 to 52 Hz or down, with a response of known orders."""
    angle = 2.0 * np.pi * ((52.0 - 2.0 * TIME) * TIME if down else (20.0 + 2.0 * TIME) * TIME)
    box, response = 2.0 * np.sin(angle), 6.0 * np.sin(angle) + order_2 * np.sin(2.0 * angle)
    channels = {"box_acceleration": box, "acceleration1": response, "acceleration2": 0.5 * response}
    chosen = list(channels)[: 2 + second]
    return xr.Dataset({name: ("time", channels[name]) for name in chosen}, {"time": TIME})


def picture(name, **kinds):
    ask = getattr(orchestrate, name)
    (label, data), *others = ((label, ask(one)) for label, one in kinds.items())
    return analysis.draw(data, label=label, others=dict(others))


def texts(figure):
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes)]
    words = [text.get_text() for legend in legends if legend for text in legend.get_texts()]
    words += [axes.get_title(side) for axes in figure.axes for side in ("left", "right")]
    return words + [text.get_text() for axes in figure.axes for text in axes.texts]


@pytest.mark.parametrize("name", ordinary(ANALYSES, 2))
def test_all_records_are_in_one_picture(name):
    figure = picture(
        name, delaminated=record(0.6), bonded=record(1e-9), measured=record(0.5, second=False)
    )
    words = " ".join(texts(figure))
    assert all(label in words for label in ("delaminated", "bonded", "measured"))
    assert sum(axes.has_data() for axes in figure.axes) >= 3
    if name != "spectrogram":
        colours = {to_hex(line.get_color()) for axes in figure.axes for line in axes.lines}
        assert {"#0072b2", "#d55e00", "#000000"} <= colours


def test_one_record_needs_no_label():
    figure = analysis.draw(orchestrate.frf(record(0.6, second=False)), title="My record")
    assert figure.get_suptitle() == "My record" and not figure.legends
    assert "mass 2" not in " ".join(texts(figure))


def test_what_lies_below_an_axis_is_named():
    figure = picture("track_orders", delaminated=record(0.6), bonded=record(1e-9))
    assert "below this axis: bonded" in texts(figure)


def test_phases_turn_without_a_vertical_line():
    phase = xr.DataArray(np.radians([80.0, -170.0, 170.0, 100.0, 85.0, -10.0]))
    degrees = analysis.phase_in_degrees(phase)
    assert np.allclose(degrees, [np.nan, -170.0, -190.0, np.nan, 85.0, -10.0], equal_nan=True)


def test_results_of_different_analyses_do_not_mix():
    one, other = orchestrate.psd(record()), orchestrate.frf(record())
    with pytest.raises(ValueError, match=r"others\['b'\]: result of frf; expected one of psd"):
        analysis.draw(one, label="a", others={"b": other})
