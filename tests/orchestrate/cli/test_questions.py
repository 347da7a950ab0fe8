"""Every question at the command line: what it says, and what it writes."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib import image

import orchestrate
from orchestrate import Structure

SHORT = ("--transient", "60", "--samples", "16")
QUESTIONS = {  # command line, words that must be said, pictures
    "resonance": (
        ("--structure", "beam", "--hz", "12:13:0.1", "--g", "0.02", *SHORT),
        ("peaks", "bonded", "delaminated, up", "12.5 Hz", "no jump"),
        True,
    ),
    "map": (
        ("--eta", "0.5:1.5:0.5", "--over", "e", "--values", "0.3,0.7", *SHORT, "--settle", "20"),
        ("6 responses: not periodic", "T ", "largest gap", "impacts per period: "),
        True,
    ),
    "lyapunov": (
        ("--eta", "0.8,1.047", "--transient", "100", "--periods", "300"),
        ("eta = 0.8: exponent 0.0", "chaotic", "eta = 1.047: exponent -0.007", "periodic"),
        True,
    ),
    "attractors": (
        ("--eta", "1.3,1.4", "--starts", "5", *SHORT, "--settle", "20"),
        (" at eta = 1.3 (5 random starts)", "of starts, repeats after", "a state on it"),
        True,
    ),
    "basin": (
        ("--eta", "1.4", "--x", "x_rel,-0.1,0.8,4", "--y", "v_rel,-1,1,3", *SHORT),
        ("of 9 starts", "of the plane", "3 starts left out"),
        True,
    ),
    "orbit": (
        ("--eta", "3.0"),
        ("unstable", "-3.359480", "impact at 0.480678 s", "state at phase 0"),
        True,
    ),
    "manifold": (
        ("--eta", "3.0", "--length", "1"),
        ("saddle: multiplier -3.359480", "side -: ", "1 times the orbit's size", "ends by length"),
        True,
    ),
    "branch": (
        ("--eta", "2.62", "--limits", "2.6:2.7"),
        ("Neimark-Sacker", "2.64796105", "from eta = 2.6 to eta = 2.7", "limit"),
        True,
    ),
}


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "results"


def shows_something(path):
    """Whether a picture has lines or colours on white."""
    grey = image.imread(path)[..., :3].mean(axis=2)
    return min(grey.shape) > 300 and 0.001 < (grey < 0.95).mean() < 0.95


@pytest.mark.parametrize("command", QUESTIONS)
def test_question(ask, folder, command):
    options, words, drawn = QUESTIONS[command]
    done = ask(command, *options, "--format", "nc,csv")
    assert done.code == 0, done.err
    assert [word for word in words if word not in done.out] == []
    (result,) = folder.glob("*.nc")
    assert result.name.startswith(f"{command}_") and str(result) in done.out
    assert xr.load_dataset(result).attrs["call"].startswith(f"{command}(")
    assert drawn == (result.with_suffix(".png").exists())
    assert not drawn or shows_something(result.with_suffix(".png"))
    assert list(folder.glob("*.csv"))
    told = set(re.findall(r"^/\S+", done.out, re.M))
    assert told == {str(path) for path in folder.iterdir()}
    again = ask(command, *options, "--format", "nc,csv")
    assert "complete already" in again.out
    assert again.out.replace(": complete already", "") == done.out


def test_formats_hold_the_same_numbers(ask, folder):
    options, _, _ = QUESTIONS["resonance"]
    formats = ("--format", "csv,mat,xlsx", "--plot", "none")
    assert ask("resonance", *options, *formats).code == 0
    (result,) = folder.glob("*.nc")
    data = xr.load_dataset(result)
    (curves,) = (path for path in folder.glob("*.csv") if path.name.endswith("frequency.csv"))
    table = pd.read_csv(curves)
    digits = pd.read_csv(curves, dtype=str)["x1_max [m]"]  # older pandas reads numbers less exactly
    np.testing.assert_array_equal(list(map(float, digits)), data.x1_max.values.ravel())
    np.testing.assert_allclose(table["frequency [Hz]"].unique(), np.arange(12.0, 13.05, 0.1))
    sheet = pd.read_excel(result.with_suffix(".xlsx"), sheet_name="structure_direction_frequency")
    np.testing.assert_allclose(sheet["a2_max [g]"] * 9.80665, data.a2_max.values.ravel())
    assert result.with_suffix(".mat").stat().st_size > 1000


@pytest.mark.slow
def test_a_branch_goes_on_from_a_stored_one(ask, folder):
    place = folder / "window.nc"
    assert ask("branch", "--eta", "2.7", "--limits", "2.6:2.82", "--store", place).code == 0
    done = ask("branch", "--start", place, "--switch", "1", "--limits", "2.78:2.8")
    assert done.code == 0 and "first end: start" in done.out, done.err
    limits = ("--over", "eta,e", "--limits", "2.6:2.7,0.69:0.71", "--longest", "0.5")
    done = ask("border", "--start", place, *limits)
    assert done.code == 0 and "Neimark-Sacker: " in done.out, done.err
    assert len(list(folder.glob("*.nc"))) == 3


def test_the_excitation_of_the_file(ask, folder, tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(
        "[structure]\nm1 = 1.5\nomega_hz = 11.9\nD = 0.005\n\n"
        "[excitation]\nfrequency_hz = 12.6\nacceleration_g = 0.02\nphase = 0.5\n"
    )
    short = ("simulate", "--structure", path, "--periods", "1", "--plot", "none")
    told = ("--hz", "12.6", "--g", "0.02", "--phase", "0.5")
    done, same = ask(*short), ask(*short, *told)
    assert done.code == same.code == 0, done.err
    assert done.out.splitlines()[:-1] == same.out.splitlines()[:-1]


def test_exponents_along_a_sweep(ask, folder):
    eta = [1.36, 1.3]
    options = ("--eta", "1.36,1.3", "--periods", "100", "--transient", "50", "--plot", "none")
    assert ask("lyapunov", *options, "--follow", "down").code == 0
    (path,) = folder.glob("*.nc")
    swept = orchestrate.sweep(
        Structure(), eta=eta, direction="down", transient=50, samples=1, progress=False
    )
    along = {"start": swept, "transient": 50, "periods": 100, "progress": False}
    expected = orchestrate.lyapunov(Structure(), eta=eta, **along)
    np.testing.assert_array_equal(xr.load_dataset(path).exponent, expected.exponent)


TRIVIAL = [
    (("simulate", "--eta", "1", "--set", "kappa=1"), "both oscillators are alike"),
    (("sweep", "--eta", "1.2", *SHORT), "one value, eta = 1.2: a table and no picture"),
    (
        ("sweep", "--eta", "2:2.1:0.05", "--direction", "both", "--samples", "8"),
        "no hysteresis here",
    ),
    (("resonance", "--eta", "1.9:2:0.05", *SHORT), "no jump"),
    (("resonance", "--eta", "0.3:0.4:0.05", *SHORT), "no peak from eta = 0.3 to eta = 0.4"),
    (
        ("resonance", "--set", "mu=0.5", "--set", "kappa=1.9", "--set", "D=0.02", "--set", "e=0.8")
        + ("--eta", "3.4:4.2:0.01"),
        "maxima left out, as chance makes them where responses are irregular: ",
    ),
    (
        ("sweep", "--set", "e=0.86", "--eta", "0.827,0.9", "--transient", "240", "--samples", "60"),
        "still converging or nearly periodic (--transient 5000 decides most) at eta = 0.827",
    ),
    (("branch", "--eta", "2.5", "--limits", "2.45:2.55"), "no bifurcation in this range"),
    (("lyapunov", "--eta", "1", "--set", "bonded=true", "--periods", "20"), "there are no impacts"),
]


@pytest.mark.parametrize(("words", "said"), TRIVIAL, ids=lambda value: " ".join(value)[:60])
def test_what_is_trivial_is_said(ask, words, said):
    done = ask(*words, "--plot", "none")
    assert done.code == 0 and said in done.out, done.err


def test_frequencies_in_hertz_are_told_whose_structure_they_meet(ask, caplog):
    short = ("--periods", "1", "--plot", "none")
    done = ask("simulate", "--hz", "47", "--g", "0.5", *short)
    assert "structure: the paper's, omega = 1 rad/s, 0.1592 Hz (--structure names" in done.out
    assert caplog.messages[-1].startswith(
        "frequencies of 295 times the structure's 0.1592 Hz are far from it"
    )
    caplog.clear()
    done = ask("simulate", "--hz", "12", "--g", "0.02", "--structure", "beam", *short)
    assert "structure:" not in done.out
    done = ask("simulate", "--eta", "30", *short)
    assert "structure:" not in done.out and caplog.messages == []
    low = ("resonance", "--structure", "beam", "--hz", "0.1,12", "--amplitude", "1e-3")
    ask(*low, "--transient", "1", "--samples", "1", "--plot", "none")
    assert caplog.messages[-1].startswith("frequencies of 0.00838 to 1.01 times")


def test_a_file_s_name_has_one_unit_of_frequency(ask, tmp_path):
    branch = ("branch", "--structure", "beam", "--over", "hz", "--limits", "60:60.2", "--hz", "60")
    assert ask(*branch, "--amplitude", "1e-4", "--plot", "none").code == 0
    (path,) = (tmp_path / "results").glob("*.nc")
    assert "_60Hz_60-60.2Hz_" in path.name and "376" not in path.name
