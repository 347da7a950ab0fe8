"""What the tests of the runner share: a file that stands for an FMU."""

from collections.abc import Callable
from pathlib import Path

import pytest

from .sums import Model

Find = Callable[[str], Model]


@pytest.fixture
def find(tmp_path: Path) -> Find:
    path = tmp_path / "model.fmu"
    path.write_bytes(b"an FMU")
    return lambda model: Model(path, model)
