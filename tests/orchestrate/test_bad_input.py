"""A user's mistake: one line that names the thing, its value and what is allowed, before any work is done."""

import netCDF4
import pytest

from orchestrate import __main__
from orchestrate.commands.sweep_command import MODEL

from .command import Sweeps, altered_fmu

USAGE = "usage: python -m orchestrate"
BAD = [
    (["--eta", "0"], ["--eta 0:", "> 0"]),
    (["--eta", "-1"], ["--eta -1:", "> 0"]),
    (["--eta=-1:2:0.5"], ["--eta -1:2:0.5:", "0 < FIRST"]),
    (["--eta", "0:2:0.5"], ["--eta 0:2:0.5:", "0 < FIRST"]),
    (["--eta", "nan"], ["--eta nan:", "numbers"]),
    (["--eta", "1:nan:0.1"], ["--eta 1:nan:0.1:", "numbers"]),
    (["--eta", "inf"], ["--eta inf:", "numbers"]),
    (["--eta", "1e7"], ["--eta 1e7:", "<= 1e6"]),
    (["--eta", "abc"], ["--eta abc:", "not numbers", "FIRST:LAST:STEP"]),
    (["--eta", ""], ["--eta", "not numbers"]),
    (["--eta", "1,2,"], ["--eta 1,2,:", "not numbers"]),
    (["--eta", "1:2"], ["--eta 1:2:", "FIRST:LAST:STEP"]),
    (["--eta", "1:2:0.5:3"], ["--eta 1:2:0.5:3:", "FIRST:LAST:STEP"]),
    (["--eta", "2:1:0.1"], ["--eta 2:1:0.1:", "FIRST <= LAST"]),
    (["--eta", "1:2:0"], ["--eta 1:2:0:", "STEP > 0"]),
    (["--eta=1:2:-0.1"], ["--eta 1:2:-0.1:", "STEP > 0"]),
    (["--eta", "1:2:1e-9"], ["--eta 1:2:1e-9:", "ten million"]),
    (["--eta", "1,2", "--direction", "down"], ["--direction down", "1,2", "own order"]),
    (["--case", "f=1"], ["f=1", "e, gamma, kappa, mu"]),
    (["--case", "e:1"], ["e:1", "allowed are"]),
    (["--case", "e=abc"], ["e = abc", "not a number"]),
    (["--case", "e="], ["e = nothing", "not a number"]),
    (["--case", "e=1.2"], ["e = 1.2", "0 <= e <= 1"]),
    (["--case", "e=-0.1"], ["e = -0.1", "0 <= e <= 1"]),
    (["--case", "e=nan"], ["e = nan", "0 <= e <= 1"]),
    (["--case", "D=-0.01"], ["D = -0.01", "0 <= D"]),
    (["--case", "D=inf"], ["D = inf", "0 <= D"]),
    (["--case", "gamma=0"], ["gamma = 0", "1e-09 <= gamma <= 1"]),
    (["--case", "gamma=2"], ["gamma = 2", "<= gamma <= 1"]),
    (["--case", "mu=0"], ["mu = 0", "<= mu <="]),
    (["--case", "mu=-1"], ["mu = -1", "<= mu <="]),
    (["--case", "kappa=0"], ["kappa = 0", "<= kappa <="]),
    (["--case", "e=0.3", "--case", "D=0.005,e=0.3"], ["same parameter set twice"]),
    (["--samples", "0"], ["--samples 0", ">= 1"]),
    (["--transient", "-1"], ["--transient -1", ">= 0"]),
    (["--jobs", "0"], ["--jobs 0", ">= 1"]),
    (["--tolerance", "0"], ["--tolerance 0", "> 0"]),
    (["--tolerance", "nan"], ["--tolerance nan", "> 0"]),
    (["--tolerance", "inf"], ["--tolerance inf", "> 0"]),
]
SYNTAX = [
    (["--bogus", "1"], ["--bogus"]),
    (["--samples", "1.5"], ["--samples", "'1.5'", "int"]),
    (["--samples", "many"], ["--samples", "'many'", "int"]),
    (["--tolerance", "tight"], ["--tolerance", "'tight'", "float"]),
    (["--direction", "sideways"], ["--direction", "'sideways'", "up", "down", "both"]),
    (["--output"], ["--output", "expected one argument"]),
]


def refusal(capsys, fmu, output, *options):
    """Refuse a sweep, in this process; returns the one line that says why."""
    code = __main__.main(["sweep", "--fmu", str(fmu), "--output", str(output), *options])
    out, err = capsys.readouterr()
    assert code == 2
    assert out == ""
    assert err.startswith("error: ") and err.count("\n") == 1, err
    return err


@pytest.mark.parametrize(("options", "words"), BAD, ids=lambda value: " ".join(value))
def test_bad_value(capsys, tmp_path, fmu, options, words):
    options = options if "--eta" in " ".join(options) else ["--eta", "1", *options]
    line = refusal(capsys, fmu, tmp_path / "results", *options)
    assert all(word in line for word in words), line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("options", "words"), SYNTAX, ids=lambda value: " ".join(value))
def test_bad_option(capsys, tmp_path, fmu, options, words):
    with pytest.raises(SystemExit) as ended:
        __main__.main(["sweep", "--fmu", str(fmu), "--output", str(tmp_path / "results"), *options])
    out, err = capsys.readouterr()
    *usage, line = err.splitlines()
    assert (ended.value.code, out) == (2, "")
    assert usage[0].startswith(USAGE) and "error" not in "".join(usage)
    assert "error: " in line and all(word in line for word in words), line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [[], ["swep"], ["--eta", "1"]])
def test_no_such_command(capsys, arguments):
    with pytest.raises(SystemExit) as ended:
        __main__.main(arguments)
    err = capsys.readouterr().err
    assert ended.value.code == 2
    assert err.startswith(USAGE) and "COMMAND" in err and err.count("error: ") == 1


def random_bytes(folder, _):
    path = folder / "random.fmu"
    path.write_bytes(bytes(range(256)) * 20)
    return path


def cut_off(folder, fmu):
    path = folder / "cut.fmu"
    path.write_bytes(fmu.read_bytes()[:-2000])
    return path


def empty_file(folder, _):
    path = folder / "empty.fmu"
    path.touch()
    return path


def foreign(folder, fmu):
    return altered_fmu(fmu, folder / "foreign.fmu", modelName=(MODEL, "BouncingBall"))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda folder, _: folder / "missing.fmu", ["no such file", "orchestrate build"]),
        (lambda folder, _: folder, ["no such file"]),
        (random_bytes, ["not readable as an FMU"]),
        (cut_off, ["not readable as an FMU"]),
        (empty_file, ["not readable as an FMU"]),
        (foreign, ["BouncingBall", f"allowed is {MODEL}"]),
    ],
    ids=["missing", "folder", "random", "cut off", "empty", "foreign"],
)
def test_bad_fmu(capsys, tmp_path, fmu, make, words):
    fmu = make(tmp_path, fmu)
    line = refusal(capsys, fmu, tmp_path / "results", "--eta", "1")
    assert all(word in line for word in [f"FMU {fmu}", *words]), line
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize("below", ["", "below/it"])
def test_output_that_is_a_file(capsys, tmp_path, fmu, below):
    (tmp_path / "results").write_text("mine")
    line = refusal(capsys, fmu, tmp_path / "results" / below, "--eta", "1")
    assert f"--output {tmp_path / 'results'}" in line and "allowed is a folder" in line
    assert (tmp_path / "results").read_text() == "mine"


def not_netcdf(path):
    path.write_bytes(b"garbage" * 1000)


def netcdf_of_others(path):
    with netCDF4.Dataset(path, "w") as data:
        data.title = "of others"


def unreadable_identity(path):
    with netCDF4.Dataset(path, "w") as data:
        data.identity = "{"


@pytest.mark.parametrize("make", [not_netcdf, netcdf_of_others, unreadable_identity, lambda path: path.touch(), lambda path: path.mkdir()])
def test_something_else_in_the_place_of_the_result(capsys, tmp_path, fmu, make):
    result = tmp_path / "orbit_e0.7_D0.005_list.nc"
    make(result)
    before = result.read_bytes() if result.is_file() else b""
    line = refusal(capsys, fmu, tmp_path, "--eta", "1")
    assert f"{result}: not a result of this project" in line and "allowed" in line
    assert [path.name for path in tmp_path.iterdir()] == [result.name]
    assert (result.read_bytes() if result.is_file() else b"") == before


@pytest.mark.parametrize("options", [("--eta", "0"), ("--bogus",), ("--eta", "1", "--samples", "0")])
def test_as_a_process(sweeps, options):
    done = sweeps.run(*options)
    assert done.code == 2 and done.out == "" and "Traceback" not in done.err
    assert len([line for line in done.complaints if "error: " in line]) == 1
    assert sweeps.files() == [] and not sweeps.output.exists()


def test_missing_fmu_as_a_process(tmp_path):
    sweeps = Sweeps(tmp_path, tmp_path / "none.fmu")
    sweeps.run("--eta", "1").complaint("none.fmu", "no such file")
    assert not sweeps.output.exists()
