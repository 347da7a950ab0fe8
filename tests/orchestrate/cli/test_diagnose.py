"""``diagnose`` and ``report``: records in, verdicts and pages out."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from .commands import ROOT

RECORDS = ROOT / "docs" / "records"
GUESS = RECORDS / "beam.toml"


def write_csv(path, *columns, heading="time [s];base [m/s2];acc 1 [m/s2]"):
    table = np.stack(columns, axis=1)
    rows = "".join(";".join(f"{value:.6g}" for value in row) + "\n" for row in table)
    path.write_text(f"{heading}\n{rows}")
    return path


@pytest.fixture
def sine(tmp_path):
    time = np.arange(400) / 200.0
    return write_csv(tmp_path / "sine.csv", time, np.sin(60.0 * time), np.cos(60.0 * time))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["FILE"], ["--structure: nothing given", "guess of the beam"]),
        (["lost.csv", "--structure", GUESS], ["lost.csv", "expected a file to read"]),
        (["FILE", "--structure", "lost.toml"], ["lost.toml"]),
        (["FILE", "--structure", GUESS, "--columns", "0"], ["--columns 0", "acceleration1"]),
        (["FILE", "--structure", GUESS, "--columns", "0,1,9"], ["9"]),
        (["FILE", "--structure", GUESS, "--columns", "0,1"], ["no acceleration1", "--columns"]),
        (["FILE", "FILE", "--structure", GUESS, "--other", "FILE"], ["--other: of one beam"]),
        (["FILE", "--structure", GUESS, "--set", "f1=-3"], ["f1 = -3"]),
        (["FILE", "--structure", GUESS, "--plot", "gif"], ["--plot gif"]),
        (["FILE", "--structure", GUESS, "--unit", "furlong"], ["furlong"]),
    ],
)
def test_mistakes_are_one_line_and_nothing_is_written(ask, tmp_path, sine, options, words):
    given = [sine if option == "FILE" else option for option in options]
    ask("diagnose", *given).complaint(*words)
    assert not (tmp_path / "results").exists() or not any((tmp_path / "results").iterdir())


def test_the_help_teaches_what_is_needed_and_what_comes_out(ask):
    text = ask("diagnose", "--help").out
    for words in ("swept sine", "guess", "no opening seen", 'never "intact"', "--other", "--notes"):
        assert words in text


@pytest.fixture
def stored(ask, tmp_path):
    options = ("--structure", "beam", "--frequency", "78", "--amplitude", "0.001", "--plot", "none")
    ask("simulate", *options, "--periods", "3").success()
    (path,) = (tmp_path / "results").glob("simulate*.nc")
    return path


def test_a_stored_result_becomes_a_page(ask, tmp_path, stored):
    page = tmp_path / "results" / f"report_{stored.stem}.html"
    done = ask("report", stored, "--title", "A <study>", "--notes", "Us").success()
    assert str(page) in done.out
    text = page.read_text(encoding="utf-8")
    assert "A &lt;study&gt;" in text and "data:image/png;base64," in text
    assert xr.load_dataset(stored).attrs["fmu_guid"] in text


def test_mistakes_of_a_page(ask, tmp_path):
    ask("report", tmp_path / "lost.nc").complaint("lost.nc", "no such file")
    xr.Dataset({"x": ("y", [1.0])}).to_netcdf(tmp_path / "other.nc")
    ask("report", tmp_path / "other.nc").complaint("no answer of a question")
    assert not list((tmp_path / "results").glob("*.html"))
