"""Files appear whole, also where two processes write the same one at once."""

import os

from orchestrate import files
from orchestrate.files import write_whole


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
