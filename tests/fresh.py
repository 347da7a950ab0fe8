"""Programs in a fresh process that has no project on its path: what a user of the FMU has."""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROCESS = Path(__file__).with_name("fresh_process.py")
OURS = (
    "PYTHONPATH",
    "VIBROIMPACT_PURE_PYTHON",
)  # what the outer process may have in its environment


def run_fresh(folder, program, *arguments, cwd, pure=False, env=None, timeout=300, under=()):
    """What a program returns, and the completed process for the rest.

    Parameters
    ----------
    folder : path-like
        Where the program's module lies, and what else it imports of ours.
    program : str
        ``"module.function"``.
    *arguments
        Whatever JSON can write; a path becomes a string.
    cwd : path-like
        Working directory, not the project's.
    pure : bool
        Ask the FMU for pure Python.
    env : dict, optional
        Further environment variables.
    under : sequence of str
        A command to run the process with.
    """
    environment = {k: v for k, v in os.environ.items() if k not in OURS}
    environment.update(env or {})
    if pure:
        environment["VIBROIMPACT_PURE_PYTHON"] = "1"
    done = subprocess.run(
        [*under, sys.executable, str(PROCESS), str(folder), *program.split(".")],
        input=json.dumps(arguments, default=str),
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=timeout,
    )
    told = f"exit code {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    assert done.returncode == 0, told
    answers = [line[7:] for line in done.stdout.splitlines() if line.startswith("ANSWER ")]
    assert len(answers) == 1, done.stdout
    return json.loads(answers[0]), done
