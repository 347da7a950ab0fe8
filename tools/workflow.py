"""Run a job of ``.github/workflows`` on this machine, step by step, in a clean clone.

``python -m tools.workflow tests.yml lint``. Checkout is a clone of the last commit, the same for
all jobs; setup-python an environment of the named version where there is one; artifacts are folders
beside the clone. What needs GitHub (``gh``) or changes the machine (``sudo``) is named and left
out.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).resolve().parents[1]


def find_python(version: str) -> str:
    """Return the path of a Python version, from PATH or pyenv; else of this one, printing so."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    candidates = [
        *map(str, pyenv.glob(f"{version}.*/bin/python")),
        shutil.which(f"python{version}"),
    ]
    chosen = next(filter(None, candidates), None)
    if chosen is None:
        print(f"no Python {version} here: {sys.version.split()[0]} instead")
    return chosen or sys.executable


def fill_matrix(text: str, matrix: dict[str, str]) -> str:
    """Return a text with the matrix's values put in for ``${{ matrix.* }}``."""
    for name, value in matrix.items():
        text = text.replace("${{ matrix." + name + " }}", str(value))
    return text


def last_commit() -> str:
    """Return the hash of this tree's last commit."""
    command = ["git", "-C", str(ROOT), "rev-parse", "HEAD"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def replace_action(step: dict[str, Any], clone: Path, matrix: dict[str, str], commit: str) -> None:
    """Do here what a step's marketplace action would do, such as a checkout."""
    action, inputs = step["uses"].split("@")[0], step.get("with", {})
    if action == "actions/checkout":
        subprocess.run(["git", "clone", "-q", str(ROOT), str(clone)], check=True)
        subprocess.run(["git", "-C", str(clone), "checkout", "-q", commit], check=True)
    elif action == "actions/setup-python":
        version = fill_matrix(inputs["python-version"], matrix)
        subprocess.run([find_python(version), "-m", "venv", str(clone / ".venv")], check=True)
    elif action == "actions/upload-artifact":
        shutil.copytree(clone / inputs["path"], clone.parent / inputs["name"], dirs_exist_ok=True)
    elif action == "actions/download-artifact":
        shutil.copytree(clone.parent / inputs["name"], clone / inputs["path"], dirs_exist_ok=True)


def run_job(
    steps: list[dict[str, Any]], clone: Path, matrix: dict[str, str], commit: str, tag: str
) -> None:
    """Run all steps of a job in a clone; exit at the first that fails."""
    path = f"{clone / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"
    known = {"CI": "true", "GITHUB_REF_NAME": tag, "PATH": path}
    for step in steps:
        if "uses" in step:
            replace_action(step, clone, matrix, commit)
            continue
        command = fill_matrix(step["run"], matrix)
        print(f"$ {command.strip()}", flush=True)
        if command.startswith(("sudo ", "gh ")):
            print("left out: it changes the machine, or needs GitHub")
            continue
        shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", command]
        subprocess.run(shell, cwd=clone, env={**os.environ, **known}, check=True)


def main() -> None:
    """Run a job of a workflow, as the options say."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("workflow", help="file below .github/workflows")
    parser.add_argument("jobs", nargs="+", help="in this order; artifacts go from one to the next")
    parser.add_argument("--python", default="3.12", help="where the job has a matrix of them")
    parser.add_argument("--tag", default="v0.0.0", help="that a release is made of")
    parser.add_argument("--folder", type=Path, help="kept; else a temporary one")
    options = parser.parse_args()
    text = (ROOT / ".github" / "workflows" / options.workflow).read_text(encoding="utf-8")
    jobs, commit = yaml.safe_load(text)["jobs"], last_commit()
    folder = options.folder or Path(tempfile.mkdtemp(prefix="workflow-"))
    for name in options.jobs:
        print(f"== {name}, in {folder / name}", flush=True)
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        run_job(jobs[name]["steps"], folder / name, {"python": options.python}, commit, options.tag)
    print("all steps passed")


if __name__ == "__main__":
    main()
