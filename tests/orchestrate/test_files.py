"""Files appear whole; what is under way is known by its lock, wherever its process runs."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from orchestrate.files import HeldLock, find_or_make, write_atomically
from tests import ROOT

WRITE = """
import os, sys
from orchestrate.files import write_atomically

def write(place):
    place.write_text("half of it")
    print(place, flush=True)
    sys.stdin.readline()
    place.write_text("whole")

write_atomically(sys.argv[1], write)
"""
OTHER_CONTAINER = ["unshare", "--user", "--map-root-user", "--pid", "--fork", "--mount-proc"]


def in_other_containers() -> bool:
    """Whether processes with numbers of their own can be started here."""
    try:
        return subprocess.run([*OTHER_CONTAINER, "true"], capture_output=True).returncode == 0
    except OSError:
        return False


@pytest.fixture
def writer(tmp_path):
    """Starts a process that writes ``out.txt``, up to the middle of it."""
    started = []

    def start(container: list[str]) -> tuple[subprocess.Popen[str], Path]:
        command = [*container, sys.executable, "-c", WRITE, str(tmp_path / "out.txt")]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        started.append(subprocess.Popen(command, cwd=ROOT, start_new_session=True, **pipes))
        return started[-1], Path(started[-1].stdout.readline().strip())

    yield start
    for one in started:
        one.kill()
        one.communicate()


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_one_file_is_written_twice_at_once(tmp_path):
    """As two commands draw the same picture: neither takes the other's half-written file."""
    path = tmp_path / "couple.png"

    def write(temporary):
        temporary.write_text("mine, ")
        write_atomically(path, lambda place: place.write_text("other"))
        assert path.read_text() == "other"
        with temporary.open("a") as file:
            file.write("whole")

    write_atomically(path, write)
    assert path.read_text() == "mine, whole"
    assert names(tmp_path) == ["couple.png"]


@pytest.mark.parametrize("container", [[], OTHER_CONTAINER], ids=["here", "another container"])
def test_what_a_process_writes_stays_until_it_is_killed(writer, tmp_path, container):
    """Whoever cleans up: in another container its number means nothing."""
    if container and not in_other_containers():
        pytest.skip("no containers can be made here")
    for first, second in (([], container), (container, [])):
        process, half = writer(first)
        assert writer(second)[0].communicate("\n")[0] == ""
        assert half.read_text() == "half of it" and (tmp_path / "out.txt").read_text() == "whole"
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()  # until all in it have ended
        assert half.exists()
        write_atomically(tmp_path / "out.txt", lambda place: place.write_text("whole"))
        assert names(tmp_path) == ["out.txt"]


def test_a_lock_whose_file_was_removed_is_not_the_one_of_the_next(tmp_path):
    first = HeldLock(tmp_path / "lock")
    with pytest.raises(BlockingIOError):
        HeldLock(tmp_path / "lock")
    first.release()
    assert names(tmp_path) == []
    second = HeldLock(tmp_path / "lock")
    first.release()  # again: it has nothing to release
    with pytest.raises(BlockingIOError):
        HeldLock(tmp_path / "lock")
    second.release()


def test_two_that_miss_a_file_make_it_once(tmp_path):
    path, made, both = tmp_path / "a", [], threading.Barrier(2)

    def make():
        made.append(path)
        time.sleep(0.05)
        path.touch()

    def ask():
        looks = iter((both.wait, int))  # both look before either makes it

        def is_usable(one):
            there = one.exists()
            next(looks)()
            return there

        assert find_or_make([path], is_usable, make) == path

    threads = [threading.Thread(target=ask) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert made == [path]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_fork_that_ends_releases_nothing(tmp_path):
    script = (
        "import os, sys; from pathlib import Path; from orchestrate.files import HeldLock\n"
        "held = HeldLock(Path(sys.argv[1]))\n"
        "if os.fork() == 0: sys.exit()\n"
        "os.wait()\n"
        "try: HeldLock(Path(sys.argv[1]))\n"
        "except BlockingIOError: print('held')"
    )
    command = [sys.executable, "-W", "ignore", "-c", script, str(tmp_path / "lock")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.stdout == "held\n"
