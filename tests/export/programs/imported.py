"""The files of ``fmu_src`` that importing modules runs: ``python imported.py MODULE...``."""

import json
import sys
from importlib import import_module
from pathlib import Path


def main(names):
    for name in names:
        import_module(name)
    root = Path(sys.modules["fmu_src"].__file__).parent
    modules = [module for name, module in sys.modules.items() if name.split(".")[0] == "fmu_src"]
    files = [Path(module.__file__).relative_to(root).as_posix() for module in modules]
    print(json.dumps(sorted(files)))


if __name__ == "__main__":
    main(sys.argv[1:])
