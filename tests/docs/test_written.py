"""Every block of Python and every command line of the README and the manual runs."""

import atexit
import functools
import shutil
import tempfile

import pytest

from orchestrate import cli

from ..orchestrate.weak_drive.drives import table
from ..sparing import ordinary
from .written import DOCS, PAGES, commands, files, python_blocks

LONG = {  # read only
    *("analyse", "build", "capture", "couple", "diagnose", "explore", "jump-voltages", "paper"),
    *("passage", "report"),
}
SHOWN = {words: page for page in reversed(PAGES) for words in map(tuple, commands(page))}
SHORT = {  # commands that are not only read
    words: page
    for words, page in SHOWN.items()
    if words and words[0] not in LONG and words[-1] not in ("--help", "--version")
}


def write_files(folder):
    """The files that pages show, and the records they speak of."""
    shutil.copytree(DOCS / "records", folder, dirs_exist_ok=True)
    for page in PAGES:
        for name, text in files(page).items():
            (folder / name).write_text(text, encoding="utf-8")


def write_knocks(folder):
    """The records of a hammer test that the reader would have measured."""
    beam = "shake --structure beam.toml --set clearance=0.1mm --format csv"
    knock = f"{beam} --hammer 5:0.004 --sensor 800 --half"
    for half in "12":
        cli.main([*knock.split(), half, "--store", str(folder / f"half{half}.nc")])
        (folder / f"half{half}_sensors.csv").rename(folder / f"half{half}.csv")


def takes_stored(words, earlier):
    """Whether a command takes what the sensors read in an earlier one."""
    return "--store" in earlier and f"{earlier[-1].removesuffix('.nc')}_sensors.nc" in words


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


def test_commands_are_read(capsys):
    for words in SHOWN:
        if words:
            cli.parse_arguments(words)


@pytest.mark.parametrize(
    "words",
    ordinary(SHORT, [words for words, page in SHORT.items() if page.stem in ("README", "index")]),
    ids=lambda words: f"{SHORT[words].stem}-{' '.join(words)[:60]}",
)
def test_commands_run(words, folder, small, capsys):
    write_files(folder)
    if "shaker.fmu" in words:
        shutil.copy(own_drive(), folder / "shaker.fmu")
    if "half1.csv" in words:
        write_knocks(folder)
    page, takes = [*map(tuple, commands(SHORT[words]))], {"--start", "--overlay"} & set(words)
    first = [one for one in page[: page.index(words)] if takes and one[0] in ("branch", "border")]
    first += [one for one in page[: page.index(words)] if takes_stored(words, one)]
    for one in [*first, words]:  # those before make the files that it takes
        names = (folder.glob(word) if "*" in word else [word] for word in one)  # as a shell does
        code = cli.main([str(name) for every in names for name in every])
        assert code == 0, capsys.readouterr().err
