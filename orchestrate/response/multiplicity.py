"""Multiplicity of a response (period in excitation periods), decided by how deviations decay.

A tolerance alone decides little: a transient that turns round, or that changes sides as next to a
period doubling, comes back closer after some periods than after one; a torus comes back as close as
one likes after enough of them; and a narrow period doubling stays within any tolerance. So
:func:`decide_multiplicity` follows how deviations develop: those of a response that repeats have
died, or decay. The rule is :func:`fmu_src.kernels.repetition.decide`, for Python and C alike;
:meth:`.respond.Response.conclude` makes it undecided where the impacts contradict it.
"""

from __future__ import annotations

import functools
from ctypes import c_size_t, c_void_p
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmu_src.kernels import repetition
from fmu_src.kernels.repetition import MIN_RELATIVE_GAP, memory_size

from ..fmu.c_library import loaded_library
from ..model.outcomes import WORDS

__all__ = ["MIN_RELATIVE_GAP", "memory_size"]
RULES = {"decide": "decide_multiplicity", "repeat": "find_repetition"}  # in C
DECIDED = {n: WORDS[n] for n in (repetition.IRREGULAR, repetition.REPEATED, repetition.UNDECIDED)}


@functools.cache
def library() -> Any:
    """Return the compiled loop and rule of responses as ctypes has it, or None."""
    loaded = loaded_library(Path(__file__).with_name("response_loop.c"))
    if loaded is not None:
        loaded.run.argtypes = [c_void_p, c_void_p, c_size_t, c_size_t]
        loaded.decide_multiplicity.argtypes = loaded.find_repetition.argtypes = [c_void_p]
    return loaded


class Repetition(NamedTuple):
    """Multiplicity of a response, and the largest deviation of states so many periods apart."""

    multiplicity: int  # least n such that the state repeats after n periods; 0: none
    # largest difference of states n periods apart over the motion's size; infinity where there is
    # no n
    deviation: float


class Decision(NamedTuple):
    """Multiplicity of a response, and how it was decided: irregular, repeated or undecided."""

    multiplicity: int  # where it is undecided, the best guess
    decided: int  # of `DECIDED`


def find_repetition(
    samples: ArrayLike, frequency: float, gap: float, tolerance: float
) -> Repetition:
    """Find the least n after which states repeat within a tolerance; return n, deviation.

    Only the later half of the samples is compared: a transient may outlive hundreds of periods. n
    is 0 where none up to a quarter of the samples is found.
    """
    memory = apply_rule("repeat", samples, (frequency, gap, tolerance))
    return Repetition(int(memory[repetition.MULTIPLICITY]), float(memory[repetition.DEVIATION]))


def decide_multiplicity(
    samples: ArrayLike, frequency: float, gap: float, tolerance: float
) -> Decision:
    """Decide a response's multiplicity by the rule of ``kernels.repetition.decide``."""
    memory = apply_rule("decide", samples, (frequency, gap, tolerance))
    return Decision(int(memory[repetition.MULTIPLICITY]), int(memory[repetition.DECIDED]))


def apply_rule(
    name: str, samples: ArrayLike, settings: tuple[float, float, float]
) -> NDArray[np.float64]:
    """Run a function of the kernel, compiled where it can be; return its memory."""
    states = np.asarray(samples, dtype=float)
    memory = np.zeros(memory_size(len(states)))
    memory[: repetition.MULTIPLICITY] = len(states), *settings
    memory[repetition.HEAD : repetition.HEAD + states.size] = states.ravel()
    compiled = library()
    if compiled is not None:
        getattr(compiled, RULES[name])(memory.ctypes.data)
        return memory
    numbers = memory.tolist()  # quicker one by one than an array
    getattr(repetition, name)(numbers, 0.0)  # a kernel's functions have a time, of no use here
    return np.array(numbers)
