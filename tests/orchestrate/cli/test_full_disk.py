"""A full disk ends a command with one line; what is stored is kept, the same command goes on."""

from __future__ import annotations

import os
import resource
import subprocess

import pytest
import xarray as xr

RUN = ("sweep", "--eta", "1:1.2:0.0005", "--transient", "20", "--samples", "300", "--jobs", "1")


@pytest.fixture
def resize(commands):
    """Mount a small file system as the folder of the results; gives it another size."""
    commands.output.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=900k", "none", str(commands.output)]
    posix = os.name == "posix" and os.geteuid() == 0
    if not posix or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("file systems cannot be mounted here")

    def resized(size):
        option = f"remount,size={size}"
        subprocess.run(["mount", "-o", option, str(commands.output)], check=True)

    yield resized
    commands.clean_up()
    subprocess.run(["umount", str(commands.output)], check=True)


def whole(ask, tmp_path):
    """The samples of RUN, computed in one go."""
    assert ask(*RUN, output=tmp_path / "whole").code == 0
    (result,) = (tmp_path / "whole").glob("*.nc")
    return xr.load_dataset(result).xi_rel


def goes_on(commands, ask, tmp_path):
    """See that the same command goes on and gives what one in one go does."""
    commands.run(*RUN).success()
    (result,) = commands.output.glob("*.nc")
    assert xr.load_dataset(result).xi_rel.equals(whole(ask, tmp_path))
    assert [n for n in commands.files() if not n.endswith((".nc", ".png"))] == []


@pytest.mark.slow  # 6 s
def test_full_while_chunks_arrive(commands, resize, ask, tmp_path):
    done = commands.run(*RUN)
    done.complaint(commands.output, code=1)
    kept = commands.chunks()
    assert kept and not list(commands.output.glob("*.nc"))
    resize("20m")
    goes_on(commands, ask, tmp_path)


@pytest.mark.slow
def test_a_limit_of_file_sizes(commands, ask, tmp_path):
    # as a quota: EFBIG instead of ENOSPC, beyond what the FMU itself needs when it is unpacked
    limit = (900_000, 900_000)
    done = commands.run(*RUN, prepare=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit))
    done.complaint(commands.output, code=1)
    goes_on(commands, ask, tmp_path)
