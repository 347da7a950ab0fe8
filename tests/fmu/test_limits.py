"""Known limits: what an importer can still do that is answered by a crash, by silence or by a wrong
number. Each test states what is right.
"""

import json
import shutil
import subprocess
import sys

import pytest

from ..fresh import ROOT
from .driver import DRIVER, FMUS, run

PYTHON = FMUS["fmi2-python"]
BOUND = "pythonfmu's library: out of the slave's reach"


def limit(reason, **more):
    return pytest.mark.xfail(strict=True, reason=reason, **more)


@limit(
    f"{BOUND}; it decodes no other character of a file URI than the space, finds no script there and crashes"
)
@pytest.mark.parametrize("place", ["Jörg", "50 % off"])
def test_extracted_below_a_folder_with_special_letters(tmp_path, place):
    """On Windows the temporary folder has the user's name in it."""
    script = "answer(open_fmu(PATH, folder=fmpy.extract(PATH, sys.argv[2])).start().step(1.0).get('phase'))"
    assert run(script, PYTHON, tmp_path / place, cwd=tmp_path) == [pytest.approx(0.4)]


@limit(
    f"{BOUND}; its own exception for a null pointer releases the references that the slave's exceptions keep"
)
def test_null_pointer_for_a_state(tmp_path):
    script = r"""
    f, refusals = open_fmu(PATH).start(), 0
    for _ in range(100):
        try:
            f.call("setFMUState", None)
        except Refused:
            refusals += 1
    f.reset().start().step(1.0)
    answer(refusals)
    """
    assert run(script, PYTHON, cwd=tmp_path) == 100


@limit(f"{BOUND}; it does not look at the GUID it is given")
def test_guid_of_something_else(tmp_path):
    script = r"""
    f, messages[:] = open_fmu(PATH), []
    resources = Path(Fmu2.folders[PATH], "resources").as_uri().encode()
    made = f.slave.fmi2Instantiate(b"x", 1, b"{00000000-0000-0000-0000-000000000000}", resources, ctypes.byref(callbacks), 0, 1)
    answer([made is None, messages])
    """
    refused, messages = run(script, PYTHON, cwd=tmp_path)
    assert refused and messages


@limit(f"{BOUND}; it gives a value reference to the slave as a signed integer")
def test_value_reference_above_two_to_the_31(tmp_path):
    script = r"""
    try:
        open_fmu(PATH).call("setReal", [4000000000], [1.0])
    except Refused as refused:
        answer("\n".join(refused.messages))
    """
    assert "valueReference = 4000000000" in run(script, PYTHON, cwd=tmp_path)


@limit(
    "pythonfmu logs an exception without a category, so an importer that asks for logStatusError, as the XML offers, gets nothing"
)
def test_log_category_that_the_description_offers(tmp_path):
    script = r"""
    f = open_fmu(PATH)
    f.slave.setDebugLogging(True, ["logStatusError"])
    try:
        f.set(m1=-1.0)
    except Refused as refused:
        answer(refused.messages)
    """
    assert "m1 = -1.0 kg" in "\n".join(run(script, PYTHON, cwd=tmp_path))


@pytest.mark.slow
@limit(
    f"{BOUND}; it destroys an object twice at the end of every process that has loaded it, which now and then aborts the process"
)
def test_end_of_the_process(tmp_path):
    if not shutil.which("valgrind"):
        pytest.xfail("no valgrind here to see it with")
    script = tmp_path / "script.py"
    script.write_text(
        "import sys, json\nfrom pathlib import Path\nanswer = print\n"
        + DRIVER.replace("if PYTHONFMU:", "if False:")
        + "f = open_fmu(PATH).start().step(1.0)\nf.free()\n"
    )
    command = [
        "valgrind",
        "-q",
        "--undef-value-errors=no",
        sys.executable,
        str(script),
        str(PYTHON),
    ]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=500)
    assert done.returncode == 0
    assert "finalizePythonInterpreter" not in done.stderr


def test_serialised_state_with_a_spoilt_number(fmu, tmp_path):
    """NaN in the place of every number in turn: refused, at the latest by the step; never an output
    that is not finite with status OK.
    """
    script = r"""
    data, time = open_fmu(PATH).start(x2_start=0.5).step(3.0).save()
    f, silent = open_fmu(PATH), []
    for place in range(64, len(data), 8):
        if place > 64 + 8 * 46 and place < len(data) - 8 * 120:
            continue  # kept samples
        f.reset()
        try:
            f.restore(data[:place] + b"\xff" * 8 + data[place + 8:], time)
            values = [*f.outputs().values(), *f.step(4.0).outputs().values()]
            if not all(math.isfinite(value) for value in values):
                silent.append(place)
        except Refused:
            pass
    answer(silent)
    """
    assert run(script, fmu, cwd=tmp_path) == []


@limit(
    "currentCommunicationPoint may be off by a billionth of the time itself, which is seconds where the start time is today's date"
)
def test_wrong_point_of_time_where_time_is_the_date(fmu, tmp_path):
    script = r"""
    f = open_fmu(PATH).start(1.7e9).step(1.7e9 + 1.0)
    f.time += 0.5
    try:
        f.step(f.time + 1.0)
        answer("accepted")
    except Refused as refused:
        answer("\n".join(refused.messages))
    """
    assert "expected 1700000001.0 s" in run(script, fmu, cwd=tmp_path)


@limit(
    "beyond 2^62 quarter turns the compiled kernel's integers overflow, those of the source do not"
)
def test_absurd_time_in_source_and_compiled(tmp_path):
    script = r"""
    try:
        answer(open_fmu(PATH).start(bonded=True).step(1e20).outputs())
    except Refused:
        answer("refused")
    """
    assert run(script, PYTHON, cwd=tmp_path, pure=True) == run(script, PYTHON, cwd=tmp_path)


@pytest.mark.slow
@limit(
    "1e8 evaluations are some ten seconds for the compiled kernel, but a quarter of an hour for its source"
)
def test_endless_step_in_the_source_ends(tmp_path):
    script = r"""
    try:
        open_fmu(PATH).start().step(1e10)
    except Refused as refused:
        answer(refused.messages)
    """
    try:
        messages = run(script, PYTHON, cwd=tmp_path, pure=True, timeout=60)
    except subprocess.TimeoutExpired:
        pytest.fail("no end within a minute")
    assert "cannot finish" in messages[0]


@limit(
    "the project's own access switches the line on stderr off for the whole process, for good, and for its children"
)
def test_own_access_leaves_other_importers_their_messages(tmp_path):
    """A notebook that has used the project's functions, then FMPy itself: a discarded step must not
    go unnoticed.
    """
    script = f"""
import sys, fmpy, numpy
from orchestrate.fmu import Instance
with Instance({str(PYTHON)!r}) as instance:
    instance.initialize()
signal = numpy.array([(0.0, 0.9), (4.5, 0.9), (4.5, 1.0), (10.0, 1.0)], dtype=[("time", "f8"), ("box_frequency", "f8")])
fmpy.simulate_fmu({str(PYTHON)!r}, stop_time=10.0, output_interval=1.0, start_values={{"d1": 0.0}}, output=["x1"], input=signal)
"""
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True)
    assert "natural frequency of mass 1" in done.stderr


@limit("an answer that is not finite is refused without naming the variable that makes it so")
@pytest.mark.parametrize(
    ("values", "culprit"),
    [
        ({"box_frequency": 1e-155, "x2_start": 1.0}, "x2_start = 1.0"),
        ({"bonded": True, "box_crackle": 1e100}, "box_crackle = 1e+100"),
    ],
)
def test_message_names_what_leaves_the_range(fmu, tmp_path, values, culprit):
    script = r"""
    try:
        open_fmu(PATH).start(**json.loads(sys.argv[2])).step(1e80)
    except Refused as refused:
        answer("\n".join(refused.messages))
    """
    assert culprit in run(script, fmu, json.dumps(values), cwd=tmp_path)
