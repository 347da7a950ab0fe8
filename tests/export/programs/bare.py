"""GUIDs of all FMUs by the standard library alone, and what an export says then."""

import json
import sys
import tempfile
from importlib.abc import MetaPathFinder
from pathlib import Path


class StandardLibraryAlone(MetaPathFinder):
    """Refuses every package that is not of the standard library, as if it were not installed."""

    def find_spec(self, name, path=None, target=None):
        top = name.split(".")[0]
        if top not in sys.stdlib_module_names and top != "fmu_src":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def main():
    sys.meta_path.insert(0, StandardLibraryAlone())
    from fmu_src.export import errors, forms

    errors.importlib.util.find_spec = lambda name: None  # nothing is installed
    told = {}
    for form in forms.FORMS:
        for name in forms.MODELS:
            try:
                forms.export(name, form, Path(tempfile.mkdtemp()))
            except errors.CannotExport as reason:
                told[f"{form}/{name}"] = [forms.guid(name, form), str(reason)]
    print(json.dumps(told))


if __name__ == "__main__":
    main()
