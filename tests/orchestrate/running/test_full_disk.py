"""A full disk ends a job with one line; what was computed is kept, and the job goes on later."""

from __future__ import annotations

import subprocess

import pytest

from orchestrate.errors import StoreError
from orchestrate.running.runner import compute_dataset

from .sums import Noise


@pytest.fixture
def small_disk(tmp_path):
    """A small file system; and a function that gives it another size."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=200k", "none", str(folder)]
    try:
        mounted = subprocess.run(mount, capture_output=True).returncode == 0
    except OSError:
        mounted = False
    if not mounted:
        pytest.skip("file systems cannot be mounted here")

    def resize(size: str) -> None:
        subprocess.run(["mount", "-o", f"remount,size={size}", str(folder)], check=True)

    yield folder, resize
    subprocess.run(["umount", "-l", str(folder)], check=True)  # a failed write may hold its file


@pytest.mark.parametrize("room", ["200k", "480k"])  # full at a chunk, full at the result
def test_it_goes_on_when_there_is_room(find, tmp_path, small_disk, monkeypatch, room, pytestconfig):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    folder, resize = small_disk
    resize(room)
    whole = tmp_path / "whole.nc"
    compute_dataset(Noise("noise"), {"store": whole}, find)
    with pytest.raises(StoreError) as caught:
        compute_dataset(Noise("noise"), {"store": folder / "noise.nc"}, find)
    assert "\n" not in str(caught.value)
    assert str(folder) in str(caught.value)
    assert not (folder / "noise.nc").exists()
    resize("4m")
    compute_dataset(Noise("noise"), {"store": folder / "noise.nc"}, find)
    assert (folder / "noise.nc").read_bytes() == whole.read_bytes()
    left = {path.suffix for path in folder.iterdir()} - {".nc"}
    # NetCDF's library keeps the file open that it could not finish: the next process removes it
    assert not left or (pytestconfig.option.held_files and left == {".tmp"})


def test_a_read_only_folder(find, small_disk):
    folder, _ = small_disk
    subprocess.run(["mount", "-o", "remount,ro", str(folder)], check=True)
    with pytest.raises(StoreError, match="expected a folder that can be written"):
        compute_dataset(Noise("noise"), {"store": folder / "noise.nc"}, find)
