"""What people install: a wheel that carries the FMUs asks and answers without a compiler."""

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

from fmu_src.export.forms import FORMS, MODELS
from fmu_src.export.platforms import this_machine
from orchestrate.fmu.c_library import SOURCES
from orchestrate.fmu.webassembly import WEB_MODELS

ROOT = Path(__file__).resolve().parents[1]
TOOLS = ("ziglang", "pythonfmu", "hatchling")  # to build, not to ask
WITHOUT = f"""
import importlib.abc, sys

class Without(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {TOOLS!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Without())
"""
QUESTIONS = ROOT / "tests" / "installed_questions.py"
PLACE = "orchestrate/fmu/fmus"


@pytest.fixture(scope="module")
def wheel(exported, tmp_path_factory) -> Path:
    """The project's wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(folder), "."]
    subprocess.run(command, cwd=ROOT, check=True, timeout=300)
    (found,) = folder.glob("*.whl")
    return found


def clean(folder: Path, **more: str) -> dict[str, str]:
    """An environment without compilers, caches and the clone."""
    (folder / "home").mkdir(exist_ok=True)
    (folder / "bin").mkdir(exist_ok=True)
    own = {"HOME": str(folder / "home"), "PATH": str(folder / "bin"), **more}
    kept = {k: v for k, v in os.environ.items() if k in ("TMPDIR", "LANG", "SYSTEMROOT")}
    return {**kept, **own}


def ask(python: Path, folder: Path, **more: str) -> None:
    """Sweep, simulate and couple, in Python and at the command line, outside the clone."""
    environment = clean(folder, **more)
    questions = shutil.copy(QUESTIONS, folder)  # beside the tests, `orchestrate` would be theirs
    commands = (
        [str(questions)],
        ["-m", "orchestrate", "sweep", "--eta", "1.0:1.1:0.01", "--transient", "20"],
        ["-m", "orchestrate", "simulate", "--eta", "1.05", "--periods", "5"],
        ["-m", "orchestrate", "explore", "--no-open"],
        ["-m", "orchestrate", "couple", "--eta0", "1.2:1.25", "--rate", "1e-2"],
    )
    for command in commands:
        done = subprocess.run(
            [str(python), *command],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, (command, done.stdout, done.stderr)
    assert len(list((folder / "results").glob("*.nc"))) >= 3
    came_along = ("*.fmu", "compiled.*")
    assert not [path for name in came_along for path in (folder / "home").rglob(name)]


@pytest.mark.slow
def test_a_wheel_without_compiler_and_ziglang(wheel, tmp_path):
    site = tmp_path / "site"
    command = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", str(site)]
    subprocess.run([*command, str(wheel)], check=True, timeout=300)
    (site / "sitecustomize.py").write_text(WITHOUT)
    ask(Path(sys.executable), tmp_path, PYTHONPATH=str(site))


@pytest.mark.slow
def test_a_wheel_in_an_environment_of_its_own(wheel, tmp_path):
    venv.create(tmp_path / "venv", with_pip=True)
    python = tmp_path / "venv" / "bin" / "python"
    install = [str(python), "-m", "pip", "install", "-q", str(wheel)]
    subprocess.run(install, check=True, timeout=900)
    listed = subprocess.run(
        [str(python), "-m", "pip", "list"], capture_output=True, text=True, check=True
    ).stdout
    assert not [tool for tool in TOOLS if f"\n{tool} " in listed]
    ask(python, tmp_path)


def test_the_wheel_carries_nothing_else(wheel):
    import zipfile

    names = zipfile.ZipFile(wheel).namelist()
    assert sum(name.endswith(".fmu") for name in names) == len(FORMS) * len(MODELS)
    assert sum(name.endswith(".wasm") for name in names) == len(WEB_MODELS)
    libraries = {f"{PLACE}/libraries/{this_machine()}/{source.stem}" for source in SOURCES}
    assert libraries <= {name.partition(".")[0] for name in names}
    roots = {name.split("/")[0] for name in names if ".dist-info" not in name}
    assert roots == {"fmu_src", "orchestrate"}
    assert "orchestrate/py.typed" in names
