"""Scripts in a fresh process that has no project on its path: what a user of the FMU has."""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PRELUDE = """
import sys, json
from pathlib import Path
sys.path[:] = [p for p in sys.path if not (Path(p or ".") / "fmu_src").is_dir()]  # this project, or wherever an installation points to
try:
    import fmu_src
    raise SystemExit("the project is on the path")
except ModuleNotFoundError:
    pass

def answer(value):
    print("ANSWER " + json.dumps(value))
"""


def run_fresh(script, *args, cwd, pure=False, env=None, timeout=300):
    """Run a script that ends with ``answer(value)``; returns value, and the completed process for
    the rest.

    Parameters
    ----------
    script : str
        Python source; ``sys.argv[1:]`` are ``args``; floats survive JSON to the last bit.
    cwd : path-like
        Working directory, not the project's.
    pure : bool
        Ask the FMU for pure Python.
    env : dict, optional
        Further environment variables.
    """
    environment = {
        k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIBROIMPACT_PURE_PYTHON")
    }
    environment.update(env or {})
    if pure:
        environment["VIBROIMPACT_PURE_PYTHON"] = "1"
    command = [sys.executable, "-c", PRELUDE + script, *map(str, args)]
    done = subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, timeout=timeout
    )
    assert done.returncode == 0, (
        f"exit code {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    )
    answers = [line[7:] for line in done.stdout.splitlines() if line.startswith("ANSWER ")]
    assert len(answers) == 1, done.stdout
    return json.loads(answers[0]), done
