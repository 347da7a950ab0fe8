"""Every mistake gives a status and a message, and nothing else suffers: not the process, not the
instance, not another one.
"""

from types import SimpleNamespace

import pytest

from .driver import FMUS, run, run_with_output
from .programs.bad_cases import CASES


@pytest.fixture(scope="module", params=["fmi2-python", "fmi2-python, pure", "fmi2"])
def variant(request):
    """An FMI 2.0 form, compiled or pure."""
    form, _, pure = request.param.partition(", ")
    return SimpleNamespace(fmu=FMUS[form], pure=bool(pure), pythonfmu="python" in form)


@pytest.fixture(scope="module")
def outcomes(variant, tmp_path_factory):
    """What became of each case, and the lines each wrote to the error output."""
    folder = tmp_path_factory.mktemp("bad")
    found, done = run_with_output(
        "bad_input.once", variant.fmu, variant.pythonfmu, cwd=folder, pure=variant.pure
    )
    written, key = {}, None
    for line in done.stderr.splitlines():
        if line.startswith("====="):
            key = line[6:]
        else:
            written.setdefault(key, []).append(line)
    return SimpleNamespace(found=found, written=written, pythonfmu=variant.pythonfmu)


@pytest.mark.parametrize("key", CASES)
def test_mistake_is_refused_with_a_message(outcomes, key):
    """A status that is not OK, and a message that names the thing, its value and what is expected.

    Where the importer does not hear what is logged, pythonfmu's message is one line on stderr, and
    only there: nothing is told twice.
    """
    texts = [
        text.removeprefix("python: ")
        for text in CASES[key][2]
        if outcomes.pythonfmu or not text.startswith("python: ")
    ]
    for part in ("first", "free"):
        status, message = outcomes.found[key][part]
        lines = outcomes.written.get(f"{key} {part}", [])
        if outcomes.pythonfmu and part == "free":
            assert message == ""
            (message,) = lines
            assert "'free'" in message  # whose mistake it was
        else:
            assert lines == []
        assert status != 0
        for text in texts:
            assert text in message


@pytest.mark.parametrize("key", CASES)
def test_nothing_else_suffers(outcomes, key):
    assert outcomes.found[key]["reset"], "the instance after fmi2Reset"
    assert outcomes.found[key]["witness"], "the other instance"


def test_a_thousand_mistakes_do_no_harm(variant, tmp_path):
    found = run("bad_input.again", variant.fmu, 1000, cwd=tmp_path, pure=variant.pure)
    assert found == {key: [1000, True] for key in CASES}
