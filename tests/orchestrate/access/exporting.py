"""Export one FMU again and again: ``exporting.py FOLDER TIMES SOURCE``.

The compiler and pythonfmu take long and are not what is tested: their files are those of SOURCE.
"""

from __future__ import annotations

import sys
import zipfile

from fmu_src.export import pythonfmu_form
from orchestrate.access import OSCILLATOR, build

folder, times, source = sys.argv[1:]
with zipfile.ZipFile(source) as archive:
    files = {name: archive.read(name) for name in archive.namelist()}
pythonfmu_form.libraries = lambda *_: {}
pythonfmu_form.run_pythonfmu = lambda *_: dict(files)
for _ in range(int(times)):
    build(folder, ["fmi2-python"], [OSCILLATOR])
