"""``python -m orchestrate couple`` as its users run it: results, going on after a kill, and mistakes that are named."""

import functools
import os
import signal
import subprocess
import sys
import time

import pytest
import xarray

from .command import ROOT

RUN = ("--structure", "delaminated", "--eta0", "1.4:1.46", "--rate", "5e-5", "--settle", "50", "--step", "0.1")
NAME = "couple_quick_delaminated"


def command(folder, *arguments, **options):
    """Run the command to its end."""
    line = [sys.executable, "-m", "orchestrate", "couple", *arguments, "--output", str(folder)]
    return subprocess.run(line, cwd=ROOT, capture_output=True, text=True, timeout=200, **options)


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("uninterrupted")
    done = command(folder, *RUN)
    assert done.returncode == 0, done.stderr
    return folder, done.stdout


def test_result(uninterrupted):
    folder, out = uninterrupted
    assert sorted(path.name for path in folder.iterdir()) == ["couple_quick.png", f"{NAME}.nc"]
    with xarray.open_dataset(folder / f"{NAME}.nc") as data:
        assert data.sizes["revolution"] > 400
        assert data.Omega.attrs["long_name"] and data.attrs["structure"] == "delaminated"
        assert abs(data.attrs["missing_over_motor_work"]) < 1e-6
    assert f"{NAME}.nc: " in out and "jump up none" in out and "do not prove accuracy" in out


def test_a_motor_that_does_not_turn(tmp_path):
    done = command(tmp_path, "--structure", "bonded", "--eta0", "0:0.001", "--rate", "1e-3", "--settle", "0", "--one-way")
    assert done.returncode == 2 and "not one revolution" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="signals")
@pytest.mark.parametrize("kind", [signal.SIGKILL, signal.SIGINT])
def test_goes_on_after_an_end_by_force(uninterrupted, tmp_path, kind):
    line = [sys.executable, "-m", "orchestrate", "couple", *RUN, "--output", str(tmp_path)]
    attentive = functools.partial(signal.signal, signal.SIGINT, signal.default_int_handler)  # where the tests run in the background it is ignored
    process = subprocess.Popen(line, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=attentive)
    journal = tmp_path / f"{NAME}.nc.journal-wal"
    deadline = time.monotonic() + 60.0
    while not (journal.exists() and journal.stat().st_size > 30_000):
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.002)
    os.kill(process.pid, kind)
    _, text = process.communicate(timeout=60)
    assert process.returncode in (-signal.SIGKILL, 130)
    assert kind == signal.SIGKILL or "interrupted: nothing computed is lost" in text
    assert not (tmp_path / f"{NAME}.nc").exists()
    done = command(tmp_path, *RUN)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / f"{NAME}.nc").read_bytes() == (uninterrupted[0] / f"{NAME}.nc").read_bytes()


def test_a_finished_result_is_left_and_another_is_refused(uninterrupted):
    folder, _ = uninterrupted
    before = (folder / f"{NAME}.nc").stat().st_mtime_ns
    assert command(folder, *RUN).returncode == 0
    other = command(folder, *RUN[:-1], "0.05")
    assert other.returncode == 2 and "holds another run (h = 0.1 there, 0.05 here)" in other.stderr
    assert (folder / f"{NAME}.nc").stat().st_mtime_ns == before


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--setup", "rig"], ["--setup rig", "quick, beam"]),
        (["--structure", "glued"], ["--structure glued", "bonded, delaminated, both"]),
        (["--algorithm", "euler"], ["--algorithm euler", "jacobi", "rollback"]),
        (["--eta0", "1.2"], ["--eta0 1.2", "FIRST:LAST"]),
        (["--eta0", "nan:2"], ["--eta0 nan:2", "FIRST:LAST"]),
        (["--eta0", "1:1"], ["--eta0 1:1", "FIRST != LAST"]),
        (["--rate", "0"], ["--rate 0.0", "1e-09 <= rate <= 1"]),
        (["--rate", "nan"], ["--rate nan", "allowed"]),
        (["--rate", "1e-9", "--step", "1e-4"], ["--rate 1e-09", "steps"]),
        (["--step", "-0.1"], ["--step -0.1", "0.0001 <= step <= 1"]),
        (["--increment", "2"], ["--increment 2.0", "0 <= increment"]),
        (["--settle", "-1"], ["--settle -1.0", "0 <= settle"]),
        (["--shaker", "build/fmi2/TwoMassImpactOscillator.fmu"], ["TwoMassImpactOscillator", "allowed is MotorShaker"]),
        (["--oscillator", "nowhere.fmu"], ["nowhere.fmu: no such file"]),
        (["--ssp", "/nowhere/x.ssp"], ["--ssp /nowhere/x.ssp", "can be written"]),
    ],
)
def test_mistakes(tmp_path, arguments, parts):
    done = command(tmp_path / "results", *arguments)
    assert done.returncode == 2, (done.stdout, done.stderr)
    assert "Traceback" not in done.stderr and len(done.stderr.strip().splitlines()) == 1
    assert all(part in done.stderr for part in parts), done.stderr
    assert not (tmp_path / "results").exists()
