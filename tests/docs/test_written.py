"""Every block of Python and every command line of the README and the manual runs."""

from __future__ import annotations

import atexit
import functools
import shutil
import tempfile

import pytest

from orchestrate import cli

from ..orchestrate.weak_drive.drives import table
from .written import PAGES, commands, files, python_blocks

LONG = {
    "analyse",
    "build",
    "capture",
    "couple",
    "diagnose",
    "explore",
    "jump-voltages",
    "paper",
    "passage",
    "report",
}  # read only
SHOWN = {words: page for page in reversed(PAGES) for words in map(tuple, commands(page))}
EVERY = [
    pytest.param(
        words,
        id=f"{page.stem}-{' '.join(words)[:60]}",
        marks=[pytest.mark.slow] * (words[:1] == ("drive-branch",)),  # half a minute
    )
    for words, page in SHOWN.items()
]


def write_files(folder):
    """The files that pages show."""
    for page in PAGES:
        for name, text in files(page).items():
            (folder / name).write_text(text, encoding="utf-8")


@functools.cache
def own_drive():
    """The FMU of somebody else that the page on drives speaks of."""
    from pythonfmu import FmuBuilder

    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return FmuBuilder.build_FMU(table.__file__, dest=folder)


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(
            page,
            id=page.stem,
            marks=[pytest.mark.slow] * (page.stem in ("bifurcations", "coupling")),  # long runs
        )
        for page in PAGES
        if python_blocks(page)
    ],
)
def test_python_runs(page, folder, small):
    write_files(folder)
    names = {}
    for number, text in enumerate(python_blocks(page)):
        exec(compile(text, f"{page.name}, block {number}", "exec"), names)


@pytest.mark.parametrize("words", EVERY)
def test_commands_run(words, folder, small, capsys):
    if not words or words[0] in LONG or words[-1] in ("--help", "--version"):
        try:
            cli.make_parser().parse_args(cli.join_negative_values(words))
        except SystemExit as ended:
            assert ended.code == 0 or not words, capsys.readouterr().err
        return
    write_files(folder)
    if "shaker.fmu" in words:
        shutil.copy(own_drive(), folder / "shaker.fmu")
    assert cli.main(list(words)) == 0, capsys.readouterr().err
