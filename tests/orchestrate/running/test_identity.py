"""What decides numbers is in an identity: parameters, FMU, and the code behind them."""

import numpy as np
import pytest

from orchestrate.running import identity
from orchestrate.running.identity import describe_difference, digests_of_code
from orchestrate.running.job import format_brief, to_json_data


def package(folder, **sources):
    folder.mkdir(exist_ok=True)
    for name, text in sources.items():
        path = folder.joinpath(*name.split("__")).with_suffix(".py")
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    return folder


def forget():
    """What is read once in a process is read again."""
    for name in ("read_digest_and_imports", "source_file", "digests_of_code"):
        getattr(identity, name).cache_clear()


@pytest.fixture
def ours(tmp_path, monkeypatch):
    monkeypatch.setattr(identity, "PACKAGE", tmp_path / "small")
    monkeypatch.setattr(identity, "ROOT", "small")
    forget()
    yield package(
        tmp_path / "small",
        sweep="from . import tools\nfrom .running import pool\n",
        tools="LIMIT = 1\ndef f():\n    from .deep import g\n",
        deep="def g():\n    return 1\n",
        other="",
        running__pool="",
    )
    forget()


@pytest.mark.parametrize(
    ("file", "text", "told"),
    [
        ("tools.py", "LIMIT = 2\ndef f():\n    from .deep import g\n", "small/tools.py"),
        ("deep.py", "def g():\n    return 2\n", "small/deep.py"),
        ("tools.c", "int limit = 2;", "small/tools.py"),
        ("other.py", "x = 1", ""),
        ("running/pool.py", "x = 1", ""),
    ],
)
def test_an_edit_of_what_decides_numbers_is_seen_and_no_other(ours, file, text, told):
    (ours / "tools.c").write_text("int limit = 1;")
    before = digests_of_code("small.sweep")
    (ours / file).write_text(text)
    forget()
    line = describe_difference({"code": before}, {"code": digests_of_code("small.sweep")})
    assert line == (f"{told} changed since" if told else "")


def test_the_kernel_behind_an_answer_is_among_its_sources():
    digests = digests_of_code("orchestrate.response.multiplicity")
    assert "fmu_src.kernels.repetition" in digests


def test_a_long_list_is_told_by_its_ends_and_a_digest():
    etas = np.arange(100, 8001) / 1000.0
    told = to_json_data(tuple(etas))
    assert (told["first"], told["last"], told["count"], told["step"]) == (0.1, 8.0, 7901, 0.001)
    etas[17] += 1e-15
    assert to_json_data(etas)["sha256"] != told["sha256"]
    assert format_brief(told) == "0.1 ... 8 by 0.001 (7901 values)"
