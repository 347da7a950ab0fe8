"""Results in other tools' formats, read back with those tools."""

from __future__ import annotations

import zipfile

import numpy as np
import openpyxl
import pandas as pd
import pytest
import xarray as xr
from scipy.io import loadmat

from orchestrate.errors import InputError, StoreError
from orchestrate.running import formats
from orchestrate.units import with_units


def metres(dims, values):
    return dims, np.asarray(values, dtype=float), {"units": "m", "long_name": "length"}


@pytest.fixture
def data():
    kind = {"units": "1", "flag_values": np.array([0, 1], "i1"), "flag_meanings": "at_rest moves"}
    return xr.Dataset(
        {
            "x": metres("time", [0.1, 1.0 / 3.0, np.nan]),
            "kind": ("time", np.array([0, 1, 1], "i1"), kind),
            "gap": metres(("name", "time"), np.arange(6).reshape(2, 3)),
            "peak": metres((), 2.5),
        },
        {"time": ("time", [0.0, 1.0, 2.0], {"units": "s"}), "name": ["up", "down"], "eta": 1.2},
        {"title": "a test", "e": 0.7},
    )


def test_csv(data, tmp_path):
    written = formats.write(data, tmp_path / "a.csv")
    names = [path.name for path in written]
    assert names == ["a.time.csv", "a.name_time.csv", "a.numbers.csv"]
    assert sorted(names) == sorted(path.name for path in tmp_path.iterdir())
    table = pd.read_csv(written[0])
    assert list(table.columns) == ["time [s]", "x [m]", "kind"]
    np.testing.assert_array_equal(table["x [m]"], data.x)
    assert table["kind"].tolist() == ["at rest", "moves", "moves"]
    long = pd.read_csv(written[1]).set_index(["name", "time [s]"])["gap [m]"]
    assert long["down", 1.0] == 4.0 and len(long) == 6


TEXTS = ['=HYPERLINK("http://example.org","x").csv', "#REF!", "+1", "-2", "@SUM(1)"]


def test_texts_are_no_formulas_of_a_sheet(data, tmp_path):
    """The name of a record, whoever gave it, runs nothing."""
    words = xr.Dataset({"word": ("text", TEXTS)}, {"text": TEXTS}, {"source": TEXTS[0]})
    formats.write(data.merge(words).assign_attrs(words.attrs), tmp_path / "a.xlsx")
    with zipfile.ZipFile(tmp_path / "a.xlsx") as archive:
        assert not any(b"<f>" in archive.read(name) for name in archive.namelist())
    book = openpyxl.load_workbook(tmp_path / "a.xlsx")
    assert book.sheetnames == ["time", "name_time", "numbers", "text", "about"]
    rows = list(book["time"].values)
    assert rows[0] == ("time [s]", "x [m]", "kind") and rows[2] == (1, 1.0 / 3.0, "moves")
    assert [row[1] for row in book["text"].values] == ["word", *TEXTS]
    about = list(book["about"].values)
    assert ("x", "m", "length") in about and ("source", None, TEXTS[0]) in about


def test_mat(data, tmp_path):
    formats.write(data, tmp_path / "a.mat")
    found = loadmat(tmp_path / "a.mat", simplify_cells=True)
    np.testing.assert_array_equal(found["x"], data.x)
    np.testing.assert_array_equal(found["gap"], data.gap)
    assert found["name"].tolist() == ["up", "down"] and found["peak"] == 2.5
    assert found["units"]["x"] == "m" and found["attributes"]["title"] == "a test"
    assert found["dimensions"]["gap"] == "name, time"


@pytest.mark.parametrize("ending", [*formats.WRITERS, "doc", "too long"])
def test_whole_or_not_at_all(data, tmp_path, ending, monkeypatch):
    if ending == "too long":
        monkeypatch.setattr(formats, "MAX_SHEET_ROWS", 2)
    place = tmp_path / f"a.{ending.replace('too long', 'xlsx')}"
    if ending in formats.WRITERS:
        place.mkdir()
    words = {"doc": "'doc'; expected", "too long": "3 rows"}.get(ending, "cannot be written")
    with pytest.raises((StoreError, InputError), match=words):
        formats.write(data[["x"]], place)
    assert [p.name for p in tmp_path.iterdir()] == [place.name] * (ending in formats.WRITERS)


def test_a_frequency_stands_once_and_without_the_digits_of_a_conversion(tmp_path):
    turns = np.array([30.0, 30.1]) * (2.0 * np.pi)
    places = {"frequency": ("frequency", turns, {"units": "rad/s"})}
    places["hertz"] = ("frequency", turns / (2.0 * np.pi), {"units": "Hz"})
    data = xr.Dataset({"x": ("frequency", [1.0, 2.0], {"units": "m"})}, places)
    (path,) = formats.write(with_units(data, "Hz"), tmp_path / "a.csv")
    assert path.read_text().split() == ["frequency", "[Hz],x", "[m]", "30.0,1.0", "30.1,2.0"]
    (path,) = formats.write(data, tmp_path / "b.csv")
    assert path.read_text().startswith("frequency [rad/s],x [m],hertz [Hz]")
