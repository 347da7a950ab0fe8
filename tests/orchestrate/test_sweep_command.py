"""Results of ``sweep``: they describe themselves, and their numbers are those of the FMU driven by hand."""

import json
import math

import netCDF4
import numpy as np
import pytest
import xarray
from hypothesis import given
from hypothesis import strategies as st
from matplotlib import image

from orchestrate import __version__
from orchestrate.commands.sweep_command import parse_etas
from orchestrate.fmu import Instance, describe
from orchestrate.sweep import Case, Plan, respond

from .command import ROOT, Sweeps
from .conftest import FORMS, exported

SWEEP = ("--eta", "1.28:1.31:0.002", "--transient", "300", "--samples", "40")
CASES = ("--case", "e=0.7", "--case", "e=0.3,D=0.05,mu=0.9", "--direction", "both")
NAMES = [f"orbit_{label}_{direction}" for label in ("e0.7_D0.005", "e0.3_D0.05_mu0.9") for direction in ("up", "down")]


@pytest.fixture(scope="module")
def done(tmp_path_factory, fmu):
    """Two cases, up and down: four sweeps side by side."""
    commands = Sweeps(tmp_path_factory.mktemp("sweep"), fmu)
    commands.answer = commands.run(*SWEEP, *CASES).success()
    yield commands
    commands.clean_up()


@pytest.fixture(scope="module")
def datasets(done):
    """Read the results, by name."""
    return {name: xarray.load_dataset(done.result(name)) for name in NAMES}


def test_every_sweep_has_its_result_and_picture_and_leaves_nothing_else(done):
    assert done.files() == sorted(f"{name}.{kind}" for name in NAMES for kind in ("nc", "png"))
    assert all(str(done.result(name)) in done.answer.out and f"{name}.png" in done.answer.out for name in NAMES)
    assert list(done.temporary.iterdir()) == []


@pytest.mark.parametrize("name", NAMES)
def test_a_result_describes_itself(datasets, name, fmu):
    data, found = datasets[name], describe(fmu)
    assert data.xi_rel.dims == ("eta", "sample")
    assert data.sizes["eta"] == 16 and data.sizes["sample"] == 40
    for variable in ("xi_rel_max", "impacts_per_period", "permanent_contact", "multiplicity", "period"):
        assert data[variable].dims == ("eta",)
    np.testing.assert_array_equal(data.sample, np.arange(301, 341))
    np.testing.assert_array_equal(data.period, 2.0 * np.pi / data.eta.values)
    case = {"e": 0.7, "D": 0.005, "mu": 1.0} if "e0.7" in name else {"e": 0.3, "D": 0.05, "mu": 0.9}
    wanted = {**case, "kappa": 1.2, "gamma": 1e-4, "transient_periods": 300, "multiplicity_tolerance": 1e-2}
    wanted |= {"fmu_guid": found.guid, "fmu_model": found.name, "fmi_version": "2.0"}
    assert {key: data.attrs[key] for key in wanted} == wanted
    assert __version__ in data.attrs["source"] and data.attrs["title"]
    identity = json.loads(data.attrs["identity"])
    assert identity["etas"] == data.eta.values.tolist()
    assert identity["case"] == {**case, "kappa": 1.2, "gamma": 1e-4}
    assert (identity["transient"], identity["samples"], identity["fmu_guid"]) == (300, 40, found.guid)


@pytest.mark.parametrize("name", NAMES[:1])
def test_netcdf4_reads_units_and_meanings_of_all_variables(done, name):
    with netCDF4.Dataset(done.result(name)) as data:
        assert data.data_model == "NETCDF4"
        numeric = {key: variable for key, variable in data.variables.items() if variable.dtype is not str}
        assert {"eta", "sample", "period", "xi_rel", "xi_rel_max", "end_state", "multiplicity"} <= set(numeric)
        assert all(variable.units == "1" and variable.long_name for variable in numeric.values())
        assert not np.ma.is_masked(data["xi_rel"][:]) and np.isfinite(data["xi_rel"][:]).all()


@pytest.mark.parametrize("name", NAMES[:3])
@pytest.mark.parametrize("index", [0, 1, 7])
def test_the_numbers_are_those_of_the_fmu_driven_by_hand(datasets, name, index, fmu):
    # any grid gives the same bits (contract 2); samples inside a step are taken at its equal parts, which rounding moves by 1e-13
    data = datasets[name]
    eta = float(data.eta[index])
    start = data.end_state.values[index - 1] if index else np.zeros(4)
    damping = 2.0 * data.attrs["D"]
    values = {"e": data.attrs["e"], "m2": data.attrs["mu"], "d1": damping, "d2": damping * data.attrs["mu"]}
    values |= dict(zip(("x1_start", "x2_start", "v1_start", "v2_start"), map(float, start), strict=True))
    period = 2.0 * math.pi / eta
    with Instance(fmu) as instance:
        instance.initialize(**values, k2=1.2, gamma=1e-4, box_amplitude=1.0 / (eta * eta), box_frequency=eta)
        instance.step(0.0, 300 * period)
        before, time = instance.get("impact_count")[0], 300 * period
        for sample in (301, 302, 323, 340):
            instance.step(time, sample * period)
            time = sample * period
            assert float(data.xi_rel.sel(sample=sample)[index]) == pytest.approx(instance.get("x_rel")[0], abs=1e-11)
        assert data.end_state.values[index].tolist() == instance.get("x1", "x2", "v1", "v2")
        assert float(data.impacts_per_period[index]) == (instance.get("impact_count")[0] - before) / 40


def test_contact_counts_where_samples_are_taken_and_only_there(fmu):
    rest = (0.0, 0.0, 0.0, 0.0)

    def contact(case, transient, samples):
        with Instance(fmu) as instance:
            return respond(instance, Plan(case, (1.4,), transient, samples, 1e-2, ""), 1.4, rest).permanent_contact

    assert contact(Case(e=0.3), 0, 65)  # chattering at first
    assert not contact(Case(e=0.3), 60, 5)
    assert contact(Case(kappa=1.0), 60, 5)  # equal halves never part: contact that began before


def test_up_and_down_differ_where_responses_are_non_unique(datasets):
    up, down = datasets[NAMES[0]], datasets[NAMES[1]].sel(eta=datasets[NAMES[0]].eta)
    np.testing.assert_array_equal(datasets[NAMES[1]].eta.values, up.eta.values[::-1])
    ratio = up.xi_rel_max / down.xi_rel_max
    assert float(ratio.max()) > 1.5
    assert float(ratio.sel(eta=1.28)) == pytest.approx(1.0, abs=1e-3)


def test_more_samples_than_fit_into_one_step(fmu):
    eta, samples, rest = 1.2, 453, (0.0, 0.0, 0.0, 0.0)
    period = 2.0 * math.pi / eta
    with Instance(fmu) as instance:
        response = respond(instance, Plan(Case(), (eta,), 3, samples, 1e-2, ""), eta, rest)
        instance.reset()
        instance.initialize(box_amplitude=1.0 / (eta * eta), box_frequency=eta)
        gaps = []
        for n in range(samples + 3):
            instance.step(n * period, (n + 1) * period)
            gaps += instance.get("x_rel")
        assert instance.get("x1", "x2", "v1", "v2") == list(response.end)
    np.testing.assert_allclose(response.xi_rel, gaps[3:], rtol=0.0, atol=1e-11)
    assert np.ptp(gaps[3:]) > 0.1


def test_the_largest_gap_is_that_between_the_samples_too(fmu):
    eta, parts, rest = 1.2, 400, (0.0, 0.0, 0.0, 0.0)
    period = 2.0 * math.pi / eta
    with Instance(fmu) as instance:
        peaks = [respond(instance, Plan(Case(), (eta,), transient, 1, 1e-2, ""), eta, rest).xi_rel_max for transient in range(8)]
        instance.reset()
        instance.initialize(box_amplitude=1.0 / (eta * eta), box_frequency=eta, x_rel_max_on=False)
        gaps = []
        for n in range(8 * parts):
            instance.step(n * period / parts, (n + 1) * period / parts)
            gaps += instance.get("x_rel")
    seen = np.max(np.reshape(gaps, (8, parts)), axis=1)
    np.testing.assert_allclose(peaks, seen, rtol=2e-3)
    assert (peaks >= seen).all()


@pytest.mark.parametrize("form", FORMS[1:])
def test_every_form_of_the_fmu_gives_the_same_bits(tmp_path, form):
    if not exported(form):
        pytest.skip(f"no {form} here")
    results = []
    for name in ("fmi2-python", form):
        sweeps = Sweeps(tmp_path / name, exported(name))
        sweeps.run("--eta", "1.2:1.24:0.01", "--transient", "20", "--samples", "250").success()
        results.append(xarray.load_dataset(sweeps.result()))
    assert results[0].equals(results[1])
    assert results[0].fmu_guid != results[1].fmu_guid


def test_pictures_show_something(done):
    pictures = [image.imread(done.output / f"{name}.png") for name in NAMES]
    for picture in pictures:
        grey = picture[..., :3].mean(axis=2)
        assert min(grey.shape) > 300
        assert 0.001 < (grey < 0.5).mean() < 0.5  # dots, frame and labels on white
        assert (grey[: grey.shape[0] // 2] < 0.5).any() and (grey[grey.shape[0] // 2 :] < 0.5).any()
    assert not np.array_equal(pictures[0], pictures[2])


def test_one_process_after_the_other_gives_the_same_bytes(done, tmp_path, fmu):
    again = Sweeps(tmp_path, fmu)
    again.run(*SWEEP, "--direction", "both", "--jobs", "1").success()
    assert [again.result(name).read_bytes() for name in NAMES[:2]] == [done.result(name).read_bytes() for name in NAMES[:2]]


def test_the_default_range_has_7901_values_and_both_ends():
    etas, is_range = parse_etas("0.1:8.0:0.001")
    assert is_range and (len(etas), etas[0], etas[-1]) == (7901, 0.1, 8.0)
    assert list(etas) == [float(f"{n / 1000:.3f}") for n in range(100, 8001)]


@given(st.integers(1, 10**7), st.integers(1, 10**5), st.integers(0, 300))
def test_a_range_has_its_decimal_values_exactly(first, step, count):
    def text(n):
        return f"{n // 10000}.{n % 10000:04d}"

    grid = [text(first + k * step) for k in range(count + 1)]
    etas, _ = parse_etas(f"{grid[0]}:{grid[-1]}:{text(step)}")
    assert etas == tuple(map(float, grid))


def test_a_list_is_taken_in_its_own_order(sweeps):
    sweeps.run("--eta", "1.31, 1.28,2", "--transient", "3", "--samples", "2").success()
    data = xarray.load_dataset(sweeps.result("orbit_e0.7_D0.005_list"))
    assert data.eta.values.tolist() == [1.31, 1.28, 2.0]
    assert sweeps.files() == ["orbit_e0.7_D0.005_list.nc", "orbit_e0.7_D0.005_list.png"]


@pytest.mark.slow
def test_build_writes_the_same_fmu_twice(tmp_path):
    import subprocess
    import sys

    for folder in ("one", "two"):
        command = [sys.executable, "-m", "orchestrate", "build", "--folder", str(tmp_path / folder)]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0 and str(tmp_path / folder) in done.stdout, done.stderr
    names = sorted(path.relative_to(tmp_path / "one") for path in (tmp_path / "one").rglob("*.fmu"))
    assert names
    assert all((tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes() for name in names)
