"""Where the FMUs are, and programs on them in a fresh process that has no project on its path: what
a user of the FMU has.

Tests that need no process of their own open FMUs in this one, by :mod:`.programs.driver`.
"""

import atexit
import functools
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from ..exports import BUILD

PROCESS = Path(__file__).with_name("fresh_process.py")
FORMS = ("fmi2-python", "fmi2", "fmi3")
VERSIONS = FORMS[1:]  # of FMI; the native forms are called so
OSCILLATOR = "TwoMassImpactOscillator"
DRIVES = ("MotorShaker", "ElectrodynamicShaker")
MODELS = (OSCILLATOR, *DRIVES)
PAIRS = [(version, model) for version in VERSIONS for model in MODELS]
FMUS = {form: BUILD / form / f"{OSCILLATOR}.fmu" for form in FORMS}


def path_of(model, form):
    return BUILD / form / f"{model}.fmu"


def environment_of_users(**more):
    """The environment, without what only the project has there."""
    ours = ("PYTHONPATH", "VIBROIMPACT_PURE_PYTHON")
    return {**{key: value for key, value in os.environ.items() if key not in ours}, **more}


def run(program, fmu, *arguments, cwd, pure=False, env=None, timeout=300):
    """What the program ``"module.function"`` below ``programs/`` returns for an FMU.

    The process is forked from one that has imported FMPy and has never opened an FMU: the start of
    an interpreter takes longer than most programs. Where the environment is another one, or the
    system is not Linux, an interpreter is started.

    Arguments are what JSON can write, a path becomes a string; the working directory is not the
    project's. The FMU is asked for pure Python if ``pure``.
    """
    more = {"VIBROIMPACT_PURE_PYTHON": "1"} if pure else {}
    environment = environment_of_users(**more, **(env or {}))
    call, text = program.split("."), json.dumps([fmu, *arguments], default=str)
    if env or sys.platform != "linux":
        command = [sys.executable, str(PROCESS), *call]
        how = {"cwd": cwd, "env": environment, "capture_output": True, "timeout": timeout}
        done = subprocess.run(command, input=text, text=True, **how)
    else:
        done = forked([*call, json.loads(text)], environment, cwd, timeout)
    told = f"exit code {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    assert done.returncode == 0 and "Traceback" not in done.stderr, told
    assert call[0] != "importers" or "error" not in done.stderr.lower(), told
    (answer,) = (line[7:] for line in done.stdout.splitlines() if line.startswith("ANSWER "))
    return json.loads(answer)


@functools.cache
def server(_thread):
    """The process that others are forked from, one after the other; it ends with this one."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    command = [sys.executable, str(PROCESS)]
    process = subprocess.Popen(command, cwd="/", env=environment_of_users(), **pipes)
    atexit.register(process.communicate)  # an empty input ends it
    return process


def forked(call, environment, cwd, timeout):
    """Run a program in a process that :func:`server` forks; returns as :func:`subprocess.run`."""
    with tempfile.TemporaryDirectory() as folder:
        outputs = [Path(folder, name) for name in ("out", "err")]
        for path in outputs:
            path.touch()
        request = {"call": call, "environment": environment, "cwd": str(cwd)}
        process = server(threading.get_ident())
        print(json.dumps({**request, "outputs": outputs}, default=str), file=process.stdin)
        process.stdin.flush()
        child = int(process.stdout.readline())
        alarm = threading.Timer(timeout, os.kill, (child, signal.SIGKILL))
        alarm.start()
        try:
            code = int(process.stdout.readline())
        finally:
            alarm.cancel()
        out, err = (path.read_text() for path in outputs)
    return subprocess.CompletedProcess(call, code, out, err)
