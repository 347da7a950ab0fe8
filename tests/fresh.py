"""Programs in a fresh process that has no project on its path: what a user of the FMU has."""

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

ROOT = Path(__file__).resolve().parents[1]
PROCESS = Path(__file__).with_name("fresh_process.py")
OURS = ("PYTHONPATH", "VIBROIMPACT_PURE_PYTHON")  # what the outer process may have


def run_fresh(folder, program, *arguments, cwd, pure=False, env=None, timeout=300, under=()):
    """What a program returns, and the completed process for the rest.

    The process is forked from one that has imported FMPy and has never opened an FMU: the start of
    an interpreter takes longer than most programs. Where the environment or the command is another
    one, or the system is not Linux, an interpreter is started.

    The folder has the program ``"module.function"`` and what else it imports of ours; arguments are
    what JSON can write, a path becomes a string; the working directory is not the project's. The
    FMU is asked for pure Python if `pure`, `under` is a command to run the process with.
    """
    environment = {k: v for k, v in os.environ.items() if k not in OURS}
    environment.update(env or {})
    if pure:
        environment["VIBROIMPACT_PURE_PYTHON"] = "1"
    call = [str(folder), *program.split(".")]
    text = json.dumps(arguments, default=str)
    if env or under or sys.platform != "linux":
        pipes = {"input": text, "capture_output": True, "text": True, "timeout": timeout}
        command = [*under, sys.executable, str(PROCESS), *call]
        done = subprocess.run(command, cwd=cwd, env=environment, **pipes)
    else:
        done = forked([*call, json.loads(text)], environment, cwd, timeout)
    told = f"exit code {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    assert done.returncode == 0, told
    answers = [line[7:] for line in done.stdout.splitlines() if line.startswith("ANSWER ")]
    assert len(answers) == 1, done.stdout
    return json.loads(answers[0]), done


@functools.cache
def server(_thread):
    """The process that others are forked from, one after the other; it ends with this one."""
    environment = {k: v for k, v in os.environ.items() if k not in OURS}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, str(PROCESS)], cwd="/", env=environment, **pipes)
    atexit.register(process.communicate)  # an empty input ends it
    return process


def forked(call, environment, cwd, timeout):
    """Run a program in a process that :func:`server` forks; returns as :func:`subprocess.run`."""
    with tempfile.TemporaryDirectory() as folder:
        outputs = [Path(folder, name) for name in ("out", "err")]
        for path in outputs:
            path.touch()
        request = {"call": call, "environment": environment, "cwd": str(cwd)}
        request["outputs"] = list(map(str, outputs))
        process = server(threading.get_ident())
        process.stdin.write(json.dumps(request) + "\n")
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
