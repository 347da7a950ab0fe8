"""One function of a program, called in a process that has no project on its path.

Run as ``python fresh_process.py MODULE FUNCTION`` with the arguments as JSON on the standard input;
prints the answer as JSON. Floats survive to the last bit.

Run as ``python fresh_process.py`` it forks such a process for each line of JSON on the standard
input. What most programs import is imported once, before the forks; no FMU is ever opened there.
Prints the process's id, and at its end its exit code.
"""

import json
import os
import sys
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).resolve().parent
PREPARED = ("numpy", "fmpy")  # of others; a program's own modules are imported in its own process


def is_ours(place):
    """Whether a folder on the path is this project, or the tests themselves."""
    folder = Path(place or ".").resolve()
    return folder == HERE or (folder / "fmu_src").is_dir()


def become(request):
    """Make this process the one that was asked for: its folder, environment and streams."""
    os.chdir(request["cwd"])
    os.environ.clear()
    os.environ.update(request["environment"])
    streams = (os.devnull, os.O_RDONLY), *((path, os.O_WRONLY) for path in request["outputs"])
    for number, (path, mode) in enumerate(streams):
        opened = os.open(path, mode)
        os.dup2(opened, number)
        os.close(opened)


def serve():
    """Fork a process for each request; returns in the forked process, with what it is to call."""
    for name in PREPARED:
        import_module(name)
    while line := sys.stdin.readline():
        request = json.loads(line)
        child = os.fork()
        if child == 0:
            become(request)
            return request["call"]
        print(child, flush=True)
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)
    sys.exit()


if __name__ == "__main__":
    sys.path[:] = [str(HERE / "programs"), *(place for place in sys.path if not is_ours(place))]
    try:
        import_module("fmu_src")
        raise SystemExit("the project is on the path")
    except ModuleNotFoundError:
        pass
    module, function, arguments = (
        [*sys.argv[1:], json.load(sys.stdin)] if len(sys.argv) > 1 else serve()
    )
    print("ANSWER " + json.dumps(getattr(import_module(module), function)(*arguments)))
