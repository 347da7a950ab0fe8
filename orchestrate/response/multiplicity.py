"""Multiplicity of a response (period in excitation periods), decided by how deviations decay.

A tolerance decides little: a transient that turns round, or that changes sides as next to a
period doubling, comes back closer after some periods than after one; a torus comes back as close as
one likes after enough of them; and a narrow period doubling stays within any tolerance. So the rule
(``write_decided_multiplicity`` of :mod:`fmu_src.kernels.repetition`, called by the loop of
responses) follows how deviations develop: those of a response that repeats have died, or decay.
Its ``confirm_by_impacts`` makes the decision undecided where impacts contradict it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmu_src.kernels import repetition
from fmu_src.kernels.repetition import lacks_impacts, memory_size

from ..fmu import respond_library
from ..model.outcomes import WORDS

__all__ = ["lacks_impacts", "memory_size"]
DECIDED = {n: WORDS[n] for n in (repetition.IRREGULAR, repetition.REPEATED, repetition.UNDECIDED)}


class Repetition(NamedTuple):
    """Multiplicity of a response, and the largest deviation of states that many periods apart."""

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
    """Find the least n after which the later half of states repeats (0: none), and its deviation.

    ``gap`` is the motion's largest, m; the tolerance is over the motion's size.
    """
    memory = call_repetition_kernel("find_repetition", samples, (frequency, gap, tolerance))
    return Repetition(int(memory[repetition.MULTIPLICITY]), float(memory[repetition.DEVIATION]))


def nearest_state(
    samples: ArrayLike, frequency: float, gap: float, state: ArrayLike
) -> tuple[int, float]:
    """Return the number of the sample nearest to a state, and its distance over their size."""
    rows, row = (np.ascontiguousarray(part, dtype=float) for part in (samples, state))
    memory = np.empty(memory_size(len(rows)))
    sizes, addresses = (frequency, gap), (row.ctypes.data, memory.ctypes.data)
    distance = respond_library().nearest_state(rows.ctypes.data, len(rows), *sizes, *addresses)
    return int(memory[repetition.NEAREST]), float(distance)


def call_repetition_kernel(
    name: str, samples: ArrayLike, settings: tuple[float, float, float]
) -> NDArray[np.float64]:
    """Call a function of ``kernels.repetition`` with these settings; return its memory."""
    states = np.asarray(samples, dtype=float)
    memory = np.zeros(memory_size(len(states)))
    memory[: repetition.MULTIPLICITY] = len(states), *settings
    memory[repetition.HEAD : repetition.HEAD + states.size] = states.ravel()
    getattr(respond_library(), name)(memory.ctypes.data)
    return memory
