"""Files appear whole, also where two processes write the same one at once."""

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from orchestrate import files
from orchestrate.files import open_folder, write_whole


def test_two_processes_write_one_file_at_once(tmp_path, monkeypatch):
    """As two commands draw the same picture: neither takes the other's half-written file."""
    path = tmp_path / "couple.png"
    others = []

    def write(temporary):
        temporary.write_text("mine, ")
        with monkeypatch.context() as other:
            other.setattr(files.os, "getpid", os.getppid)
            write_whole(path, lambda place: others.append(place) or place.write_text("other"))
        assert others != [temporary] and path.read_text() == "other"
        with temporary.open("a") as file:
            file.write("whole")

    write_whole(path, write)
    assert path.read_text() == "mine, whole"
    assert [left.name for left in tmp_path.iterdir()] == ["couple.png"]


def test_what_a_killed_process_left_of_its_look_at_a_folder_goes(tmp_path, monkeypatch):
    with monkeypatch.context() as killed:
        killed.setattr(Path, "unlink", lambda *_, **__: None)
        killed.setattr(files.os, "getpid", lambda: 2**22 + 1)  # more than Linux gives
        open_folder(tmp_path)
    assert len(list(tmp_path.iterdir())) == 1
    open_folder(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_threads_of_one_process_open_a_folder_at_the_same_time(tmp_path):
    with ThreadPoolExecutor(8) as threads:
        found = list(threads.map(open_folder, [tmp_path / "new"] * 2000))
    assert found == [tmp_path / "new"] * 2000
    assert list((tmp_path / "new").iterdir()) == []
