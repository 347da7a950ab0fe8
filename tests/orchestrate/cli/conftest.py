"""What the tests of the command line share."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from orchestrate.cli import main
from orchestrate.show.style import STYLE

from .commands import Commands, Done

Ask = Callable[..., Done]


@pytest.fixture(scope="package", autouse=True)
def _exported(exported: Path) -> Iterator[None]:
    """The FMUs are there before the first command asks for them, and pictures are coarse."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(STYLE, "savefig.dpi", 40)
        yield


@pytest.fixture
def commands(tmp_path: Path) -> Iterator[Commands]:
    """Commands in a folder of the test's own."""
    found = Commands(tmp_path)
    yield found
    found.clean_up()


@pytest.fixture
def ask(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Ask:
    """Run a command in this process, its results in a folder of the test's own."""

    def asked(*options: object, output: object = tmp_path / "results") -> Done:
        capsys.readouterr()
        try:
            code = main([*map(str, options), "--output", str(output)])
        except SystemExit as ended:
            code = int(ended.code or 0)
        return Done(code, *capsys.readouterr())

    return asked
