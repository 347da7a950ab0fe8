"""Describing a structure needs nothing heavy: it is there at once."""

import subprocess
import sys

SCRIPT = """
import sys
before = set(sys.modules)
import orchestrate.model
loaded = {name.partition(".")[0] for name in set(sys.modules) - before}
print(*sorted(loaded - sys.stdlib_module_names))
"""
LIGHT = {"orchestrate", "fmu_src"}


def test_it_needs_the_standard_library_alone():
    command = [sys.executable, "-c", SCRIPT]
    done = subprocess.run(command, capture_output=True, check=True, text=True)
    assert {"orchestrate", "fmu_src"} <= set(done.stdout.split()) <= LIGHT
