"""The README keeps pace: its commands are the ones that run, its table is the FMU's, its pictures and folders are there."""

import re
from pathlib import Path

import pytest

from orchestrate import __main__, assets

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_test_command_is_what_ci_runs():
    command = (ROOT / ".ci" / "run").read_text().strip().splitlines()[-1]
    assert f"```\n{command}\n```" in README


def test_the_variable_table_is_the_fmus(python_fmu):
    assert assets.with_table(README, assets.variable_table(python_fmu)) == README


@pytest.mark.parametrize("command", sorted(set(re.findall(r"python -m orchestrate (\w+)", README))))
def test_its_commands_exist(command, capsys):
    with pytest.raises(SystemExit) as ended:
        __main__.main([command, "--help"])
    assert ended.value.code == 0 and command in capsys.readouterr().out


def test_what_it_points_to_is_there():
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", README)
    folders = re.findall(r"^\| `([\w/]+/)` \|", README, re.M)
    assert pictures and folders
    assert [path for path in pictures + folders if not (ROOT / path).exists()] == []
