"""What people install: the wheel carries the FMUs, and nothing else of the build."""

import subprocess
import sys
from pathlib import Path

import pytest

from fmu_src.export.forms import FORMS, MODELS
from fmu_src.export.platforms import this_machine
from orchestrate.fmu.c_library import SOURCES

ROOT = Path(__file__).resolve().parents[1]
PLACE = "orchestrate/fmu/fmus"


@pytest.fixture(scope="module")
def wheel(exported, tmp_path_factory) -> Path:
    """The project's wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(folder), "."]
    subprocess.run(command, cwd=ROOT, check=True, timeout=300)
    (found,) = folder.glob("*.whl")
    return found


@pytest.mark.slow
def test_the_wheel_carries_nothing_else(wheel):
    import zipfile

    names = zipfile.ZipFile(wheel).namelist()
    assert sum(name.endswith(".fmu") for name in names) == len(FORMS) * len(MODELS)
    assert sum(name.endswith(".wasm") for name in names) == 1
    libraries = {f"{PLACE}/libraries/{this_machine()}/{source.stem}" for source in SOURCES}
    assert libraries <= {name.partition(".")[0] for name in names}
    roots = {name.split("/")[0] for name in names if ".dist-info" not in name}
    assert roots == {"fmu_src", "orchestrate", "vibroimpact"}
    assert "orchestrate/py.typed" in names
