"""What is complete stays as it is, unless ``--force`` asks for it anew; then it has the same bytes."""

import signal

import netCDF4
import pytest

from .command import NAME, Sweeps, altered_fmu
from .conftest import RUN

SHORT = ("--eta", "1:1.2:0.02", "--transient", "10", "--samples", "20")


@pytest.fixture(scope="module")
def done(tmp_path_factory, fmu):
    """Sweeps with one that is complete."""
    commands = Sweeps(tmp_path_factory.mktemp("finished"), fmu)
    commands.run(*SHORT).success()
    yield commands
    commands.clean_up()


def fingerprint(sweeps):
    """Bytes and times of all results."""
    return {path.name: (path.read_bytes(), path.stat().st_mtime_ns, path.stat().st_ino) for path in sweeps.output.iterdir()}


def test_a_second_identical_command_says_complete(done):
    answer = done.run(*SHORT)
    assert "complete" in answer.out
    answer.success()


def test_a_second_identical_command_touches_nothing(done):
    before = fingerprint(done)
    assert "complete" in done.run(*SHORT).out
    assert fingerprint(done) == before


def test_one_more_case_leaves_the_complete_one(done):
    before = fingerprint(done)
    answer = done.run(*SHORT, "--case", "e=0.7", "--case", "e=0.5").success()
    assert f"{done.result()}: complete" in answer.out
    after = fingerprint(done)
    assert set(after) - set(before) == {"orbit_e0.5_D0.005_up.nc", "orbit_e0.5_D0.005_up.png"}
    assert {name: after[name] for name in before} == before


def test_force_computes_the_same_bytes_anew(done):
    before = fingerprint(done)
    answer = done.run(*SHORT, "--force").success()
    assert answer.counts[0] == 0
    after = fingerprint(done)
    for name in (f"{NAME}.nc", f"{NAME}.png"):
        assert after[name][0] == before[name][0]
        assert after[name][1:] != before[name][1:]


@pytest.mark.parametrize("option", [("--samples", "21"), ("--transient", "11"), ("--tolerance", "0.02"), ("--eta", "1:1.2:0.04")])
def test_a_result_of_another_run_is_refused(done, option):
    before = fingerprint(done)
    line = done.run(*SHORT, *option).complaint(done.result(), "another run", "--output", "--force")
    assert option[0].strip("-") in line
    assert fingerprint(done) == before


def test_a_result_of_another_fmu_is_refused(done, tmp_path):
    guid = netCDF4.Dataset(done.result()).fmu_guid
    other = Sweeps(tmp_path, altered_fmu(done.fmu, tmp_path / "other.fmu", guid=(guid, guid.replace("{", "{f"))))
    other.output = done.output
    other.run(*SHORT).complaint("fmu_guid", guid)


def test_force_replaces_a_result_of_another_run(sweeps):
    sweeps.output.mkdir()
    sweeps.result().write_bytes(b"anything")
    sweeps.run(*SHORT, "--force").success()
    assert netCDF4.Dataset(sweeps.result()).title


def test_a_failed_picture_is_drawn_by_the_same_command(sweeps):
    picture = sweeps.result().with_suffix(".png")
    picture.mkdir(parents=True)  # stands for a full disk, or a kill, at that moment
    sweeps.run(*SHORT).complaint(picture, code=1)
    picture.rmdir()
    sweeps.run(*SHORT).success()
    assert sweeps.files() == [sweeps.result().name, picture.name]


@pytest.mark.slow
def test_interrupted_force_goes_on(sweeps):
    process = sweeps.start(*RUN, "--force")
    kept = sweeps.wait_for_rows(process, 30)
    sweeps.kill(process, signal.SIGINT).complaint("the same command goes on", code=130)
    assert sweeps.run(*RUN, "--force").success().counts[0] >= kept
