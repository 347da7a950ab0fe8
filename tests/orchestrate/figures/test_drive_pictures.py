"""Pictures of the weak drive show what their datasets hold; nothing overlaps or is cut off."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.transforms import Bbox

import orchestrate
from orchestrate.figures import (
    capture,
    drive_spectra,
    jump_voltages,
    passage,
    run_history,
    weak_drive,
)
from orchestrate.files import write_whole
from orchestrate.weak_drive.drive_spectra import drive_spectra as ask_drive_spectra

from .test_pictures import HERE, QUICK, drawn, texts
from .test_readable import colliding_numbers


def test_spectra_of_the_weak_drive(exported):
    asked = {"voltage": 1.3, "begin": 1.29, "hold": 10.0, "revolutions": 4, "points": 64, **HERE}
    upper, lower = drive_spectra.draw(ask_drive_spectra(*QUICK, **asked)).axes
    assert upper.get_title(loc="left").startswith("bonded")
    assert lower.get_title(loc="left").startswith("delaminated")


def coupled(jumps: bool) -> xr.Dataset:
    """A run of the weak drive, with or without jumps."""
    asked = {"voltage": (1.4, 1.42), "rate": 2e-4, "settle": 20.0, **HERE}
    data = orchestrate.couple(*QUICK, **asked)
    if jumps:
        for name in ("jumps", "jump_time", "jump_speed"):
            of = {"jumps": "voltage", "jump_time": "time", "jump_speed": "speed"}[name]
            data[name][:] = data[of][-7:-5].values
    return data


@pytest.mark.parametrize("jumps", [False, True])
def test_the_weak_drive(exported, jumps):
    """Jumps are told in words, and drawn over time where there are any."""
    data = coupled(jumps)
    theory = xr.Dataset({"voltage": ("speed", [1.4, 1.5]), "amplitude": ("speed", [1.0, 2.0])})
    theory = theory.assign_coords(speed=[1.2, 1.3]).assign(stable=("speed", [True, False]))
    figure = weak_drive.draw({"bonded": data, "delaminated": data}, theory, title="set")
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {f"averaged theory, bonded, {what}" for what in ("stable", "unstable")} < {*labels}
    up, down = (f"{value:.4f} V" for value in data.jumps.values[:2])
    told = f"jump up at {up}, down at {down}" if jumps else "no jump"
    assert figure.axes[0].get_title(loc="left") == f"bonded: {told}\ndelaminated: {told}"
    assert len(figure.axes) == 4
    assert all(drawn(panel) for panel in figure.axes)
    nothing_overlaps(figure)
    second = weak_drive.draw_jumps({"bonded": data, "delaminated": data}, "set")
    assert [bool(drawn(panel)) for panel in second.axes] == [jumps] * (4 if jumps else 2)
    nothing_overlaps(second)
    lines = [line for panel in (*figure.axes, *second.axes) for line in panel.lines]
    names = {str(line.get_color()) for line in lines}
    assert not {name for name in names if name.startswith("C")}  # of a user's own cycle, later


def nothing_overlaps(figure):
    """Titles and labels of all panels lie in the figure and not on each other."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    assert colliding_numbers(figure, renderer) == []
    legends = [*figure.legends, *filter(None, (panel.get_legend() for panel in figure.axes))]
    for box in (legend.get_window_extent(renderer) for legend in legends):
        assert box.x0 >= 0 and box.x1 <= figure.bbox.x1 and box.y0 >= 0
    named = [text for panel in figure.axes for text in panel_texts(panel) if text.get_text()]
    boxes = [text.get_window_extent(renderer) for text in named]
    for i, box in enumerate(boxes):
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1, named[i].get_text()
        assert figure.bbox.y0 <= box.y0 and box.y1 <= figure.bbox.y1, named[i].get_text()
        for j in range(i):
            both = (named[i].get_text(), named[j].get_text())
            assert not Bbox.intersection(box, boxes[j]) or not box.overlaps(boxes[j]), both


def panel_texts(panel):
    """Title and names of both axes."""
    return [panel._left_title, panel.xaxis.label, panel.yaxis.label]


def test_the_passage(exported):
    """Four rows over time, then the spectra; both structures side by side."""
    asked = {"voltage": 1.45, "duration": 120.0, **HERE}
    found = {
        name: orchestrate.passage(structure, QUICK[1], **asked)
        for name, structure in {"bonded": QUICK[0].as_bonded(), "delaminated": QUICK[0]}.items()
    }
    spectra = {name: orchestrate.waterfall(data, revolutions=4) for name, data in found.items()}
    figure = passage.draw(found, spectra, "quick: 1.45 V")
    panels = figure.axes[:10]
    assert [panel.get_ylabel() for panel in panels[::2]][1:3] == ["voltage in V", "$x_1$ in m"]
    assert (
        panels[1].get_title(loc="left")
        == f"delaminated: {passage.format_jumps(found['delaminated'])}"
    )
    assert all(panel.collections for panel in panels[8:])
    power = drawn(panels[6])[0][:, 1]
    revolution = (found["bonded"].motor[-1] - found["bonded"].motor[-300]) / 29.9
    assert np.nanmean(power[-300:]) == pytest.approx(float(revolution), rel=0.05)
    nothing_overlaps(figure)


def test_capture():
    """Made-up results: starts of all three kinds, the border, its interval, and the fold."""
    along, over = ("rotor_inertia",), ("rotor_inertia", "voltage")
    data = xr.Dataset(
        {
            "passes": (over, [[0, 1, 1, 1], [0, 0, 0, 1]]),
            "decision": (over, [["converged"] * 4, ["converged", *["undecided"] * 2, "bounded"]]),
            "border": (along, [1.05, 1.15], {"tolerance": 0.01}),
            "border_low": (along, [1.047, 1.08]),
            "border_high": (along, [1.053, 1.22]),
            "fold": (along, [1.12, 1.5]),
        },
        {"voltage": [1.0, 1.1, 1.2, 1.3], "rotor_inertia": [1.0, 2.0]},
    )
    data["passage_time"] = xr.where(data.passes > 0, 5.0, np.nan)
    data.rotor_inertia.attrs["units"] = "kg.m2"
    figure = capture.draw({"bonded": data, "delaminated": data}, "set")
    assert [axes.get_ylabel() for axes in figure.axes] == ["rotor inertia in kg m$^2$", ""]
    kinds = {"captured", "passes", "undecided", "border", "undecided between"}
    assert kinds == {*texts(figure.axes[0])}
    nothing_overlaps(figure)
    decided, wide = (data.isel(rotor_inertia=i) for i in (0, 1))
    figure = capture.draw({"bonded": decided, "delaminated": wide}, "set")
    assert "time" in figure.axes[0].get_ylabel()
    shown, doubtful = (set(texts(panel)) for panel in figure.axes)
    assert {"border, 1.0500 ± 0.0030 V", "fold, averaged theory"} < shown
    assert {"undecided", "undecided between"}.isdisjoint(shown)
    assert {"undecided", "undecided between", "border, 1.150 ± 0.070 V"} < doubtful
    assert "fold, averaged theory" not in doubtful  # it lies outside of what was tried
    nothing_overlaps(figure)


def test_jump_voltages():
    """Made-up results: the lines to rate 0."""
    rates = np.array([1e-4, 2e-4])
    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    late = np.full((2, 2, 2), np.nan)
    late[:, :, 0] = 1.5 + rates[:, np.newaxis] ** (2 / 3)
    made = {"voltage": (("rate", *each), late), "jumps": (tuple(each), [[1.5, np.nan]] * 2)}
    made["standard_error"] = (tuple(each), [[np.nan] * 2] * 2)
    (panel,) = jump_voltages.draw(xr.Dataset(made, {"rate": rates, **each}), "set").axes
    assert "bonded: 1.5000 V" in texts(panel)
    made["jumps"] = (tuple(each), [[1.5, np.nan], [np.nan] * 2])
    made["standard_error"] = (tuple(each), [[4e-4, np.nan], [np.nan] * 2])
    (panel,) = jump_voltages.draw(xr.Dataset(made, {"rate": rates, **each}), "set").axes
    assert texts(panel) == ["bonded: 1.50000 ± 0.00040 V", "delaminated: 2 rates"]
    made["jumps"] = (tuple(each), [[np.nan, np.nan]] * 2)
    (panel,) = jump_voltages.draw(xr.Dataset(made, {"rate": rates, **each}), "set").axes
    assert texts(panel) == ["bonded: 2 rates", "delaminated: 2 rates"] and not panel.texts
    made["voltage"] = (("rate", *each), np.full((2, 2, 2), np.nan))
    (panel,) = jump_voltages.draw(xr.Dataset(made, {"rate": rates, **each}), "set").axes
    assert [text.get_text() for text in panel.texts] == ["no jump up"]


def test_a_run_that_is_no_ramp(exported):
    data = orchestrate.couple(*QUICK, voltage=1.4, duration=60.0, **HERE)
    figure = run_history.draw({"delaminated": data}, 1.35, "set")
    assert len(figure.axes) == 5 and all(drawn(panel) for panel in figure.axes)
    assert figure.axes[0].get_title(loc="left") == "delaminated: the resonance is not passed"
    nothing_overlaps(figure)


def test_a_constant_voltage_has_no_way_back(exported):
    data = orchestrate.couple(*QUICK, voltage=1.4, duration=60.0, **HERE)
    assert [name for _, _, name in weak_drive.split_directions(data)] == ["there"]
    weak_drive.draw({"delaminated": data})


def test_two_commands_draw_the_same_picture_at_once(tmp_path, monkeypatch):
    """One process writes it while another does: both end well, and the picture is whole."""
    path, inner = tmp_path / "couple.png", []

    def write(temporary):
        temporary.write_bytes(b"half")
        if not inner:
            inner.append(temporary)
            monkeypatch.setattr("os.getpid", lambda: 1)  # the other process
            write_whole(path, write)
            assert path.read_bytes() == b"half, whole" and temporary.exists()
        temporary.write_bytes(b"half, whole")

    write_whole(path, write)
    assert path.read_bytes() == b"half, whole"
    assert [found.name for found in tmp_path.iterdir()] == ["couple.png"]
