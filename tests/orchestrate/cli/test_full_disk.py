"""A limit of file sizes ends a command in one line; what is stored is kept, and it resumes."""

import resource

import pytest
import xarray as xr

RUN = ("sweep", "--eta", "1:1.2:0.0005", "--transient", "20", "--samples", "300", "--jobs", "1")


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


@pytest.mark.slow
def test_a_limit_of_file_sizes(commands, ask, tmp_path):
    # as a quota: EFBIG instead of ENOSPC, beyond what the FMU itself needs when it is unpacked
    limit = (900_000, 900_000)
    done = commands.run(*RUN, prepare=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit))
    done.complaint(commands.output, code=1)
    goes_on(commands, ask, tmp_path)
