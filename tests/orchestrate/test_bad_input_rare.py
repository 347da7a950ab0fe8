"""Rarer mistakes, each of which once ended in a traceback, in silence or after the work."""

import pytest

from orchestrate import __main__, build
from orchestrate.commands.sweep_command import MODEL

from .command import Sweeps, altered_fmu
from .test_bad_input import refusal


def test_step_of_absurd_smallness(capsys, tmp_path, python_fmu):
    refusal(capsys, python_fmu, tmp_path / "results", "--eta", "1:2:1e-9999999")


def test_negative_range_after_a_space(capsys, tmp_path, python_fmu):
    assert "-1:2:0.5" in refusal(capsys, python_fmu, tmp_path / "results", "--eta", "-1:2:0.5")


def test_damping_of_a_heavy_mass(sweeps):
    sweeps.run("--eta", "1", "--case", "mu=1e20,D=1e11").complaint("D", "mu")
    assert sweeps.files() == []


def test_undamped_resonance(tmp_path, python_fmu):
    Sweeps(tmp_path, python_fmu).run("--eta", "1", "--case", "D=0").complaint("natural frequency", code=1)


def test_more_samples_than_memory(sweeps):
    sweeps.run("--eta", "1", "--samples", "1000000000000").complaint("--samples")


def test_fmu_of_the_model_with_other_variables(capsys, tmp_path, python_fmu):
    fmu = altered_fmu(python_fmu, tmp_path / "other.fmu", name=("gamma", "delta"))
    assert "gamma" in refusal(capsys, fmu, tmp_path / "results", "--eta", "1")


def test_fmu_without_a_binary_for_this_machine(tmp_path, python_fmu):
    fmu = altered_fmu(python_fmu, tmp_path / "other.fmu", modelIdentifier=(MODEL, "Elsewhere"))
    Sweeps(tmp_path, fmu).run("--eta", "1").complaint(fmu)


def test_cases_that_differ_beyond_six_digits(sweeps):
    done = sweeps.run("--eta", "1", "--transient", "1", "--samples", "2", "--case", "e=0.7", "--case", "e=0.70000001")
    assert done.code == 2 or len([name for name in sweeps.files() if name.endswith(".nc")]) == 2


def test_a_parameter_twice_in_a_case(capsys, tmp_path, python_fmu):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("orchestrate.campaign.run_all", lambda *_: pytest.fail("it was taken"))
        assert "e" in refusal(capsys, python_fmu, tmp_path / "results", "--eta", "1", "--case", "e=0.7,e=0.3")


def test_build_into_a_file(capsys, tmp_path, monkeypatch):
    (tmp_path / "folder").write_text("mine")
    monkeypatch.setattr(build.pythonfmu_form, "run_pythonfmu", lambda *_: pytest.fail("work was done"))
    assert __main__.main(["build", "--folder", str(tmp_path / "folder")]) == 2
    assert "allowed is a folder that can be written" in capsys.readouterr().err


@pytest.mark.parametrize(
    "command",
    [[], ["build"], ["sweep"]],
)
def test_help_teaches(capsys, command):
    with pytest.raises(SystemExit) as ended:
        __main__.main([*command, "--help"])
    out, err = capsys.readouterr()
    assert (ended.value.code, err) == (0, "")
    assert out.startswith("usage: ") and "example" in out
    assert not command or "default" in out
