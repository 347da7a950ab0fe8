"""Resonance curves as tables: units, phases, rows and what is refused."""

import numpy as np
import pytest

import orchestrate

from .files import table_file

HERTZ = np.arange(40.0, 60.0)
RATIO = 1.0 / (1.0 - (HERTZ / 50.0) ** 2 + 0.02j)  # order 1 of one mass, 25 at 50 Hz
PEAK = {"order": 1.0, "frequency": 50.0}
SPEED = 2.0 * np.pi * 50.0


def curve(**changes):
    given = {"frequency": HERTZ, "level": 4.0, "amplitude1": abs(RATIO)}
    return orchestrate.resonance_curve(**{**given, **changes})


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("m/s2", 1.0), ("g", 9.80665), ("mm", 1e-3 * SPEED**2), ("mm/s", 1e-3 * SPEED), ("1", 4.0)],
)
def test_units_become_accelerations(unit, factor):
    found = curve(unit=unit).amplitude.sel(PEAK).item()
    assert found == pytest.approx(50.0 * factor, rel=1e-12)


def test_order_2_of_a_displacement_has_the_square_of_its_own_frequency():
    found = curve(amplitude1=np.stack([abs(RATIO)] * 2), unit="mm").amplitude.sel(frequency=50.0)
    np.testing.assert_allclose(found.values[0, 1] / found.values[0, 0], 4.0)
    assert np.isnan(found.values[0, 2])


@pytest.mark.parametrize("given", [RATIO, RATIO.conj()])
def test_a_phase_lags_whatever_its_sign(given):
    found = curve(amplitude1=given)
    np.testing.assert_allclose(found.phase.values[0], np.angle(RATIO), atol=1e-12)
    words = {True: "negative phases taken as lags", False: "positive phases taken as lags"}
    assert found.attrs["phase_sign"] == words[given is RATIO]


def test_rows_without_numbers_are_dropped_with_a_word():
    level = np.where(HERTZ == 45.0, np.nan, 4.0)
    with pytest.warns(UserWarning, match="row 5 dropped: not a number"):
        found = curve(level=level)
    assert found.sizes["frequency"] == 19 and "row 5" in found.attrs["dropped"]


def test_a_table_with_decimal_commas_units_and_gaps_is_read(tmp_path):
    degrees = -np.degrees(np.angle(RATIO))
    degrees[3] = np.nan
    columns = "Frequenz;base;Amplitude;Phase\nHz;g;mm;\u00b0", HERTZ, 0.5 + 0.0 * HERTZ, abs(RATIO)
    path = table_file(tmp_path / "a.csv", *columns, degrees, separator=";", decimal=",")
    found = orchestrate.read_curve(path)
    same = curve(level=0.5 * 9.80665, amplitude1=RATIO, unit="mm")
    np.testing.assert_allclose(found.amplitude, same.amplitude, rtol=1e-8)
    np.testing.assert_allclose(found.level, same.level)
    known = np.isfinite(found.phase.values)
    np.testing.assert_allclose(found.phase.values[known], same.phase.values[known], atol=1e-7)
    assert (~known).sum() == 1
    assert 'amplitude1 "Amplitude", phase1 "Phase"' in found.attrs["columns"]


@pytest.mark.parametrize(
    ("heading", "arguments", "text"),
    [
        ("f;a1", {"level": 3.0}, "no unit; expected one such as m/s2"),
        ("f;a1 [g]", {}, "no column of the base's level"),
        ("f;what", {"level": 3.0, "unit": "g"}, "no amplitude1 among the columns f, what"),
        ("f [m];a1 [g]", {"level": 3.0}, "unit = 'm'; expected one such as hz"),
    ],
)
def test_a_table_that_lacks_something_is_refused(tmp_path, heading, arguments, text):
    path = table_file(tmp_path / "a.csv", heading, HERTZ, abs(RATIO), separator=";")
    with pytest.raises(orchestrate.InputError, match=text):
        orchestrate.read_curve(path, **arguments)
