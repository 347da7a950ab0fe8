"""Processes whose linear algebra rounds as on other processors.

OpenBLAS, which NumPy and SciPy bring along, has kernels for many processors and takes the ones that
``OPENBLAS_CORETYPE`` names. So another machine's roundings can be had here, in a process of their
own, as far as this machine has the instructions: SkylakeX needs AVX-512, Haswell and Zen AVX2.
"""

import functools
import os
import subprocess
import sys
import warnings

import pytest

from tests import ROOT

PROBE = "import numpy as np; a = np.eye(64) + np.tri(64); np.linalg.solve(a, a)"


def surroundings(processor):
    return {**os.environ, "OPENBLAS_CORETYPE": processor}


@functools.cache
def has_instructions(processor):
    """Whether a plain linear solve runs here with the kernels of a processor."""
    command = [sys.executable, "-c", PROBE]
    done = subprocess.run(command, env=surroundings(processor), capture_output=True, check=False)
    return done.returncode == 0


def printed_on_each(arguments, processors):
    """What Python prints for arguments with the kernels of each processor that this machine can be.

    Warns of each that it cannot be, and skips the test where fewer than two are left.
    """
    able = [processor for processor in processors if has_instructions(processor)]
    for processor in set(processors) - set(able):
        warnings.warn(f"this machine has no instructions of {processor}", stacklevel=2)
    if len(able) < 2:
        pytest.skip(f"this machine cannot be two of {', '.join(processors)}: it can be {able}")
    where = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "cwd": ROOT}
    command = [sys.executable, *arguments]
    children = [subprocess.Popen(command, env=surroundings(one), **where) for one in able]
    ends = [child.communicate(timeout=1800) for child in children]
    for processor, child, (_, errors) in zip(able, children, ends, strict=True):
        assert child.returncode == 0, f"{processor}: {errors[-2000:]}"
    return {processor: text for processor, (text, _) in zip(able, ends, strict=True)}
