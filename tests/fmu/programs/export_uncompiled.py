"""A model exported without its compiled kernel: ``python export_uncompiled.py MODEL``.

Compiling takes a while; what is told from an export here does not depend on it.
"""

import sys
from pathlib import Path

from fmu_src.export import pythonfmu_form
from fmu_src.export.errors import CannotExport
from fmu_src.export.forms import PYTHON_FORM, export


def no_compiler(*_):
    raise CannotExport("not wanted here")


if __name__ == "__main__":
    pythonfmu_form.link_for_platforms = no_compiler
    export(sys.argv[1], PYTHON_FORM, Path("out"))
