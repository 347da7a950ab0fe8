"""``orchestrate paper``: bad input in one line, killed and resumed, the same bytes on a cluster that loses a worker."""

import os
import re
import signal
import subprocess
import sys
import time

import pytest

from .command import ROOT, children, is_alive
from .conftest import exported
from .papers import Papers

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="process groups and /proc")
MAP = "map_D"
PARTS = ("--figures", "maps")


@pytest.fixture(scope="module")
def event_fmu():
    """The FMI 3.0 FMU."""
    return exported("fmi3") or pytest.skip("no fmi3 here")


@pytest.fixture
def papers(tmp_path, event_fmu):
    """Paper commands in a folder of the test's own."""
    commands = Papers(tmp_path, event_fmu)
    yield commands
    commands.clean_up()


@pytest.fixture(scope="module")
def whole_maps(tmp_path_factory, event_fmu):
    """Bytes of the maps' result files, computed in one go."""
    commands = Papers(tmp_path_factory.mktemp("maps"), event_fmu)
    try:
        commands.run(*PARTS).success()
        assert {"maps.png", "maps.pdf", "report.html"} <= set(commands.files())
        return {name: commands.result(name).read_bytes() for name in ("map_e", "map_D", "map_kappa")}
    finally:
        commands.clean_up()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--figures", "4"), ("--figures 4", "allowed are", "12", "maps")),
        (("--figures", "5,,7"), ("--figures", "nothing")),
        (("--jobs", "0"), ("--jobs 0", ">= 1")),
        (("--cluster", "tcp://127.0.0.1:1", "--figures", "spectra"), ("--cluster tcp://127.0.0.1:1", "no scheduler")),
    ],
)
def test_bad_input_is_one_line(papers, options, words):
    papers.run(*options).complaint(*words)
    assert not [name for name in papers.files() if name.endswith(".nc")]


def test_an_fmu_without_events_is_refused(papers):
    papers.fmu = exported("fmi2") or pytest.skip("no fmi2 here")
    papers.run(*PARTS).complaint("FMI 2.0", "FMI 3.0")


def test_a_result_of_another_run_is_refused(papers):
    papers.output.mkdir(parents=True)
    papers.result("map_e").write_bytes(b"something else")
    papers.run(*PARTS).complaint("map_e.nc", "not a result")
    assert papers.result("map_e").read_bytes() == b"something else"


def test_kill_9_loses_no_finished_chunk(papers, whole_maps):
    process = papers.start(*PARTS)
    seen = papers.wait_for_chunks(process, MAP, 3)
    papers.kill(process)
    kept, finished = papers.chunks(MAP), papers.result("map_e").read_bytes()
    assert kept >= seen and not papers.result(MAP).exists()
    done = papers.run(*PARTS).success()
    assert done.counts[0] >= kept, "it began anew"
    assert finished == whole_maps["map_e"]
    assert {name: papers.result(name).read_bytes() for name in whole_maps} == whole_maps
    assert not [name for name in papers.files() if name.endswith((".journal", ".tmp", ".lock"))]


def all_end(pids):
    """Whether all processes end within a while; the spawned processes' resource tracker takes its own time."""
    stop = time.monotonic() + 20.0
    while any(map(is_alive, pids)) and time.monotonic() < stop:
        time.sleep(0.05)
    return not any(map(is_alive, pids))


def test_ctrl_c_is_one_line_and_leaves_nothing_running(papers):
    process = papers.start(*PARTS)
    seen = papers.wait_for_chunks(process, "map_e", 2)
    below = list(children(process.pid))
    done = papers.kill(process, signal.SIGINT)
    assert done.complaint("interrupted", "goes on from here", code=130)
    assert papers.chunks("map_e") >= seen
    assert below and all_end(below)


def test_workers_end_when_their_parent_is_killed(papers):
    process = papers.start(*PARTS)
    papers.wait_for_chunks(process, "map_e", 2)
    below = [pid for pid, command in children(process.pid).items() if "spawn_main" in command]
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert len(below) == (os.cpu_count() or 1) and all_end(below)


def test_a_sequential_sweep_goes_on_after_kill_9(papers, tmp_path, event_fmu):
    options, name = ("--figures", "5"), "orbit_e0.7_D0.005_up"
    process = papers.start(*options)
    seen = papers.wait_for_chunks(process, name, 2)
    papers.kill(process)
    assert papers.chunks(name) >= seen
    papers.run(*options).success()
    other = Papers(tmp_path / "other", event_fmu)
    other.run(*options).success()
    assert papers.result(name).read_bytes() == other.result(name).read_bytes()
    assert papers.result("figure5").read_bytes() == other.result("figure5").read_bytes()


def test_finished_parts_are_not_computed_again(papers, whole_maps):
    papers.output.mkdir(parents=True)
    for name, content in whole_maps.items():
        papers.result(name).write_bytes(content)
    done = papers.run(*PARTS).success()
    assert done.counts == []  # no bar, no workers
    assert {name: papers.result(name).read_bytes() for name in whole_maps} == whole_maps


@pytest.fixture
def cluster(tmp_path):
    """Address of a Dask scheduler on loopback, and its two workers, each a process without a nanny."""
    pytest.importorskip("distributed")
    started = []

    def start(*arguments):
        log = (tmp_path / f"dask{len(started)}.log").open("w+")
        command = [sys.executable, "-m", "dask", *arguments]
        started.append(subprocess.Popen(command, cwd=ROOT, stdout=log, stderr=subprocess.STDOUT, start_new_session=True))
        return started[-1], log

    def wait_for(log, pattern):
        stop = time.monotonic() + 60.0
        while not (found := re.search(pattern, (log.seek(0), log.read())[1])):
            assert time.monotonic() < stop, log.read()
            time.sleep(0.05)
        return found

    try:
        _, log = start("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        address = wait_for(log, r"tcp://127\.0\.0\.1:\d+").group()
        place = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--local-directory", str(tmp_path))
        workers = [start("worker", address, *place) for _ in range(2)]
        for _, log in workers:
            wait_for(log, "Registered to")
        yield address, [process for process, _ in workers]
    finally:
        for process in started:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def test_a_worker_lost_on_a_cluster_loses_nothing(papers, cluster, whole_maps):
    address, workers = cluster
    process = papers.start(*PARTS, "--cluster", address)
    papers.wait_for_chunks(process, "map_e", 3)
    os.kill(workers[0].pid, signal.SIGKILL)
    done = papers.end(process)
    assert done.code == 0, done.err
    assert workers[1].poll() is None
    assert {name: papers.result(name).read_bytes() for name in whole_maps} == whole_maps
