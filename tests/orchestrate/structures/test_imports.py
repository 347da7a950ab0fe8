"""Describing a structure needs nothing heavy: it is there at once."""

from __future__ import annotations

import subprocess
import sys

SCRIPT = """
import sys, time
import importlib.metadata, dataclasses, typing
begin = time.process_time()
import orchestrate.structures
print(time.process_time() - begin)
heavy = {"numpy", "scipy", "xarray", "matplotlib", "fmpy", "netCDF4", "pythonfmu"}
print(*(heavy & sys.modules.keys()))
"""


def test_import_is_fast_and_light():
    times = []
    for _ in range(3):
        done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True)
        seconds, heavy = done.stdout.splitlines()
        assert heavy == ""
        times.append(float(seconds))
    assert min(times) < 0.1
