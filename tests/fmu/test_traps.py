"""What pythonfmu 0.7.0 does to an FMU's user, measured, and that this FMU does not pass it on."""

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from ..fresh import ROOT
from .copies import export_copy
from .driver import FMUS, run, run_with_output

PYTHON = FMUS["fmi2-python"]


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    """An FMU of the same model name whose coefficient of restitution is another one."""
    return export_copy(
        tmp_path_factory.mktemp("other"),
        [("models/oscillator/variables.py", '"e", "1", 0.7', '"e", "1", 0.25')],
    )


def test_two_versions_in_one_process_do_not_share_code(other, tmp_path):
    """Same model, script and class names: each has its own defaults and numbers, in whatever order
    they come, and its own states.
    """
    (mine, foreign, again), status = run(
        "traps.two_versions_in_one_process_do_not_share_code", PYTHON, other, "mine", cwd=tmp_path
    )
    assert (mine[0], foreign[0]) == (0.7, 0.25)
    assert again == mine
    assert mine[1] != foreign[1]
    assert status[0] != 0 and "FMU state: expected a state saved by this FMU" in status[1]
    (first, second, third), _ = run(
        "traps.two_versions_in_one_process_do_not_share_code", PYTHON, other, "other", cwd=tmp_path
    )
    assert (first, second, third) == (foreign, mine, foreign)


def test_host_with_modules_of_the_same_names(tmp_path):
    """An importer that is itself written in Python, and has modules named as ours are, keeps them;
    the FMU does not get them.
    """
    plain = run("driver.outputs", PYTHON, 200.0, cwd=tmp_path)
    outputs, replaced, new = run("traps.host_with_modules_of_the_same_names", PYTHON, cwd=tmp_path)
    assert outputs == plain
    assert replaced == []
    assert new
    # the only modules an FMU brings: pythonfmu's, and ours under names with a hash of their
    # contents
    for name in new:
        assert re.match(
            r"pythonfmu(\.|$)|fmu_[0-9a-f]{12}(\.|$)|TwoMassImpactOscillator_[0-9a-f]{12}$", name
        ), name


def test_script_is_tiny(tmp_path):
    """The script is read and run again for each instance: it defines the class and nothing else."""
    with zipfile.ZipFile(PYTHON) as archive:
        (name,) = [
            n
            for n in archive.namelist()
            if re.match(r"resources/TwoMassImpactOscillator\w*\.py", n)
        ]
        assert len(archive.read(name)) < 1024


def test_many_instances_and_resets(tmp_path):
    """References that pythonfmu only borrows, released 5000 times, and memory that stays."""
    same, sizes = run("traps.many_instances_and_resets", PYTHON, cwd=tmp_path)
    assert all(same) and len(same) == 6
    assert sizes[-1] - sizes[1] < 8e6  # bytes; an instance has 8 kB


@pytest.mark.parametrize("pure", [False, True])
def test_instantiation_takes_less_than_a_second(fmu, tmp_path, pure):
    """The first of a process, with all that is imported, and later ones, to the first step."""
    if pure and "python" not in fmu.parent.name:
        pytest.skip("no Python in it")
    for made, stepped in run(
        "traps.instantiation_takes_less_than_a_second", fmu, cwd=tmp_path, pure=pure
    ):
        assert made < 1.0
        assert stepped < 1.0


@pytest.mark.parametrize(
    "name", ["%s%n%s%n", "%d %100000d %p", "ü €", "", "a" * 2000, "two\nlines"]
)
def test_hostile_instance_names(fmu, tmp_path, name):
    """Names and texts end up in a printf format: a percent sign is a percent sign."""
    message, phase = run("traps.hostile_instance_names", fmu, name, cwd=tmp_path)
    assert "m1 = nan kg: expected 1e-30 <= m1 <= 1e+30" in message
    assert phase == [pytest.approx(0.4)]


def test_percent_signs_in_a_message_reach_the_importer(tmp_path):
    """The only text of a user's that a message repeats is a number, so a variable of a copied FMU
    gets a name with format directives.
    """
    texts = run("traps.percent_signs_in_a_message_reach_the_importer", PYTHON, cwd=tmp_path)
    assert len(texts) == 50
    assert all("%s%n %d 100 %: expected everything" in text for text in texts)


def test_discarded_step_is_noticed(tmp_path):
    """FMPy's loop takes pythonfmu's discarded step for the end of the simulation and reports
    success: stderr has the reason.
    """
    times, done = run_with_output("traps.discarded_step_is_noticed", PYTHON, cwd=tmp_path)
    assert times[-1] < 10.0  # the trap
    (line,) = [text for text in done.stderr.splitlines() if "cannot finish" in text]
    assert "the step to time = " in line and "10000000" in line


@pytest.mark.parametrize(
    "categories", [["logStatusError"], ["logAll"], ["logStatusWarning", "logStatusError"]]
)
def test_log_categories(fmu, tmp_path, categories):
    """An exception is logged without a category; who asks for a category hears of it too."""
    messages, done = run_with_output("traps.log_category", fmu, categories, cwd=tmp_path)
    assert ["m1 = -1.0 kg" in message for message in messages] == [True] * 300
    assert "SystemError" not in done.stderr


def test_a_step_too_short_to_advance_is_reported_once(fmu, tmp_path):
    """The one message of a good run, so "all messages" is no category on offer."""
    names, messages = run("traps.short_steps", fmu, cwd=tmp_path)
    assert names == ["logStatusWarning", "logStatusError"]
    (message,) = messages
    for part in ("communicationStepSize = 1e-09 s", "1000000000.0 s", "expected a longer one"):
        assert part in message


def test_own_access_leaves_other_importers_their_messages(tmp_path):
    """A notebook that has used the project's functions, then FMPy itself."""
    program = Path(__file__).with_name("programs") / "own_access.py"
    command = [sys.executable, str(program), str(PYTHON)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.stdout.count("cannot finish") == 1  # raised, by the project
    assert done.stderr.count("cannot finish") == 1  # printed, for FMPy's loop


@pytest.mark.parametrize("place", ["a folder with spaces", "plain"])
def test_working_folder_and_paths(fmu, tmp_path, place):
    """Wherever the importer runs, and wherever it extracts to."""
    folder = tmp_path / place / "run"
    folder.mkdir(parents=True)
    expected = run("traps.working_folder_and_paths", fmu, None, cwd=tmp_path)
    assert run("traps.working_folder_and_paths", fmu, None, cwd=folder) == expected
    assert (
        run("traps.working_folder_and_paths", fmu, folder / "extracted", cwd=tmp_path) == expected
    )
