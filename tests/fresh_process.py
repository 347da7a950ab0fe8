"""One function of a program, called in a process that has no project on its path.

Run as ``python fresh_process.py FOLDER MODULE FUNCTION`` with the arguments as JSON on the standard
input; prints the answer as JSON. Floats survive to the last bit.
"""

import json
import sys
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).resolve().parent


def is_ours(place):
    """Whether a folder on the path is this project, or the tests themselves."""
    folder = Path(place or ".").resolve()
    return folder == HERE or (folder / "fmu_src").is_dir()


def main(folder, module, function):
    """Call the function and print what it returns."""
    sys.path[:] = [folder, *(place for place in sys.path if not is_ours(place))]
    try:
        import_module("fmu_src")
        raise SystemExit("the project is on the path")
    except ModuleNotFoundError:
        pass
    arguments = json.load(sys.stdin)
    answer = getattr(import_module(module), function)(*arguments)
    print("ANSWER " + json.dumps(answer))


if __name__ == "__main__":
    main(*sys.argv[1:])
