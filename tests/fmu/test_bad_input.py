"""Every mistake gives a status and a message, and nothing else suffers: not the process, not the
instance, not another one.
"""

import json
from types import SimpleNamespace

import pytest

from .bad_cases import CASES
from .driver import FMUS, run, run_with_output

PREPARE = r"""
cases, repeats = json.loads(Path(sys.argv[2]).read_text()), int(sys.argv[3])


def good(f):
    '''Outputs of a run with parameters of its own: what a reset has to bring back.'''
    return f.start(m2=1.5, x2_start=0.25, **harmonic(1.13)).step(40.0).outputs()


expected = good(open_fmu(PATH))
data, _ = open_fmu(PATH).start().step(1.0).save()
"""
ONCE = (
    PREPARE
    + r"""
lone = open_fmu(PATH).start(**harmonic(1.13))
rows = [lone.step(0.5 * k).outputs() for k in range(1, len(cases) + 1)]
witness = open_fmu(PATH, name="witness").start(**harmonic(1.13))
found = {}
for number, (key, (prepare, fail, _)) in enumerate(cases.items(), 1):
    result = found[key] = {}
    for part in ("first", "free"):
        f = open_fmu(PATH, name=part)
        exec(prepare)
        print("=====", key, part, file=sys.stderr, flush=True)
        try:
            exec(fail)
            result[part] = [OK, ""]
        except Refused as refused:
            result[part] = [refused.status, "\n".join(refused.messages)]
        print("=====", file=sys.stderr, flush=True)
        if part == "first":
            f.call("reset")
            result["reset"] = good(f) == expected
        f.free()  # the second time right after the failure
    result["witness"] = witness.step(0.5 * number).outputs() == rows[number - 1]
gc.collect()
answer(found)
"""
)
# The same call again and again: pythonfmu releases references at each, which shows only after some
# hundred calls.
AGAIN = (
    PREPARE
    + r"""
found = {}
for key, (prepare, fail, _) in cases.items():
    print("=====", key, file=sys.stderr, flush=True)
    f = open_fmu(PATH)
    exec(prepare)
    refusals, code = 0, compile(fail, key, "exec")
    for _ in range(repeats):
        try:
            exec(code)
        except Refused:
            refusals += 1
    gc.collect()
    f.call("reset")
    found[key] = [refusals, good(f) == expected]
    f.free()
    gc.collect()
answer(found)
"""
)


@pytest.fixture(scope="module", params=["fmi2-python", "fmi2-python, pure", "fmi2"])
def variant(request):
    """An FMI 2.0 form, compiled or pure."""
    form, _, pure = request.param.partition(", ")
    return SimpleNamespace(fmu=FMUS[form], pure=bool(pure), pythonfmu="python" in form)


@pytest.fixture(scope="module")
def outcomes(variant, tmp_path_factory):
    """What became of each case, and the lines each wrote to the error output."""
    folder = tmp_path_factory.mktemp("bad")
    (folder / "cases.json").write_text(json.dumps(CASES))
    found, done = run_with_output(
        ONCE, variant.fmu, folder / "cases.json", 1, cwd=folder, pure=variant.pure
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
    """A status that is not OK, and a message that names the thing, its value and what is expected;
    from pythonfmu as a line on stderr too.
    """
    texts = [
        text.removeprefix("python: ")
        for text in CASES[key][2]
        if outcomes.pythonfmu or not text.startswith("python: ")
    ]
    for part in ("first", "free"):
        status, message = outcomes.found[key][part]
        assert status != 0
        for text in texts:
            assert text in message
        if outcomes.pythonfmu:
            (line,) = outcomes.written[f"{key} {part}"]
            for text in [*texts, f"'{part}'"]:  # whose mistake it was
                assert text in line


@pytest.mark.parametrize("key", CASES)
def test_nothing_else_suffers(outcomes, key):
    assert outcomes.found[key]["reset"], "the instance after fmi2Reset"
    assert outcomes.found[key]["witness"], "the other instance"


def test_a_thousand_mistakes_do_no_harm(variant, tmp_path):
    (tmp_path / "cases.json").write_text(json.dumps(CASES))
    found = run(AGAIN, variant.fmu, tmp_path / "cases.json", 1000, cwd=tmp_path, pure=variant.pure)
    assert found == {key: [1000, True] for key in CASES}
