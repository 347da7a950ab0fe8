"""Known limits: what an importer can still do that is answered by a crash, by silence or by a wrong
number. Each test states what is right.
"""

import shutil

import pytest

from .driver import FMUS, run, run_with_output
from .programs.driver import open_fmu

PYTHON = FMUS["fmi2-python"]
BOUND = "pythonfmu's library: out of the slave's reach"


def limit(reason, **more):
    return pytest.mark.xfail(strict=True, reason=reason, **more)


@limit(
    f"{BOUND}; it decodes no other character of a file URI than the space, finds no script there "
    "and crashes"
)
@pytest.mark.parametrize("place", ["Jörg", "50 % off"])
def test_extracted_below_a_folder_with_special_letters(tmp_path, place):
    """On Windows the temporary folder has the user's name in it."""
    assert run(
        "limits.extracted_below_a_folder_with_special_letters",
        PYTHON,
        tmp_path / place,
        cwd=tmp_path,
    ) == [pytest.approx(0.4)]


@limit(
    f"{BOUND}; its own exception for a null pointer releases the references that the slave's "
    "exceptions keep"
)
def test_null_pointer_for_a_state(tmp_path):
    assert run("limits.null_pointer_for_a_state", PYTHON, cwd=tmp_path) == 100


@limit(f"{BOUND}; it does not look at the GUID it is given")
def test_guid_of_something_else(tmp_path):
    refused, messages = run("limits.guid_of_something_else", PYTHON, cwd=tmp_path)
    assert refused and messages


@limit(f"{BOUND}; it gives a value reference to the slave as a signed integer")
def test_value_reference_above_two_to_the_31(tmp_path):
    assert "valueReference = 4000000000" in run(
        "limits.value_reference_above_two_to_the_31", PYTHON, cwd=tmp_path
    )


@pytest.mark.slow
@limit(
    f"{BOUND}; it destroys an object twice at the end of every process that has loaded it, which "
    "now and then aborts the process"
)
def test_end_of_the_process(tmp_path):
    if not shutil.which("valgrind"):
        pytest.xfail("no valgrind here to see it with")
    _, done = run_with_output(
        "driver.outputs",
        PYTHON,
        1.0,
        cwd=tmp_path,
        env={"TEST_THE_END": "1"},
        under=("valgrind", "-q", "--undef-value-errors=no"),
        timeout=500,
    )
    assert done.returncode == 0
    assert "finalizePythonInterpreter" not in done.stderr


@limit(
    "currentCommunicationPoint may be off by a billionth of the time itself, which is seconds "
    "where the start time is today's date"
)
def test_wrong_point_of_time_where_time_is_the_date(fmu):
    f = open_fmu(fmu).start(1.7e9).step(1.7e9 + 1.0)
    assert "expected 1700000001.0 s" in f.refused("doStep", 1.7e9 + 1.5, 1.0)


@limit(
    "beyond 2^62 quarter turns the compiled kernel's integers overflow, those of the source do not"
)
def test_absurd_time_in_source_and_compiled(tmp_path):
    found = [run("limits.absurd_time", PYTHON, cwd=tmp_path, pure=pure) for pure in (True, False)]
    assert found[0] == found[1]


@pytest.mark.slow
@limit("1e7 evaluations are a second or two for the compiled kernel, but minutes for its source")
def test_endless_step_in_the_source_ends(tmp_path):
    try:
        messages = run("limits.endless_step", PYTHON, cwd=tmp_path, pure=True, timeout=60)
    except AssertionError:
        pytest.fail("no end within a minute")
    assert "cannot finish" in messages[0]


@limit("an answer that is not finite is refused without naming the variable that makes it so")
def test_message_names_what_leaves_the_range(fmu):
    f = open_fmu(fmu).start(bonded=True, box_crackle=1e100)
    assert "box_crackle = 1e+100" in f.refused("doStep", 0.0, 1e80)
