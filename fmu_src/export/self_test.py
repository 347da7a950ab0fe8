"""The short run by which an FMU's library checks, at instantiation, that it has its model's bits.

A compiler may fuse or reorder operations where it was asked to be fast. The same short run as in
``runtime/native/self_test.c``, by the Python of the kernel, whose bits are the model's.
"""

from __future__ import annotations

import ctypes
import functools
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..runtime.table import REAL, Model

Entry = Callable[[Any, float], int]
STEPS = 120
STEP = 0.3125  # s: a sum of them is exact
CHANGE = 0.125
MASK = (1 << 64) - 1


@functools.cache
def expected_sum(model: Model) -> int:
    """Return the checksum of the run by the model's Python; see :func:`sum_of_run`."""
    return sum_of_run(model, [0.0] * model.memory_size, model.initialize, model.advance)


def has_right_bits(model: Model, path: Path) -> bool:
    library = ctypes.CDLL(str(path))
    for entry in (library.initialize, library.advance):
        entry.argtypes = [ctypes.c_void_p, ctypes.c_double]
    memory = (ctypes.c_double * model.memory_size)()
    return sum_of_run(model, memory, library.initialize, library.advance) == expected_sum(model)


def sum_of_run(model: Model, memory: Any, initialize: Entry, advance: Entry) -> int:
    """Return the checksum of a short run in a memory of zeros; half way all inputs move.

    It depends on every bit of all variables, and on their order.
    """
    total = 0
    for variable in model.variables:
        memory[variable.slot] = 0.0 if variable.calculated else float(variable.start)
    codes = [initialize(memory, 0.0)]
    for step in range(1, STEPS + 1):
        for variable in model.variables if step == STEPS // 2 else ():
            if variable.type == REAL and not (variable.calculated or variable.fixed):
                memory[variable.slot] += CHANGE
            if variable.slot in model.set_flag_by_slot:
                memory[model.set_flag_by_slot[variable.slot]] = 1.0
        codes.append(advance(memory, step * STEP))
        for value in memory[: len(model.variables)]:
            (bits,) = struct.unpack("<Q", struct.pack("<d", value))
            total = ((total << 7) | (total >> 57)) & MASK ^ bits
    if any(codes):
        raise RuntimeError(f"{model.name}: the run of the self-test fails with code {max(codes)}")
    return total


def self_test_macros(model: Model) -> dict[str, str]:
    return {
        "SELF_TEST_STEPS": str(STEPS),
        "SELF_TEST_STEP": STEP.hex(),
        "SELF_TEST_CHANGE": CHANGE.hex(),
        "SELF_TEST_SUM": f"0x{expected_sum(model):016x}ULL",
    }
