"""A measured record over the page's spectrum: read by the package's reader alone."""

import numpy as np
import pytest

import orchestrate
from orchestrate import cli
from orchestrate.errors import InputError
from orchestrate.explorer.measured import record_json
from tests import ROOT

RECORDS = ROOT / "docs" / "records"
SERIES = """
const { series } = explorer.inspector.pictures.charts.spectrum;
const found = series.find(({ label }) => label === "measured");
return found ? [Array.from(found.x), Array.from(found.y)] : null;
"""


def sines():
    """A record of a sine that is swept from 20 to 40 Hz, with a second order on face 1."""
    sweep = orchestrate.SweptSine(first=20.0, last=40.0, duration=30.0, acceleration=4.0)
    time = np.arange(30_000) / 1000.0
    phase = sweep.phase(time)
    face = 6.0 * np.sin(phase) + 0.5 * np.sin(2.0 * phase)
    return orchestrate.record(
        time=time, box_acceleration=4.0 * np.sin(phase), acceleration1=face, source="simulated"
    )


def test_a_swept_sine_is_its_orders_and_no_spectrum():
    drawn = record_json(sines())["record"]
    assert set(drawn) == {"title", "orders"}
    frequency, rows = (np.array(drawn["orders"][name]) for name in ("frequency", "amplitude"))
    assert (np.diff(frequency) > 0.0).all() and 20.0 < frequency[0] < 22.0
    assert rows.shape == (5, len(frequency))
    assert np.median(rows, axis=1)[:2] == pytest.approx([6.0, 0.5], rel=1e-3)


def test_without_a_base_a_sweep_cannot_be_known_and_the_record_is_refused():
    with pytest.raises(InputError, match="record: no box_acceleration; expected box_acc"):
        record_json(sines().drop_vars("box_acceleration"))


def test_the_page_draws_the_orders_at_the_frequency_that_is_shown(chromium, tmp_path, capsys):
    page, beam = tmp_path / "page.html", str(RECORDS / "beam.toml")
    file = RECORDS / "beam_a.csv"
    asked = ["explore", "--structure", beam, "--no-open", "--output", str(page)]
    assert cli.main([*asked, "--record", str(file)]) == 0
    tracked = orchestrate.track_orders(orchestrate.read_record(file), orders=5)
    row = tracked.swap_dims(time="frequency").sortby("frequency")
    row = row.sel(channel="acceleration1").sel(frequency=35.0, method="nearest").amplitude
    chromium.open(page, whole=False)
    assert "the orders of its swept sine" in chromium.text("record")
    for hertz, is_drawn in ((35.0, True), (150.0, False)):
        chromium.run(CHOOSE, hertz)
        chromium.until("return explorer.inspector.spectra")
        found = chromium.run(SERIES)
        assert (found is not None) == is_drawn
        if is_drawn:
            assert found[0] == pytest.approx([35.0 * n for n in range(1, 6)])
            assert np.array(found[1]) * 9.80665 == pytest.approx(row.values, rel=1e-6)
    assert chromium.console() == []


CHOOSE = """
const { k1, m1 } = explorer.structure;
explorer.choose((2 * Math.PI * arguments[0]) / Math.sqrt(k1 / m1), true, [0, 0, 0, 0]);
"""
